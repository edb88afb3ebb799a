"""The cases of an exercise: what plays beside a program, and what it is started with, in each run.

    cast: {caller: {calls: {draw: {service: draw, type: ..., request: {sides: 4}}}}}
    arguments: ["2", "3"]
    cases:
      triangle: {cast: {caller: {calls: {draw: {request: {sides: 3}}}}}}

The exercise itself is the first case, `usual`. Each further one is a varied run, and says in what
it differs: what it names takes the place of what is there, null takes it away. `drawn: 3` are three
runs, for each of which values are drawn (`grader.exercise.draws`).
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Final

from grader.exercise.draws import DRAWN, Draw, examples, extremes, put_in
from grader.recording.recording import Drawn
from grader.recording.subject import Endpoint, Role
from grader.system.yaml_file import Mistake, decoded, expect
from grader.text.message import msg

#: Scripted peers, topics that are recorded besides, arguments of the program; the cases.
CAST, HEARS, ARGUMENTS, CASES = "cast", "hears", "arguments", "cases"
KEYS: Final = (CAST, HEARS, ARGUMENTS, CASES)
#: The name of the first case.
USUAL: Final = "usual"
#: So many cases there are at most; so long are the peers as JSON [characters].
MOST_CASES, LONGEST_CAST = 20, 60_000
_NAME: Final = re.compile(r"[a-z]\w{0,40}", re.ASCII)


@dataclass(frozen=True)
class RunCase:
    """One case.

    Attributes:
        name: '' for the usual one.
        cast: its scripted peers, as `grader.scenes.cast.script` reads them; None where there are
            none and nothing is recorded.
        hears: topics that are recorded besides.
        arguments: those that the program is started with.
        written: the cast and the arguments with what is drawn for each run; with the examples these
            are those above.
    """

    name: str = ""
    cast: Mapping[str, Any] | None = field(default=None, hash=False)
    hears: tuple[str, ...] = ()
    arguments: tuple[str, ...] = ()
    written: Mapping[str, Any] = field(default_factory=dict, hash=False)

    def with_drawn(self, drawn: Drawn) -> RunCase:
        """Return the case of one run."""
        made = put_in(self.written, drawn)
        arguments = tuple(map(str, made.get(ARGUMENTS, ())))
        return replace(self, cast=made.get(CAST, self.cast), arguments=arguments)

    @property
    def endpoints(self) -> tuple[Endpoint, ...]:
        """What of the peers a program may meet."""
        from grader.scenes.cast import script  # here: most exercises have none

        return tuple(script.endpoints(script.parse(self.cast))) if self.cast else ()

    @property
    def roles(self) -> set[Role]:
        """What a program has on the graph, for its peers and for the checks."""
        if self.cast is None:
            return set()
        from grader.scenes.cast import script  # here: most exercises have none

        heard = (Role("publisher", script.absolute(each)) for each in self.hears)
        return {*script.roles(script.parse(self.cast)), *heard}

    def hearing(self, topics: Iterable[str]) -> RunCase:
        """Return it with more topics, which are recorded if anything is."""
        heard = tuple(sorted({*self.hears, *topics}))
        return self if self.cast is None else replace(self, hears=heard)


def read_cases(
    data: Mapping[str, Any],
    definitions: Mapping[str, str],
    end_s: float,
    draws: Mapping[str, Draw],
    *,
    has_cast: bool,
) -> list[RunCase]:
    """Read the cases of an exercise's description, the usual one first.

    Args:
        definitions: of the exercise's own types.
        end_s: how long a run lasts [s].
        has_cast: whether something is recorded though there are no peers.

    Raises:
        Mistake: something in it is wrong.
    """
    given = data.get(CASES) or {}
    fits = isinstance(given, dict) and len(given) <= MOST_CASES
    what = "expected names of cases, each with what differs, at most {most}; found {found}"
    expect(fits, (CASES,), what, given, most=MOST_CASES)
    usual = {key: data[key] for key in (CAST, HEARS, ARGUMENTS) if key in data}
    if has_cast or HEARS in data or "expect" in data:
        usual.setdefault(CAST, {})
    cases = [_case("", usual, definitions, end_s, draws, ())]
    for name, change in given.items():
        at = (CASES, str(name))
        is_name = isinstance(name, str) and _NAME.fullmatch(name) and name != USUAL
        expect(bool(is_name), at, "expected a name such as triangle, found {found}", name)
        known = (CAST, HEARS, ARGUMENTS, DRAWN)
        is_known = isinstance(change, dict) and change.keys() <= {*known}
        what = "expected some of {known}, found {found}"
        expect(is_known, at, what, change, known=", ".join(known))
        count = change.get(DRAWN, 1)
        fits = isinstance(count, int) and count > 0 and (bool(draws) or DRAWN not in change)
        what = "expected a number of runs, each with other values of `draw`, which has to be there"
        expect(fits, (*at, DRAWN), what, count)
        cases += count * [_case(name, _changed(usual, change), definitions, end_s, draws, at)]
    fits = len(cases) <= MOST_CASES + 1
    expect(fits, (CASES,), "expected at most {most} runs, found {found}", len(cases) - 1,
           most=MOST_CASES)  # fmt: skip
    return cases


def _case(
    name: str,
    data: Mapping[str, Any],
    definitions: Mapping[str, str],
    end_s: float,
    draws: Mapping[str, Draw],
    at: tuple[str, ...],
) -> RunCase:
    written = {key: data[key] for key in (CAST, ARGUMENTS) if data.get(key)}
    for drawn in (*extremes(draws), examples(draws)):
        made = {key: put_in(value, drawn, (*at, key)) for key, value in written.items()}
        made = {**data, **made}
        cast = _cast(made, definitions, end_s, at)
    arguments = _texts(made, ARGUMENTS, at)
    return RunCase(name, cast, _texts(data, HEARS, at), arguments, written)


def _changed(usual: Mapping[str, Any], change: Mapping[str, Any]) -> dict[str, Any]:
    made = dict(usual)
    for key, value in change.items():
        if key == DRAWN:
            continue
        before = made.pop(key, None)
        if isinstance(before, dict) and isinstance(value, dict):
            made[key] = _changed(before, value)
        elif value is not None:
            made[key] = value
    return made


def _cast(
    data: Mapping[str, Any], definitions: Mapping[str, str], end_s: float, at: tuple[str, ...]
) -> Mapping[str, Any] | None:
    """Check the scripted peers; None for none."""
    if CAST not in data:
        return None
    from grader.exercise.known_types import KnownTypes, check_cast
    from grader.scenes.cast import script  # here: most exercises have none

    peers = data[CAST] or {}
    keys = (*at, CAST)
    check_cast(script.parse(peers, keys), KnownTypes(definitions), end_s, keys)
    if len(json.dumps(peers)) > LONGEST_CAST:
        raise Mistake(keys, msg("expected {n:,} characters at most", n=LONGEST_CAST))
    return dict(peers)


def _texts(data: Mapping[str, Any], key: str, at: tuple[str, ...]) -> tuple[str, ...]:
    texts: tuple[str, ...] = decoded(tuple[str, ...], data.get(key, []), *at, key)
    return texts
