"""Values that are drawn anew for each run: the key `draw` of an exercise.yaml.

    draw:
      a: {integer: [1, 99], example: 2}
      speed: {number: [0.5, 2], example: 1.0}
      name: {word: 6, example: orange}
      side: {one_of: [left, right], example: left}

`drawn.a` is a value in every expression of `cast`, `arguments` and `expect`: `"=drawn.a + 1"`,
`"{drawn.name}"`. Before a run, and before its recording is judged, what was drawn takes its place,
so that neither the cast nor a check knows that anything was drawn. The sheet shows the examples.
"""

from __future__ import annotations

import random
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from string import ascii_lowercase
from typing import Any, Final

from grader.recording.recording import Drawn, Value
from grader.system.expressions import ExpressionError, with_fields
from grader.system.yaml_file import Mistake, decoded, expect

#: The key, the name in expressions; of a case, how many further runs it has.
DRAW, DRAWN = "draw", "drawn"
#: So many values an exercise may draw; a word has so many letters at most.
MOST_DRAWS, LONGEST_WORD = 20, 40
#: A drawn number is no larger, and no less than its negative: that of 64 bits.
LARGEST: Final = 2**63 - 1
#: Digits of a drawn number behind the point.
DIGITS: Final = 2
_NAME: Final = re.compile(r"[a-z]\w{0,40}", re.ASCII)


@dataclass(frozen=True, kw_only=True)
class Draw:
    """How a value is drawn: by one of four keys.

    Attributes:
        example: what the sheet shows; no run has it, unless it is one of few.
        integer, number: from which on and to which; numbers have two digits behind the point.
        word: of so many letters.
        one_of: these.
    """

    example: Value
    integer: tuple[int, int] | None = None
    number: tuple[float, float] | None = None
    word: int | None = None
    one_of: tuple[Value, ...] | None = None

    def __post_init__(self) -> None:
        given = [self.integer, self.number, self.word, self.one_of]
        if sum(each is not None for each in given) != 1:
            raise ValueError("expected exactly one of integer, number, word, one_of")
        low, high = self.integer or self.number or (0, 0)
        if not -LARGEST <= low <= high <= LARGEST:
            raise ValueError(f"expected two numbers of at most {LARGEST}, the lower one first")
        if self.word is not None and not 1 <= self.word <= LONGEST_WORD:
            raise ValueError(f"word: expected 1 to {LONGEST_WORD} letters, found {self.word}")
        if self.one_of == ():
            raise ValueError("one_of: expected values, found none")

    @property
    def extremes(self) -> tuple[Value, ...]:
        """What it may become at most, for trying."""
        return self.one_of or self.integer or self.number or ("a" * (self.word or 0),)

    def value(self, chance: random.Random) -> Value:
        """Draw one."""
        if self.one_of:
            return chance.choice(self.one_of)
        drawn = [self._any(chance) for _ in range(9)]
        return next((each for each in drawn if each != self.example), self.example)

    def _any(self, chance: random.Random) -> Value:
        if self.integer:
            return chance.randint(*self.integer)
        if self.number:
            return round(chance.uniform(*self.number), DIGITS)
        return "".join(chance.choices(ascii_lowercase, k=self.word or 0))


def read_draws(data: Mapping[str, Any]) -> dict[str, Draw]:
    """Read the values that an exercise draws.

    Raises:
        Mistake: something in it is wrong.
    """
    given = data.get(DRAW) or {}
    fits = isinstance(given, dict) and len(given) <= MOST_DRAWS
    what = "expected names, each with how it is drawn, at most {most}; found {found}"
    expect(fits, (DRAW,), what, given, most=MOST_DRAWS)
    for name in given:
        is_name = isinstance(name, str) and _NAME.fullmatch(name) is not None
        expect(is_name, (DRAW, str(name)), "expected a name such as a, found {found}", name)
    return {name: decoded(Draw, each, DRAW, name) for name, each in given.items()}


def examples(draws: Mapping[str, Draw]) -> Drawn:
    """Return the examples, by their names."""
    return {name: each.example for name, each in draws.items()}


def extremes(draws: Mapping[str, Draw]) -> Iterator[Drawn]:
    """Yield the examples with each of the values that one may become at most."""
    for name, each in draws.items():
        for value in each.extremes:
            yield {**examples(draws), name: value}


def draw(draws: Mapping[str, Draw], seed: int, run: int) -> Drawn:
    """Draw the values of a run: of the same number and seed always the same."""
    return {n: each.value(random.Random(f"{n} {seed} {run}")) for n, each in draws.items()}


def put_in(template: Any, drawn: Drawn, at: tuple[str, ...] = ()) -> Any:
    """Return plain data in which drawn values stand in place of `drawn.NAME`.

    Raises:
        Mistake: an expression uses one that there is not, or cannot be computed.
    """
    try:
        return with_fields(template, DRAWN, drawn)
    except ExpressionError as error:
        raise Mistake(at, error.message) from None
