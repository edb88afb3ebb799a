"""Runs the checks of an exercise in one copy of this process, with one limit for all of them.

Each finding is sent as it is made, as strict JSON. Where a check ends the copy, or exceeds its
limit, that one and those after it have none.
"""

from __future__ import annotations

import json
import traceback
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

from grader import limited, strict_json
from grader.exercise.verdict import Finding, wrong_with
from grader.limited import LimitHit, WorkLimits
from grader.message import NOTHING, Message
from grader.recording.recording import NominalAlone, NotOver, Recordings

CheckFunction = Callable[[Recordings, Mapping[str, Any]], Finding]
#: Describes the exception that a check raised.
DescribeError = Callable[[CheckFunction, BaseException], str]
#: Of all checks of a judging together; an ordinary judging needs 0.04 s.
LIMITS = WorkLimits(cpu_s=60.0, wall_s=180.0)


class NoFinding(Exception):
    """A check raised an exception, or returned no finding; the text says what and where."""

    def __init__(self, text: str, *, was_raised: bool) -> None:
        super().__init__(text)
        self.was_raised = was_raised


class NotReached(Exception):
    """A check has no finding since one, `by`, exceeded a limit; `what` goes on from its name."""

    def __init__(self, what: Message, by: str) -> None:
        super().__init__(what)
        self.what, self.by = what, by


class Answers:
    """The findings of one round of checks; called with a check's name, it returns one.

    Attributes:
        answers: by the check's name, as `_run` makes them.
        not_reached: the exception for all others.
    """

    def __init__(self) -> None:
        self.answers: dict[str, dict[str, Any]] = {}
        self.not_reached = NotReached(NOTHING, "")

    def __call__(self, name: str) -> Finding:
        """Return the finding of a check.

        Raises:
            NoFinding: it raised an exception, or returned no finding.
            NotReached: it, or one before it, exceeded a limit.
            NotOver: it needs a run that is not over.
        """
        answer = self.answers.get(name, {"say": "nothing"})
        match answer["say"]:
            case "finding":
                return strict_json.from_json(Finding, answer["finding"], strict_json.OURS)
            case "not over":
                raise NotOver
            case "limit":
                raise NotReached(Message.parse(answer["text"]), name)
            case "raised" | "wrong":
                raise NoFinding(answer["text"], was_raised=answer["say"] == "raised")
        raise self.not_reached

    def lets(self, name: str, after: Mapping[str, Sequence[str]]) -> bool:
        """Whether a check is to be run: each that it depends on has passed, or is not asked."""
        return all(each not in after or self._has_passed(each) for each in after[name])

    def lacking(self, after: Mapping[str, Sequence[str]]) -> str:
        """Return the first check that should have an answer and has none; '' for none."""
        return next((n for n in after if n not in self.answers and self.lets(n, after)), "")

    def _has_passed(self, name: str) -> bool:
        found = self.answers.get(name, {}).get("finding")
        return bool(found and found.get("judged", True) and found["share"] >= 1)


def ask(
    functions: Mapping[str, CheckFunction],
    after: Mapping[str, Sequence[str]],
    recordings: Recordings,
    tolerances: Mapping[str, Any],
    describe: DescribeError | None = None,
    rounds: int = 1,
) -> list[Answers]:
    """Run checks in a copy of this process; return the findings of each round. See `answers`."""
    work = partial(answers, functions, after, recordings, tolerances, describe, rounds)
    return collected(limited.stream(work, LIMITS), rounds)


def answers(
    functions: Mapping[str, CheckFunction],
    after: Mapping[str, Sequence[str]],
    recordings: Recordings,
    tolerances: Mapping[str, Any],
    describe: DescribeError | None,
    rounds: int,
) -> Iterator[bytes]:
    """Run checks in their order; one that depends on one that fails is not run.

    Yields:
        For each check a line that it begins, and one with its answer.

    Args:
        after: of each check those that have to pass before.
        describe: an exception of a check for people; else `where_it_failed`.
        rounds: how often all of them are run, in the same process.
    """
    for number in range(rounds):
        made = Answers()
        for name, function in functions.items():
            if made.lets(name, after):
                yield _line(number, name, None)
                answer = _run(function, recordings, tolerances, describe or where_it_failed)
                yield _line(number, name, answer)
                made.answers[name] = answer


def collected(lines: Iterable[bytes], rounds: int) -> list[Answers]:
    """Return the findings of each round from the lines of `answers`."""
    by_round = [Answers() for _ in range(rounds)]
    running = ""
    try:
        for line in lines:
            number, running, found = strict_json.loads(line.decode())
            if found is not None:
                by_round[number].answers[running] = found
    except LimitHit as hit:
        for each in by_round:
            each.not_reached = NotReached(hit.why, running)
    return by_round


def _line(number: int, name: str, answer: dict[str, Any] | None) -> bytes:
    return json.dumps([number, name, answer]).encode() + b"\n"


def _run(
    function: CheckFunction,
    recordings: Recordings,
    tolerances: Mapping[str, Any],
    describe: DescribeError,
) -> dict[str, Any]:
    """Run one check, in the copy; return its answer as JSON."""
    try:
        finding = function(recordings, tolerances)
    except NotOver:
        return {"say": "not over"}
    except KeyboardInterrupt:  # of a key, where there is no copy, which ignores it
        raise
    except MemoryError:
        return {"say": "limit", "text": limited.TOO_MUCH.serialise()}
    except RecursionError:
        return {"say": "limit", "text": limited.TOO_DEEP.serialise()}
    except BaseException as error:  # SystemExit too: a check must not end the others unjudged
        return {"say": "raised", "text": describe(function, error)}
    is_alone = isinstance(recordings, NominalAlone)
    wrong = wrong_with(finding, 1 if is_alone else len(list(recordings)))
    if wrong:
        return {"say": "wrong", "text": wrong}
    data = strict_json.to_json(replace(finding, share=float(finding.share)), strict_json.OURS)
    return {"say": "finding", "finding": data}


def where_it_failed(function: CheckFunction, error: BaseException) -> str:
    """Describe an exception in a check, with the last line of the check's file."""
    file = function.__code__.co_filename
    frames = traceback.extract_tb(error.__traceback__)
    lines = [frame.lineno for frame in frames if frame.filename == file]
    where = f"{Path(file).name}, line {lines[-1]}: " if lines else ""
    return f"{where}{type(error).__name__}: {error}".rstrip(": ")
