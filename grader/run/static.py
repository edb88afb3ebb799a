"""A run without a clock: one process looks at a submission, of which nothing is started by that.

It is the only run where a scene has no nodes (`run`). It says what there is to start of a package
(`inspect`), and goes beside the nominal run where an exercise has the package looked at around what
is started and the inspection has not seen it (`look_beside`). That process is the submission's, and
confined like one, since looking runs a stranger's set-up and launch files. What it leaves is
decoded as strictly as anything that a submission says.
"""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final, Generic, TypeVar

from grader import scratch, usage
from grader.errors import GraderFailure
from grader.language.phrase import say
from grader.recording.recording import Outcome, Recording
from grader.run import stage
from grader.run.budget import Budget
from grader.run.environment import virtual_environment
from grader.run.finish import Ending, limits_struck, record
from grader.run.plan import Plan
from grader.run.processes.watched import Watched
from grader.scenes import load_scene
from grader.scenes.package import inspection
from grader.scenes.package.by_itself import unlike_launched
from grader.scenes.package.inspection import Inspection, SetUp, Told
from grader.scenes.package.trace import FAILED, PackageTrace, decode
from grader.scenes.scene import Trace
from grader.submission.opening import EntryPoint, Submission, Whole

#: Told the simulated time [s], of which none passes here.
Progress = Callable[[float], None]
Found = TypeVar("Found")
#: The scene of what is looked at beside a run.
SCENE: Final = "package"
#: Whatever a package does has come to an end by then [s]: its steps have an account of processor
#: time and waiting. More is the machine's doing, and no verdict.
PATIENCE_S: Final = 900.0
#: So often it is looked whether it was stopped [s], and so many times together it has to be.
EVERY_S, STOPPED_LOOKS = 0.5, 4
#: The process leaves no more [bytes].
MOST_BYTES: Final = 32_000_000
ROOT: Final = Path(__file__).resolve().parents[2]
STOPPED: Final = "the package's own code has stopped (SIGSTOP) the process that looks at it"
NOTHING: Final = "the process that looked at the package left nothing that can be read: {}"


def run(submission: Submission, plan: Plan, progress: Progress | None = None) -> Recording:
    """Look at a submission once.

    Raises:
        GraderFailure: the process could not be started.
    """
    started = time.monotonic()
    scene = load_scene(plan.scene)
    looked = _look(submission, _words(submission), decode, plan.budget)
    ending = Ending(
        time="virtual",
        outcome=_outcome(looked.exit_code, looked.lost),
        exit_code=looked.exit_code,
        wall_s=time.monotonic() - started,
        isolation=looked.isolation,
        output=looked.output,
        flags=looked.flags,
    )
    trace = scene.untouched(None) if looked.found is None else looked.found
    return record(plan, trace, (), ending)


def inspect(
    submission: Submission,
    folders: Sequence[str],
    program: str,
    budget: Budget,
    *,
    is_whole: bool,
) -> tuple[Inspection, tuple[str, ...]]:
    """What there is to start of packages, before anything is; and what kept it from being found.

    Args:
        submission: all that was handed in.
        folders: those with set-up files, below its root.
        program: the console script that is asked for.
        is_whole: whether its package is looked at as `look_beside` does.

    Raises:
        GraderFailure: the process could not be started.
    """
    words = {"set_ups": list(folders), "program": program, "is_whole": is_whole}
    looked = _look(submission, words, inspection.decode, budget)
    found = looked.found
    if found is None or [each.folder for each in found.set_ups] != list(folders):
        found = Inspection(tuple(SetUp(each, Told(), None) for each in folders))
    return found, looked.flags


def look_beside(submission: Submission, budget: Budget) -> tuple[Trace, tuple[str, ...]]:
    """Look at the package in which a submission's program is, and at those beside it.

    Returns:
        What was found, and remarks for the result: what kept it from being found, and what launch
        files would have started otherwise.

    Raises:
        GraderFailure: the process could not be started.
    """
    flags: tuple[str, ...] = ()
    if isinstance(submission.seen, PackageTrace):
        found = submission.seen
    else:
        found, flags = _look_again(submission, budget)
    unlike: list[str] = []
    if isinstance(submission.start, EntryPoint):
        started = (submission.start.module, submission.start.function)
        unlike = unlike_launched(found, *started)
    return found, (*flags, *unlike)


