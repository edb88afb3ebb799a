"""One grading of `grader run`: from the submission to the files of its result.

The verdict is printed as soon as it is known; recordings, pictures and page are written after that,
and modules that only they need are imported then, or during the runs if a core is free.
"""

from __future__ import annotations

import argparse
import importlib
import os
from collections.abc import Callable, Iterable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from rich.console import Console

from grader import grading, judging
from grader.cli import options, say
from grader.exercise.exercise import Exercise
from grader.exercise.loading import load_exercise
from grader.exercise.result.result import (
    ARTIFACTS,
    FAMILY,
    Result,
    artifacts,
    put_artifacts,
)
from grader.grading import Finished
from grader.recording import saving
from grader.recording.recording import Recording, Recordings
from grader.run.opening import marks_of, open_submission
from grader.run.processes import cores
from grader.submission.start import Submission
from grader.system import files
from grader.text.message import msg
from grader.text.translations import tr

if TYPE_CHECKING:
    from grader.cli.live import Live
    from grader.reports.report import Report

#: Where no line can be overwritten, as in a CI log, one is printed this often [simulated s].
LINE_EVERY_S = 10.0
#: Modules that are not needed before a run is over.
LATER = ("grader.recording.bag", "grader.reports.page.html", "grader.reports.terminal")


def grade(args: argparse.Namespace, live: Live | None) -> int:
    """Grade once, and return the exit code."""
    result = graded(args, live)
    return int(args.fail_under is not None and result.score < args.fail_under)


def graded(args: argparse.Namespace, live: Live | None = None) -> Result:
    """Grade once: run, judge, write, print; `live` shows the runs while they go on."""
    out = out_of(args)
    _withdraw(out, args)
    messages = Console(stderr=True, highlight=False)
    if not args.exercise:
        args.named, said = grading.exercise_for(args.submission, marks_of(args.submission))
        say(messages, said)
    exercise = load_exercise(args.exercise or args.named)
    with ExitStack() as held:
        opening = exercise.opening
        started = (args.submission, args.executable, options.launch_asked(args.launch))
        with open_submission(*started, **opening) as submission:
            result, recordings = _run_and_judge(args, submission, exercise, out, held, live)
        report = _report(args, result, recordings, out)
        if live is not None:
            live.know(report)
    return result


def out_of(args: argparse.Namespace) -> Path:
    """Return the folder of the result.

    By default each submission has its own: alice/turtle_controller.py is not bob's.
    """
    out: Path | None = args.out
    absolute = Path(os.path.abspath(args.submission))  # noqa: PTH100  a link keeps its own name
    here = Path.cwd()
    if out is None and absolute.is_relative_to(here) and absolute != here:
        return Path("graded") / absolute.relative_to(here)
    return out or Path("graded") / absolute.parent.name / absolute.name


def _run_and_judge(
    args: argparse.Namespace,
    submission: Submission,
    exercise: Exercise,
    out: Path,
    held: ExitStack,
    live: Live | None,
) -> tuple[Result, Recordings]:
    """Run a submission and judge it; `held` keeps the folder locked."""
    messages = Console(stderr=True, highlight=False)
    say(messages, msg("Found: {found}", found=submission.found))
    secret, seed = options.secret_of(args), args.seed
    if secret:
        seed = exercise.seed_for(Path(os.path.abspath(args.submission)).stem, secret)  # noqa: PTH100
    draw = (seed, options.hides_seed(args))
    plans = grading.plan(submission, exercise, *draw)  # refuses before anything is written
    if live is not None:
        live.open(exercise, submission.name, plans, messages)
    origin = grading.provenance(submission, exercise, *draw)
    _make_folders(out, args.json, held)
    messages.print(_how(args.time, exercise.is_started))

    def show_nominal(nominal: Recording) -> None:
        if live is None and nominal.run.outcome != "stalled":
            return
        from grader.reports.report import Report

        known = judging.judge_nominal(nominal, exercise, submission=submission.name)
        if live is None:  # the others will take as long
            if known.diagnosis is not None:
                say(messages, msg("Seen so far: {cause}", cause=known.diagnosis.cause))
            return
        live.know_of_nominal(Report.of(known, out, Recordings(nominal)))

    runner = grading.runner(exercise, args.time, live)
    at_once = None if live is None else 1
    with (
        _shown(messages, tr("running")) as show,
        grading.start(submission, plans, runner, show, origin, at_once) as runs,
    ):
        if cores.share() > len(plans):
            for module in LATER:
                importlib.import_module(module)
        recordings = grading.gather(_watched(runs, len(plans), show_nominal))
    result = judging.judge(recordings, exercise, submission=submission.name)
    return replace(result, artifacts=artifacts(recordings.nominal)), recordings


