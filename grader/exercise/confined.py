"""The checks of an added exercise: described and run in a confined process, never in ours.

That process (`.confined_main`) loads the exercise as one of a folder, from the same files and the
same values, and sends what `.asking` sends. Its code is a stranger's: each answer is checked here
as strictly as anything that a submission sends, and whatever it does else is the exercise's fault.
"""

from __future__ import annotations

import shutil
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache, partial
from pathlib import Path
from typing import Any, Final, NamedTuple, NoReturn

import yaml

from grader import scratch, strict_json, system
from grader.added.pins import FILES, Pin
from grader.errors import CheckFailed, ExerciseError, UsageError
from grader.exercise import asking
from grader.exercise.asking import Answers
from grader.exercise.check import Check, Checks
from grader.exercise.verdict import Finding, wrong_with
from grader.message import NOTHING, Message, msg
from grader.recording.recording import NominalAlone, Recordings
from grader.recording.saving import save_all
from grader.strict_json import Bounds

#: What the process runs.
PROGRAM: Final = Path(__file__).with_name("confined_main.py")
#: In the folder that it is shown, beside the exercise: the values that are in force, the runs.
VALUES, RECORDINGS = "values.yaml", "recordings"
#: Of what it answers: no check of ours comes near.
BOUNDS: Final = Bounds(characters=20_000, entries=200, may_lack=True)


@dataclass(frozen=True)
class Described:
    """A check, as the process describes it; see `grader.exercise.check.Check`."""

    name: str
    title: Message
    depends_on: tuple[str, ...]
    rubric: Message
    file: str


@dataclass(frozen=True)
class Description:
    """What the process says of the checks.

    Attributes:
        checks: in their order.
        tolerance, wrong: the first one that cannot be used, and why not; '' for none.
        refused: why the checks cannot be imported; NOTHING where they can.
    """

    checks: tuple[Described, ...] = ()
    tolerance: str = ""
    wrong: Message = NOTHING
    refused: Message = NOTHING


def checks_of(folder: Path, pin: Pin, data: Mapping[str, Any]) -> Checks:
    """Return the checks of an added exercise, none of which this process can call.

    Args:
        data: the values of its exercise.yaml that are in force.

    Raises:
        ExerciseError: they cannot be imported, or the exercise is no longer what was added.
        CheckFailed: importing them did what it must not.
        UsageError: nothing can confine them here.
    """
    values = yaml.safe_dump(dict(data), sort_keys=False, allow_unicode=True)
    found = _described(folder, pin, values)
    if found.refused:
        raise ExerciseError(found.refused)
    checks = Checks(elsewhere=partial(_ask, folder, pin, values))
    for each in found.checks:
        words = (each.title, _unreachable, each.depends_on, each.rubric, each.file)
        checks.add(Check(each.name, *words))
    if found.tolerance:
        checks.refuse(found.tolerance, found.wrong)
    return checks


def _unreachable(recordings: Recordings, tolerances: Mapping[str, Any]) -> NoReturn:
    raise AssertionError("a check of an added exercise was called in the grader's process")


@lru_cache(maxsize=16)  # each takes a process, and depends on nothing else
def _described(folder: Path, pin: Pin, values: str) -> Description:
    data, why = _answered(folder, pin, values, {"say": "describe"})
    if why:
        raise _blamed(pin, why)
    try:
        return strict_json.of_line(Description, data, BOUNDS)
    except ValueError as error:
        raise _unusable(pin, error) from None


