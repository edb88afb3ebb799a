"""Asks the checks of an exercise for their findings, in one copy of this process with one limit.

Each finding comes as it is made, as strict JSON. Where a check ends the copy, or its time is over,
that one and those after it have none.
"""

from __future__ import annotations

import json
import traceback
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from grader import limited, strict_json
from grader.exercise.verdict import Finding, wrong_with
from grader.limited import LimitHit, WorkLimits
from grader.message import NOTHING, Message
from grader.recording.recording import NominalAlone, NotOver, Recordings

CheckFunction = Callable[[Recordings, Mapping[str, Any]], Finding]
#: Makes a text of what a check raised.
Told = Callable[[CheckFunction, BaseException], str]
#: Of all checks of a judging together; an ordinary one takes 0.04 s.
LIMITS = WorkLimits(cpu_s=60.0, wall_s=180.0)


class NoFinding(Exception):
    """A check raised something, or returned what is no finding; the text says what and where."""

    def __init__(self, text: str, *, was_raised: bool) -> None:
        super().__init__(text)
        self.was_raised = was_raised


class NotReached(Exception):
    """A check has no finding since one, `by`, took too much; `what` goes on from its name."""

    def __init__(self, what: Message, by: str) -> None:
        super().__init__(what)
        self.what, self.by = what, by


class Answers:
    """What checks have answered; asked for one by its name.

    Attributes:
        answers: by the check's name, as `_run` makes them.
        not_reached: what is raised for all others.
    """

    def __init__(self) -> None:
        self.answers: dict[str, dict[str, Any]] = {}
        self.not_reached = NotReached(NOTHING, "")

    def __call__(self, name: str) -> Finding:
        """What a check has found.

        Raises:
            NoFinding: it raised something, or returned what is no finding.
            NotReached: it, or one before it, did not come to an end.
            NotOver: it asked for a run that is not over.
        """
        words = self.answers.get(name, {"say": "nothing"})
        match words["say"]:
            case "finding":
                return strict_json.from_json(Finding, words["finding"], strict_json.OURS)
            case "not over":
                raise NotOver
            case "limit":
                raise NotReached(Message.parse(words["text"]), name)
            case "raised" | "wrong":
                raise NoFinding(words["text"], was_raised=words["say"] == "raised")
        raise self.not_reached


def ask(
    functions: Mapping[str, CheckFunction],
    after: Mapping[str, Sequence[str]],
    recordings: Recordings,
    tolerances: Mapping[str, Any],
    told: Told | None = None,
    rounds: int = 1,
) -> list[Answers]:
    """Ask checks in their order about recordings; one that waits for one that fails is not asked.

    Args:
        after: of each check those that have to pass before.
        told: where it failed, for people, if not `where_it_failed`.
        rounds: all of it so often, in the same process.

    Returns:
        A round each.
    """

    def work() -> Iterator[bytes]:
        for number in range(rounds):
            passed: dict[str, bool] = {}
            for name, function in functions.items():
                if all(passed.get(each, True) for each in after[name]):
                    yield json.dumps([number, name, None]).encode()
                    answer = _run(function, recordings, tolerances, told or where_it_failed)
                    yield json.dumps([number, name, answer]).encode()
                    found = answer.get("finding")
                    passed[name] = bool(found and found["judged"] and found["share"] >= 1)
                else:
                    passed[name] = False

    made = [Answers() for _ in range(rounds)]
    running = ""
    try:
        for answer in limited.stream(work, LIMITS):
            number, running, words = strict_json.loads(answer.decode())
            if words is not None:
                made[number].answers[running] = words
    except LimitHit as hit:
        for each in made:
            each.not_reached = NotReached(hit.why, running)
    return made


def _run(
    function: CheckFunction, recordings: Recordings, tolerances: Mapping[str, Any], told: Told
) -> dict[str, Any]:
    """In the copy: ask one."""
    try:
        finding = function(recordings, tolerances)
    except NotOver:
        return {"say": "not over"}
    except KeyboardInterrupt:  # a key's, where there is no copy, which is deaf to it
        raise
    except MemoryError:
        return {"say": "limit", "text": limited.TOO_MUCH.serialise()}
    except RecursionError:
        return {"say": "limit", "text": limited.TOO_DEEP.serialise()}
    except BaseException as error:  # SystemExit too: a check must not end the others unjudged
        return {"say": "raised", "text": told(function, error)}
    is_alone = isinstance(recordings, NominalAlone)
    wrong = wrong_with(finding, 1 if is_alone else len(list(recordings)))
    if wrong:
        return {"say": "wrong", "text": wrong}
    said = strict_json.to_json(replace(finding, share=float(finding.share)), strict_json.OURS)
    return {"say": "finding", "finding": said}


def where_it_failed(function: CheckFunction, error: BaseException) -> str:
    """An exception in a check, with the last line of the file that the check stands in."""
    file = function.__code__.co_filename
    frames = traceback.extract_tb(error.__traceback__)
    lines = [frame.lineno for frame in frames if frame.filename == file]
    where = f"{Path(file).name}, line {lines[-1]}: " if lines else ""
    return f"{where}{type(error).__name__}: {error}".rstrip(": ")