def _how(time: str, is_started: bool) -> str:
    if not is_started:
        return tr("Looking at it, and starting nothing ...")
    if time == "virtual":
        return tr("Running it beside a simulator, in virtual time ...")
    return tr("Running it beside a simulator, in real time ...")


def _watched(
    runs: Iterable[Finished], count: int, show_nominal: Callable[[Recording], None]
) -> Iterator[Finished]:
    """Yield each run, and show the nominal one while others go on."""
    for over, (number, recording) in enumerate(runs, 1):
        if number == 0 and over < count:
            show_nominal(recording)
        yield number, recording


def _report(args: argparse.Namespace, result: Result, recordings: Recordings, out: Path) -> Report:
    """Print the result, and write it and the files beside it."""
    from grader.reports import terminal
    from grader.reports.formats import render
    from grader.reports.report import Report

    report, page = Report.of(result, out, recordings), out / Result.PAGE

    def write() -> Path:
        saving.save_all(recordings, out / ARTIFACTS["recording"])
        put_artifacts(recordings.nominal, out)
        shown = render("html", [report]).encode("utf-8")  # where a scene fails, there is no result
        result.put(out)
        if args.json:
            result.write(args.json)
        files.put(page, shown)
        return page

    terminal.show_first(report, write)
    return report


def _withdraw(out: Path, args: argparse.Namespace) -> None:
    """Check that a result can be written, and remove an older one.

    An old result must not remain after a refused call or a failed run.
    """
    copy, path, read = args.json, args.submission, list(options.inputs(args))
    if args.out is None:
        files.check_leads_nowhere_else(out, Path.cwd())
    files.check_leads_nowhere_else(out, path if path.is_dir() else path.parent)
    files.check_can_put(out / Result.FILE, FAMILY, read)
    for name in (ARTIFACTS["canvas"], ARTIFACTS["output"], Result.PAGE):
        files.check_can_put(out / name)
    files.check_can_fill(out / ARTIFACTS["recording"])
    if copy:
        files.check_writable(copy, FAMILY, read)
    if out.is_dir():
        with files.sole_writer(out):
            files.clear(out / Result.FILE)
    if copy:
        files.withdraw(copy)


def _make_folders(out: Path, copy: Path | None, held: ExitStack) -> None:
    """Make the folders, and lock the result's for as long as `held` is open."""
    if copy:
        files.make_folder(copy.parent)
    files.make_folder(out)
    held.enter_context(files.sole_writer(out))
    files.clear(out / Result.FILE)  # another grading may have written one meanwhile
    files.clear(out / ARTIFACTS["recording"])


@contextmanager
def _shown(console: Console, what: str) -> Iterator[Callable[[float], None]]:
    """Show `what` and the simulated seconds; yield the function to call with these."""
    if console.is_terminal:
        with console.status(what) as status:
            yield lambda seconds: status.update(
                tr("{what}: {seconds:.0f} s simulated", what=what, seconds=seconds)
            )
        return
    due = LINE_EVERY_S

    def line(seconds: float) -> None:
        nonlocal due
        if seconds >= due:
            due = seconds + LINE_EVERY_S
            say(console, tr("{what}: {seconds:.0f} s simulated", what=what, seconds=seconds))

    yield line
