"""Runs the checks of an exercise in one copy of this process, with one limit for all of them.

Each finding is sent as it is made, as strict JSON. Where a check ends the copy, or exceeds its
limit, that one and those after it have none.
"""

from __future__ import annotations

import json
import traceback
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from grader.exercise.verdict import Finding, as_json
from grader.recording.recording import NominalAlone, NotOver, Recordings
from grader.system import limited, strict_json
from grader.system.limited import LimitHit, WorkLimits
from grader.text.message import NOTHING, Message

CheckFunction = Callable[[Recordings, Mapping[str, Any]], Finding]
#: Describes the exception that a check raised.
DescribeError = Callable[[CheckFunction, BaseException], str]
#: Of all checks of a judging together; an ordinary judging needs 0.04 s.
LIMITS = WorkLimits(cpu_s=60.0, wall_s=180.0)


class NoFinding(Exception):
    """A check raised an exception, or returned no finding; the text says what and where."""


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
            case "wrong":
                raise NoFinding(answer["text"])
        raise self.not_reached


def ask(
    functions: Mapping[str, CheckFunction],
    after: Mapping[str, Sequence[str]],
    recordings: Recordings,
    tolerances: Mapping[str, Any],
    describe: DescribeError | None = None,
    rounds: int = 1,
) -> list[Answers]:
    """Run checks in their order; one that depends on one that fails is not run.

    Args:
        after: of each check those that have to pass before.
        describe: an exception of a check for people; else `where_it_failed`.
        rounds: how often all of them are run, in the same process.

    Returns:
        The findings of each round.
    """

    def work() -> Iterator[bytes]:
        for number in range(rounds):
            has_passed: dict[str, bool] = {}
            for name, function in functions.items():
                has_passed[name] = False
                if all(has_passed.get(each, True) for each in after[name]):
                    yield json.dumps([number, name, None]).encode()
                    answer = _run(function, recordings, tolerances, describe or where_it_failed)
                    yield json.dumps([number, name, answer]).encode()
                    found = answer.get("finding")
                    has_passed[name] = bool(found and found["judged"] and found["share"] >= 1)

    by_round = [Answers() for _ in range(rounds)]
    running = ""
    try:
        for line in limited.stream(work, LIMITS):
            number, running, answer = strict_json.loads(line.decode())
            if answer is not None:
                by_round[number].answers[running] = answer
    except LimitHit as hit:
        for each in by_round:
            each.not_reached = NotReached(hit.why, running)
    return by_round


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
        return {"say": "wrong", "text": describe(function, error)}
    is_alone = isinstance(recordings, NominalAlone)
    try:
        data = as_json(finding, 1 if is_alone else len(list(recordings)))
    except (TypeError, ValueError) as error:
        return {"say": "wrong", "text": f"{Path(function.__code__.co_filename).name}: {error}"}
    return {"say": "finding", "finding": data}


def where_it_failed(function: CheckFunction, error: BaseException) -> str:
    """Describe an exception in a check, with the last line of the check's file."""
    file = function.__code__.co_filename
    frames = traceback.extract_tb(error.__traceback__)
    lines = [frame.lineno for frame in frames if frame.filename == file]
    where = f"{Path(file).name}, line {lines[-1]}: " if lines else ""
    return f"{where}{type(error).__name__}: {error}".rstrip(": ")
