"""Judge a saved recording again."""

from __future__ import annotations

import argparse
import os
import sys
from dataclasses import dataclass, replace
from pathlib import Path

from grader import judging
from grader.cli import options
from grader.errors import UsageError
from grader.exercise.exercise import Exercise
from grader.exercise.loading import load_exercise
from grader.exercise.places import names
from grader.exercise.result.result import ARTIFACTS, FAMILY, Result
from grader.recording.reading import load_all
from grader.recording.recording import Recordings
from grader.recording.saving import WINDOW_PICTURE
from grader.reports.report import Report
from grader.system import files
from grader.system.extensions import DEFAULT_EXERCISE
from grader.text.message import Message, msg
from grader.text.strings import for_terminal
from grader.text.translations import tr


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the verb's arguments."""
    parser.add_argument(
        "recording",
        type=Path,
        help=tr(
            "the folder of a result, whose page is then made anew; or the folder "
            "`recording` in it; or a recording anywhere else"
        ),
    )
    parser.add_argument(
        "--exercise",
        metavar="NAME|FOLDER|FILE",
        help=tr(
            "an installed one, the folder of another, or an edited exercise.yaml; "
            "default: the one that it was made for"
        ),
    )
    parser.add_argument(
        "--json", type=Path, metavar="FILE", help=tr("write the result here, and nothing else")
    )
    parser.add_argument(
        "--fail-under", type=options.points, metavar="POINTS", help=tr("exit 1 below this score")
    )


def main(args: argparse.Namespace) -> int:
    """Judge without running anything; see `grader.cli` for the exit codes."""
    asked, args.exercise = args.exercise, args.exercise or DEFAULT_EXERCISE
    if args.json:
        files.check_writable(args.json, FAMILY, options.inputs(args))
    place = find_recording(args.recording)
    recordings = load_all(place.recording)
    exercise = _exercise(asked, place, recordings)
    origin = recordings.nominal.provenance
    name = (origin and origin.submission) or (place.older and place.older.submission) or place.name
    result = judging.judge(recordings, exercise, submission=name)
    if place.older is not None and place.older.handed_in is not None:
        result = replace(result, handed_in=place.older.handed_in.by(exercise.late))
    # recordings that were made for exactly this exercise, as far as that is recorded
    is_its = origin is None or origin.exercise_sha256 in ("", exercise.sha256)
    _show(args, place, result, recordings, is_meant=asked is not None or is_its)
    return int(args.fail_under is not None and result.final < args.fail_under)


def _show(
    args: argparse.Namespace,
    place: RecordingPlace,
    result: Result,
    recordings: Recordings,
    is_meant: bool,
) -> None:
    """Write the result where it belongs, and print it.

    Args:
        is_meant: whether a result by this exercise may replace an older one.
    """
    from grader.reports import terminal  # here: it takes long to import

    page, folder = None, place.recording
    if args.json and not _is_same(args.json, place):
        beside = os.path.relpath(place.recording, args.json.parent)
        artifacts = {"recording": beside}
        if recordings.nominal.canvas:
            artifacts["canvas"] = f"{beside}/{WINDOW_PICTURE}"
        result = replace(result, artifacts=artifacts)
        result.write(args.json)
    elif place.older is not None and is_meant:
        result, folder = replace(result, artifacts=place.older.artifacts), place.folder
        page = _rewrite(place, result, recordings)
    elif place.older is not None:
        _report_left(
            msg(
                "the installed exercise {exercise!r} is another one than they were made"
                " with; say with --exercise which one you mean",
                exercise=result.exercise,
            )
        )
    else:
        left = tr(
            "No result is written: no {name} of this recording lies beside it. --json FILE writes "
            "one.",
            name=Result.FILE,
        )
        print(for_terminal(left), file=sys.stderr)
    terminal.show_first(Report.of(result, folder, recordings), lambda: page)


def _exercise(asked: str | None, place: RecordingPlace, recordings: Recordings) -> Exercise:
    """Load the exercise of the call, else the one that the recording was made for."""
    if asked is not None:
        return load_exercise(asked)
    origin = recordings.nominal.provenance
    name = (
        (origin and origin.exercise) or (place.older and place.older.exercise) or DEFAULT_EXERCISE
    )
    if name not in names():
        raise UsageError(
            "the recording was made for the exercise {name!r}, which is not "
            "installed here; give its folder: --exercise FOLDER",
            name=name,
        )
    return load_exercise(name)


def _is_same(file: Path, place: RecordingPlace) -> bool:
    """Whether a file is the result beside the recording."""
    beside = place.folder / Result.FILE
    return place.older is not None and file.exists() and file.samefile(beside)


def _rewrite(place: RecordingPlace, result: Result, recordings: Recordings) -> Path | None:
    """Replace the older result and its page; return the page, None if they cannot be written."""
    from grader.reports.formats import render

    page = place.folder / Result.PAGE
    try:
        for file in (place.folder / Result.FILE, page):
            files.check_can_put(file)
        with files.sole_writer(place.folder):
            result.put(place.folder)
            report = Report.of(result, place.folder, recordings)
            files.put(page, render("html", [report]).encode("utf-8"))
    except UsageError as error:
        _report_left(error.message)
        return None
    return page


def _report_left(why: Message) -> None:
    left = tr("Left as they were: {files}: {why}", files=f"{Result.FILE}, {Result.PAGE}", why=why)
    print(for_terminal(left), file=sys.stderr)


# The recording that a path means ---------------------------------------------------------------


@dataclass(frozen=True)
class RecordingPlace:
    """The place of a recording.

    Attributes:
        recording: its folder.
        older: the result beside it; None where there is none.
    """

    recording: Path
    older: Result | None

    @property
    def folder(self) -> Path:
        """The folder of the older result."""
        return self.recording.parent

    @property
    def name(self) -> str:
        """The name of the folder that contains the result, or else the recording."""
        at = Path(os.path.abspath(self.recording))  # noqa: PTH100  a link keeps its own name
        return at.parent.name if at.name == ARTIFACTS["recording"] else at.name


def find_recording(given: Path) -> RecordingPlace:
    """Find a recording by its folder, that of its result, or a file in one of them."""
    folder = given if given.is_dir() else given.parent
    if (folder / ARTIFACTS["recording"]).is_dir():
        folder /= ARTIFACTS["recording"]
    elif not given.exists():
        return RecordingPlace(given, None)
    beside = folder.parent / Result.FILE
    try:
        older = Result.read(beside) if beside.is_file() else None
    except UsageError:  # another program's, or damaged
        older = None
    if older is not None and older.artifacts.get("recording") != folder.name:
        older = None
    return RecordingPlace(folder, older)