def _look_again(submission: Submission, budget: Budget) -> tuple[PackageTrace, tuple[str, ...]]:
    with scratch.make_folder() as folder:
        own = submission.again(folder.resolve())
        assert own.copy is not None
        for each in own.added:
            (own.root / each).unlink()  # ros2 does not add it
        own = replace(own, root=own.copy.folder, start=Whole())
        looked = _look(own, _words(own), decode, budget)
    return PackageTrace.of(looked.found or PackageTrace()), looked.flags


@dataclass(frozen=True)
class _Looked(Generic[Found]):
    """What a process that has looked leaves.

    Attributes:
        found: None where it is nothing, and `lost` says why.
        exit_code: None where it had to be stopped.
    """

    found: Found | None
    exit_code: int | None
    lost: str
    isolation: str
    output: str
    flags: tuple[str, ...]


def _look(
    submission: Submission,
    asked: Mapping[str, object],
    decode: Callable[[bytes], Found],
    budget: Budget,
) -> _Looked[Found]:
    with stage.open_stage(budget) as place:
        submission, student = place.start(
            submission,
            lambda own: command(own, asked, place.recording),
            (place.recording,),
            virtual_environment({}),
        )
        try:
            exit_code, why = _wait(student)
        finally:
            student.end(gently=False)
        found, lost = _fetch(place.recording, decode)
        output = submission.as_handed_in(student.output())
        if exit_code == FAILED:
            raise GraderFailure(_failure(output))
        flags = (why,) if exit_code is None else _flags(exit_code, lost, output, student)
        return _Looked(found, exit_code, lost, place.isolation, output, flags)


def _wait(student: Watched) -> tuple[int | None, str]:
    """Its exit code; None where it has to be ended, and why.

    Raises:
        GraderFailure: it comes to no end.
    """
    end = time.monotonic() + PATIENCE_S
    stopped = 0
    while (left_s := end - time.monotonic()) > 0:
        exit_code = student.wait(min(EVERY_S, left_s))
        if exit_code is not None:
            return exit_code, ""
        stopped = stopped + 1 if usage.look(student.pid).is_stopped else 0
        if stopped >= STOPPED_LOOKS:
            return None, STOPPED
    seconds = f"{PATIENCE_S:.0f}"
    raise GraderFailure(say("looking at the package took more than {seconds} s", seconds=seconds))


def _failure(output: str) -> str:
    """Why the process that looks has failed, which no package should be able to bring about."""
    last = next((line.strip() for line in reversed(output.splitlines()) if line.strip()), "")
    return say(
        "the program that looks at packages failed: {last}. That is no "
        "fault of the package; please report it, with the package",
        last=last[:300],
    )


def command(submission: Submission, asked: Mapping[str, object], leaves: int) -> list[str]:
    """How the process is started; `leaves` is where it leaves what it has found."""
    words = {"root": str(submission.root), **asked, "leaves": leaves}
    if submission.package:
        words["folder"] = str(submission.package)
    return [sys.executable, str(ROOT / load_scene(SCENE).examiner), json.dumps(words)]


def _words(submission: Submission) -> dict[str, object]:
    """What is asked of a package that is looked at."""
    return {"package": submission.start.package if isinstance(submission.start, Whole) else ""}


def _fetch(file: int, decode: Callable[[bytes], Found]) -> tuple[Found | None, str]:
    """What was left, and why it is nothing."""
    try:
        with open(file, "rb", closefd=False) as opened:
            opened.seek(0)
            data = opened.read(MOST_BYTES + 1)
        if len(data) > MOST_BYTES:
            raise ValueError(f"more than {MOST_BYTES} bytes")
        return decode(data), ""
    except (OSError, ValueError, RecursionError) as error:
        return None, f"{error!s:.200}"


def _outcome(exit_code: int | None, lost: str) -> Outcome:
    if exit_code is None:
        return "time_limit"
    if not lost:
        return "finished"
    return "killed" if exit_code < 0 else "crashed"


def _flags(exit_code: int, lost: str, output: str, student: Watched) -> tuple[str, ...]:
    struck = limits_struck(exit_code, output, student.excess)
    return (*struck, *([NOTHING.format(lost)] if lost else []))
