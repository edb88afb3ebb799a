"""Play a graded run: the window at every moment, what came in, what the checks say."""

from __future__ import annotations

import argparse
from pathlib import Path

from grader.cli import options
from grader.cli.check import RecordingPlace, find_recording
from grader.errors import RecordingError, UsageError
from grader.exercise.result.result import ARTIFACTS, Result
from grader.exercise.result.visible import View
from grader.recording.reading import load_all
from grader.recording.recording import Recordings
from grader.recording.subject import scene_at_work
from grader.reports import playback
from grader.reports.report import Report
from grader.scenes.playback import Playback
from grader.scenes.subject import load_subject
from grader.system import files
from grader.text.message import Message, msg
from grader.text.strings import for_terminal
from grader.text.translations import tr
from turtlesim_py import browser

#: The name of the page beside a result.
NAME = "view.html"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the verb's arguments."""
    parser.add_argument(
        "recording",
        type=Path,
        help=tr("the folder of a result, the result in it, or a recording anywhere else"),
    )
    parser.add_argument(
        "--compare",
        type=Path,
        metavar="OTHER",
        help=tr(
            "another one, as a last attempt: both ways in one window, how far "
            "apart, and the first input that differs"
        ),
    )
    parser.add_argument(
        "--out",
        type=Path,
        metavar="FILE",
        help=tr("default: {name} beside the result", name=NAME),
    )
    parser.add_argument(
        "--no-open",
        action="store_true",
        help=tr("do not show the page in a browser, only write it"),
    )
    options.add_view(parser, tr("for teachers: also what the exercise hides"))


def main(args: argparse.Namespace) -> int:
    """Write the page, and show it; see `grader.cli` for the exit codes."""
    seen = options.view_of(args)
    place = find_recording(args.recording)
    if args.out is not None:
        files.check_writable(args.out)
        for given in options.inputs(args):  # no file that the page is made of is overwritten
            part = find_recording(given)
            beside = (
                part.folder / name for name in (Result.FILE, Result.PAGE, *ARTIFACTS.values())
            )
            files.check_is_no_input(args.out, [given, *beside, *part.recording.rglob("*")])
    recordings = load_all(place.recording)
    render = load_subject(recordings.nominal.scene).player
    if render is None:
        raise UsageError(_not_played(place, recordings))
    other = None if args.compare is None else _other(args.compare, recordings, seen)
    playback = _playback(place, recordings, seen, other)
    with scene_at_work(recordings.nominal.scene, RecordingError):
        content = render(playback)
    page = place.folder / NAME if args.out is None else args.out
    if args.out is None:
        files.put(page, content.encode("utf-8"))
    else:
        files.write(page, content)
    print(for_terminal(tr("The page that plays it: {page}", page=page)))
    if not args.no_open and page.is_file():
        browser.show(page.resolve().as_uri())
    return 0


def _not_played(place: RecordingPlace, recordings: Recordings) -> Message:
    scene = recordings.nominal.scene
    page = place.folder / Result.PAGE
    instead = msg("look at {page}", page=page)
    if not page.is_file():
        instead = msg("{page} beside its result shows it", page=Result.PAGE)
    return msg(
        "a recording of the scene {scene!r} cannot be played; {instead}",
        scene=scene,
        instead=instead,
    )


def _other(given: Path, recordings: Recordings, seen: View) -> Playback:
    place = find_recording(given)
    other = load_all(place.recording)
    if other.nominal.scene != recordings.nominal.scene:
        raise UsageError(
            "cannot compare recordings of the scenes {scene!r} and {other!r}; give"
            " two of one scene",
            scene=recordings.nominal.scene,
            other=other.nominal.scene,
        )
    return _playback(place, other, seen, None)


def _playback(
    place: RecordingPlace, recordings: Recordings, seen: View, other: Playback | None
) -> Playback:
    older = place.older
    report = None if older is None else Report.of(older, place.folder, recordings, seen)
    origin = recordings.nominal.provenance
    name = (origin and origin.submission) or place.name
    return playback.of(name, recordings, report, other)
