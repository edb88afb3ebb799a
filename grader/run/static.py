"""A run without a clock: one process looks at a submission of which nothing is started.

That process is the submission's, and confined like one, since looking runs a stranger's set-up and
launch files. What it leaves is decoded by its scene as strictly as anything that a submission says.
"""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Final

from grader.recording.recording import Outcome, Recording
from grader.run import stage
from grader.run.environment import virtual_environment
from grader.run.finish import Ending, limits_struck, record
from grader.run.plan import Plan
from grader.run.processes.watched import Watched
from grader.scenes import load_scene
from grader.scenes.scene import Scene, Trace
from grader.submission.opening import Submission, Whole

#: Told the simulated time [s], of which none passes here.
Progress = Callable[[float], None]
#: So long may all of it take [s]; each step within has limits of its own.
PATIENCE_S: Final = 300.0
#: The process leaves no more [bytes].
MOST_BYTES: Final = 32_000_000
ROOT: Final = Path(__file__).resolve().parents[2]
TOO_LONG: Final = f"looking at the package took more than {PATIENCE_S:.0f} s"
NOTHING: Final = "the process that looked at the package left nothing that can be read: {}"


def run(submission: Submission, plan: Plan, progress: Progress | None = None) -> Recording:
    """Look at a submission once.

    Raises:
        GraderFailure: the process could not be started.
    """
    started = time.monotonic()
    scene = load_scene(plan.scene)
    with stage.open_stage() as place:
        submission = place.own(submission)
        student = place.student(
            command(submission, scene, place.recording),
            submission,
            (place.recording,),
            virtual_environment({}),
        )
        try:
            exit_code = student.wait(PATIENCE_S)
        finally:
            student.end(gently=False)
        trace, lost = _fetch(place.recording, scene)
        output = submission.as_handed_in(student.output())
        ending = Ending(
            time="virtual",
            outcome=_outcome(exit_code, lost),
            exit_code=exit_code,
            wall_s=time.monotonic() - started,
            isolation=place.isolation,
            output=output,
            flags=_flags(exit_code, lost, output, student),
        )
    return record(plan, trace, (), ending)


def command(submission: Submission, scene: Scene, leaves: int) -> list[str]:
    """How the process is started; `leaves` is where it leaves what it has found."""
    package = submission.start.package if isinstance(submission.start, Whole) else ""
    words = json.dumps({"root": str(submission.root), "package": package, "leaves": leaves})
    return [sys.executable, str(ROOT / scene.examiner), words]


def _fetch(file: int, scene: Scene) -> tuple[Trace, str]:
    """What was left, and why it is nothing."""
    try:
        with open(file, "rb", closefd=False) as opened:
            opened.seek(0)
            data = opened.read(MOST_BYTES + 1)
        if len(data) > MOST_BYTES:
            raise ValueError(f"more than {MOST_BYTES} bytes")
        return scene.decode(data), ""
    except (OSError, ValueError, RecursionError) as error:
        return scene.untouched(None), f"{error!s:.200}"


def _outcome(exit_code: int | None, lost: str) -> Outcome:
    if exit_code is None:
        return "time_limit"
    if not lost:
        return "finished"
    return "killed" if exit_code < 0 else "crashed"


def _flags(exit_code: int | None, lost: str, output: str, student: Watched) -> tuple[str, ...]:
    if exit_code is None:
        return (TOO_LONG,)
    struck = limits_struck(exit_code, output, student.excess)
    return (*struck, *([NOTHING.format(lost)] if lost else []))
