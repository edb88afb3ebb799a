"""Grade a submission whenever it is saved, for `grader run --watch`."""

from __future__ import annotations

import argparse
import os
import time
from collections.abc import Iterator
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from rich.console import Console

from grader.cli import grade_one, options, say
from grader.errors import GraderError, UsageError
from grader.exercise.result.result import Result
from grader.exercise.result.visible import student_view
from grader.reports.wording import points as shown
from grader.text.translations import tr

if TYPE_CHECKING:
    from grader.cli.live import Live

#: Suffixes of files that can change a verdict. The grader's files have other ones.
SUFFIXES = (".py", ".cfg", ".toml", ".xml", ".zip")
#: Folders in which other programs write such files.
IGNORED_FOLDERS = frozenset({".git", ".venv", "venv", "__pycache__", "build", "install"})
#: How often the files are looked at: a save is over when they are the same twice [s].
QUIET_S = 0.1


def each_save(submission: Path, out: Path | None = None) -> Iterator[None]:
    """Yield at once, and then whenever the submission has been saved; ends at Ctrl-C.

    A save while the caller is busy is not lost. The files are looked at again and again: events of
    the system's are missing on some file systems, as on that of Windows in WSL.

    Args:
        out: a folder whose files are ignored, though it may be inside of the submission.
    """
    folder = (submission if submission.is_dir() else submission.parent).absolute()
    if not folder.is_dir():
        raise UsageError(
            "cannot watch {submission}: {folder} does not exist",
            submission=submission,
            folder=folder,
        )
    only = None if submission.is_dir() else submission.name
    look = partial(state, folder, only, out and out.absolute())
    reported = before = look()
    yield
    while True:
        began_s = time.monotonic()
        found = look()
        took_s = time.monotonic() - began_s
        if found == before != reported:  # an editor's save is several changes
            reported = found
            yield
        before = found
        time.sleep(max(QUIET_S, 4 * took_s))  # a large folder takes a fifth of a core at most


def state(folder: Path, only: str | None, out: Path | None) -> dict[Path, tuple[int, int, int]]:
    """Return inode, size and time of each file that counts: they differ after a save.

    Args:
        only: the name of the only file that counts; None for all in the folder and below.
        out: a folder in it whose files are ignored.
    """
    found = {}
    for at, folders, names in os.walk(folder):
        kept = (each for each in folders if each not in IGNORED_FOLDERS and Path(at, each) != out)
        folders[:] = [] if only is not None else kept
        for path in (Path(at, name) for name in names):
            if path.name == only if only is not None else path.suffix in SUFFIXES:
                with suppress(OSError):  # it has just gone
                    stat = path.stat()
                    found[path] = (stat.st_ino, stat.st_size, stat.st_mtime_ns)
    return found


def grade_each_save(args: argparse.Namespace, live: Live | None) -> int:
    """Grade again and again, until Ctrl-C."""
    last = None
    for number, _ in enumerate(each_save(args.submission, grade_one.out_of(args))):
        last = grade_again(args, live, last, clears=number > 0)
    return 0


def grade_again(
    args: argparse.Namespace, live: Live | None, last: Result | None, *, clears: bool
) -> Result | None:
    """Grade once more, and return the result to compare the next one with.

    A submission that cannot be used now may be usable after the next save.
    """
    console, messages = Console(highlight=False), Console(stderr=True, highlight=False)
    if clears and console.is_terminal:
        console.clear()
    options.prepare(args)
    try:
        seen = student_view(grade_one.graded(args, live))
        line = f"{time.strftime('%H:%M:%S')}  {change(last, seen)}"
        say(console, line, "bold")
        last = seen
    except GraderError as error:
        say(messages, error.message)
        options.write(error, args)
    messages.print(tr("Waiting for the next save; Ctrl-C ends."), style="dim")
    return last


def change(last: Result | None, result: Result) -> str:
    """Return a score compared with the last one: '62 -> 80 (+18)'."""
    score = shown(result.score)
    if last is None:
        return tr("{score} of {max_score}", score=score, max_score=shown(result.max_score))
    by = round(result.score - last.score, 2)
    if not by:
        return tr("{score}, as before", score=score)
    return f"{shown(last.score)} -> {score} ({'+' if by > 0 else ''}{shown(by)})"