def _ask(
    folder: Path,
    pin: Pin,
    values: str,
    recordings: Recordings,
    after: Mapping[str, Sequence[str]],
    rounds: int,
    is_described: bool,
) -> list[Answers]:
    """Run checks; see `grader.exercise.check.Elsewhere`.

    Raises:
        CheckFailed: they did what they must not, or answered what they cannot have found.
        ExerciseError: the exercise is no longer what was added.
        UsageError: nothing can confine them here.
    """
    is_alone = isinstance(recordings, NominalAlone)
    order = {
        "say": "judge",
        "after": {name: list(others) for name, others in after.items()},
        "rounds": rounds,
        "is_alone": is_alone,
        "is_described": is_described,
    }
    kept = Recordings(recordings.nominal) if is_alone else recordings
    data, why = _answered(folder, pin, values, order, kept)
    lines = data.splitlines(keepends=True)
    running = ""
    try:
        for line in lines if not why else lines[:-1]:  # the last one may be cut off
            running = _checked(line, after, rounds, len(list(kept)))
        if why:
            raise _blamed(pin, why, running)
        answered = asking.collected(lines, rounds)
        for each in answered:
            if lacking := each.lacking(after):
                raise ValueError(f"there is none of the check {lacking!r}")
    except (ValueError, RecursionError) as error:
        raise _unusable(pin, error) from None
    return answered


def _answered(
    folder: Path,
    pin: Pin,
    values: str,
    order: Mapping[str, Any],
    recordings: Recordings | None = None,
) -> tuple[bytes, Message]:
    """Run the process; see `grader.run.checking.answered`."""
    if not system.runs_submissions():
        raise UsageError(
            msg(
                "the checks of an added exercise run confined alone, which takes Linux. Or look at "
                "its files, and give a copy of their folder: --exercise FOLDER"
            )
        )
    from grader.run import checking  # here: only on Linux, and only for added exercises

    with scratch.make_folder() as scratched:
        shown = scratched / "shown"
        shutil.copytree(folder, shown / FILES, copy_function=shutil.copyfile, symlinks=True)
        pin.check(shown / FILES)
        (shown / VALUES).write_text(values, encoding="utf-8")
        if recordings is not None:
            save_all(recordings, shown / RECORDINGS)
        for path in (shown, *shown.rglob("*")):  # another user may read them there
            if not path.is_symlink():
                path.chmod(0o755 if path.is_dir() else 0o644)
        return checking.answered(PROGRAM, {**order, "shown": str(shown)}, shown, asking.LIMITS)


class _Line(NamedTuple):
    """What a line of `.asking.answers` holds."""

    round: int
    check: str
    answer: Any


def _checked(line: bytes, after: Mapping[str, Sequence[str]], rounds: int, runs: int) -> str:
    """Check an answer; return the check that it is about.

    Raises:
        ValueError: no check can answer that.
    """
    number, name, found = strict_json.from_json(_Line, strict_json.loads(line.decode()), BOUNDS)
    if not 0 <= number < rounds or name not in after:
        raise ValueError(f"nobody asked for the check {name!r:.80} in round {number}")
    if found is None:
        return name
    say = found.get("say") if isinstance(found, dict) else None
    if say == "finding":
        finding = strict_json.from_json(Finding, found.get("finding"), BOUNDS)
        if wrong := wrong_with(finding, runs):
            raise ValueError(wrong)
    elif say == "limit":
        Message.parse(found.get("text"), _text)
    elif say in ("raised", "wrong"):
        _text(found.get("text"))
    elif say != "not over":
        raise ValueError(f"the check {name!r} says {found!r:.80}")
    return name


def _text(found: object) -> str:
    return strict_json.from_json(str, found, BOUNDS)


def _unusable(pin: Pin, error: Exception) -> CheckFailed:
    return _blamed(pin, msg("answered what cannot be used: {why}", why=f"{error!s:.200}"))


def _blamed(pin: Pin, what: Message, check: str = "") -> CheckFailed:
    """Return the error for a stranger's code that did what it must not."""
    words = {"name": repr(pin.name), "origin": str(pin.origin), "what": what}
    if check:
        return CheckFailed(
            "the check {check} of the exercise {name}, which was added from {origin}, {what}: "
            "nothing was judged",
            check=repr(check),
            **words,
        )
    return CheckFailed(
        "the check code of the exercise {name}, which was added from {origin}, {what}: nothing was "
        "judged",
        **words,
    )
