"""Runs the checks of an exercise in one copy of this process, with one limit for all of them.

Each finding is sent as it is made, as strict JSON. Where a check ends the copy, or exceeds its
limit, that one and those after it have none.
"""

from __future__ import annotations

import json
import re
import traceback
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from grader.exercise.verdict import Finding, as_json
from grader.recording.recording import NominalAlone, NotOver, Recordings
from grader.system import limited, strict_json
from grader.system.limited import LimitHit, WorkLimits
from grader.text.message import NOTHING, Message, joined, msg

CheckFunction = Callable[[Recordings, Mapping[str, Any]], Finding]
#: The name of the package that is made for a folder, before its number.
PACKAGE = "_grader_exercise_"
CHECKS = "checks.py"
#: Of all checks of a judging together; an ordinary judging needs 0.04 s.
LIMITS = WorkLimits(cpu_s=60.0, wall_s=180.0)
#: Of a check that judges files, why a parrot passes it.
OF_FILES: Final = "it is in the files, whatever a program sends"


@dataclass(frozen=True)
class Check:
    """A named check function and the checks that must have passed before it.

    Attributes:
        title: the first line of its docstring.
        rubric: the rest of it: what is measured and how partial credit is computed, for students;
            `{name}` stands for a tolerance, `{name%}` for one in percent.
        parrot: why a program passes it that only repeats what a right one has sent; '' where none
            may (`grader.testing.parrot`).
    """

    name: str
    title: Message
    function: CheckFunction
    depends_on: tuple[str, ...]
    rubric: Message = NOTHING
    parrot: str = ""


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
    checks: Sequence[Check],
    recordings: Recordings,
    tolerances: Mapping[str, Any],
    rounds: int = 1,
) -> list[Answers]:
    """Run checks in their order; one that depends on one that fails is not run.

    Args:
        rounds: how often all of them are run, in the same process.

    Returns:
        The findings of each round.
    """

    def work() -> Iterator[bytes]:
        for number in range(rounds):
            has_passed: dict[str, bool] = {}
            for check in checks:
                name, has_passed[check.name] = check.name, False
                if all(has_passed.get(each, True) for each in check.depends_on):
                    yield json.dumps([number, name, None]).encode()
                    answer = _run(check.function, recordings, tolerances)
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
        return {"say": "wrong", "text": str(describe(error, _file(function).parent))}
    is_alone = isinstance(recordings, NominalAlone)
    try:
        data = as_json(finding, 1 if is_alone else len(list(recordings)))
    except (TypeError, ValueError) as error:
        return {"say": "wrong", "text": f"{_file(function).name}: {error}"}
    return {"say": "finding", "finding": data}


def _file(function: CheckFunction) -> Path:
    return Path(function.__code__.co_filename)


def describe(error: BaseException, folder: Path, file: str = "") -> Message:
    """Describe an exception in the files of a folder: 'checks.py, line 3: NameError: ...'.

    Args:
        file: of an error without a place.
    """
    name = type(error).__name__
    if isinstance(error, SyntaxError) and error.filename:
        return msg(
            "{file}, line {line}: {name}: {what}",
            file=_shown(error.filename, folder),
            line=str(error.lineno),
            name=name,
            what=error.msg,
        )
    text = Message.of(f"{name}: {error}" if str(error) else name)
    if isinstance(error, ImportError) and (absent := _absent(error, folder)):
        text = msg(
            "{name}: there is no {absent} beside {checks}", name=name, absent=absent, checks=CHECKS
        )
    frames = traceback.extract_tb(error.__traceback__)
    inside = [frame for frame in frames if Path(frame.filename).is_relative_to(folder)]
    missing = getattr(error, "name", None) if isinstance(error, ModuleNotFoundError) else None
    if missing and (folder / f"{missing}.py").is_file():
        way = msg(
            "A file beside {checks} is imported by `from . import {missing}`",
            checks=CHECKS,
            missing=missing,
        )
        text = joined([text, way], ". ")
    if not inside:
        return joined([file, text], ": ") if file else text
    return msg(
        "{file}, line {line}: {what}",
        file=_shown(inside[-1].filename, folder),
        line=str(inside[-1].lineno),
        what=text,
    )


def _absent(error: ImportError, folder: Path) -> str:
    """Return the missing file beside checks.py that was imported; '' for other errors."""
    package, _, module = (error.name or "").partition(".")
    if not package.startswith(PACKAGE):
        return ""
    named = re.match(r"cannot import name '(\w+)'", str(error))  # `name_from` is new in 3.12
    module = module or (named[1] if named else "")
    is_there = (folder / f"{module}.py").is_file() or (folder / module).is_dir()
    return "" if not module or "." in module or is_there else f"{module}.py"


def _shown(file: str, folder: Path) -> str:
    path = Path(file)
    return str(path.relative_to(folder)) if path.is_relative_to(folder) else file
