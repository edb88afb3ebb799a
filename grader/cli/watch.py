"""Grade a submission whenever it is saved, for `grader run --watch`."""

from __future__ import annotations

import argparse
import os
import platform
import time
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from queue import Empty, SimpleQueue
from typing import TYPE_CHECKING

from rich.console import Console
from rich.text import Text
from watchdog.events import FileSystemEvent, FileSystemEventHandler
from watchdog.observers import Observer
from watchdog.observers.api import BaseObserver
from watchdog.observers.polling import PollingObserver

from grader.cli import grade_one, options
from grader.errors import GraderError, UsageError
from grader.reports.wording import points as shown
from grader.result.result import Result
from grader.result.visible import student_view
from grader.text import for_terminal
from grader.translations import tr, translate

if TYPE_CHECKING:
    from grader.cli.live import Live

#: Suffixes of files that can change a verdict. The grader's files have other ones.
SUFFIXES = (".py", ".cfg", ".toml", ".xml", ".zip")
#: Folders in which other programs write such files.
IGNORED_FOLDERS = frozenset({".git", ".venv", "venv", "__pycache__", "build", "install"})
#: An editor's save is several events; it is over after this time without any [s].
QUIET_S = 0.1


def each_save(submission: Path, out: Path | None = None) -> Iterator[None]:
    """Yield at once, and then whenever the submission has been saved; ends at Ctrl-C.

    A save while the caller is busy is not lost. Several events of one save yield once.

    Args:
        out: a folder whose files are ignored, though it may be inside of the submission.

    Raises:
        UsageError: the folder to watch does not exist.
    """
    # The folder of a single file is watched: many editors replace a file instead of writing it.
    is_folder = submission.is_dir()
    folder = (submission if is_folder else submission.parent).absolute()
    if not folder.is_dir():
        raise UsageError(
            "cannot watch {submission}: {folder} does not exist",
            submission=submission,
            folder=folder,
        )
    saves = Saves(folder, None if is_folder else submission.name, out and out.absolute())
    observer = _watching(saves, folder, is_folder)
    try:
        reported = saves.state()
        yield
        while True:
            saves.wait()
            found = saves.state()
            if found != reported:
                reported = found
                yield
    finally:
        observer.stop()
        observer.join()


class Saves(FileSystemEventHandler):
    """Queues saves until the caller waits for them.

    Args:
        folder: what is watched.
        only: the name of the only file in it that counts; None for all.
        out: a folder in it whose files are ignored.
    """

    def __init__(self, folder: Path, only: str | None, out: Path | None = None) -> None:
        self._folder = folder
        self._only = only
        self._out = out
        self._seen: SimpleQueue[FileSystemEvent] = SimpleQueue()

    def on_any_event(self, event: FileSystemEvent) -> None:
        """Queue a save; watchdog calls this in its thread."""
        # not "opened" and "closed": grading reads the files
        if event.event_type not in ("created", "modified", "moved", "deleted"):
            return
        paths = (event.src_path, getattr(event, "dest_path", ""))
        if not event.is_directory and any(self._counts(os.fsdecode(p)) for p in paths if p):
            self._seen.put(event)

    def wait(self) -> None:
        """Wait for a save, and until it is over."""
        self._seen.get()
        try:
            while True:
                self._seen.get(timeout=QUIET_S)
        except Empty:
            return

    def state(self) -> dict[str, tuple[int, int, int]]:
        """Return inode, size and time of each file that counts: they differ after a save."""
        found = {}
        for at, folders, names in os.walk(self._folder):
            kept = (each for each in folders if each not in IGNORED_FOLDERS)
            folders[:] = [] if self._only is not None else sorted(kept)
            for path in (Path(at, name) for name in names):
                with suppress(OSError):  # it has just gone
                    if self._counts(str(path)):
                        stat = path.stat()
                        found[str(path)] = (stat.st_ino, stat.st_size, stat.st_mtime_ns)
        return found

    def _counts(self, name: str) -> bool:
        path = Path(name)
        if self._only is not None:
            return path == self._folder / self._only
        if self._out is not None and path.is_relative_to(self._out):
            return False  # the folder may be named like a file: graded/node.py
        inside = path.relative_to(self._folder) if path.is_relative_to(self._folder) else path
        return path.suffix in SUFFIXES and IGNORED_FOLDERS.isdisjoint(inside.parts)


def _watching(saves: Saves, folder: Path, recursive: bool) -> BaseObserver:
    """Start an observer that reports to `saves`."""
    # WSL gets no events of files on Windows, so there they are polled
    if "microsoft" not in platform.release().lower():
        try:
            return _start(Observer(), saves, folder, recursive)
        except OSError:
            pass  # e.g. the system's limit of watched files is reached
    return _start(PollingObserver(), saves, folder, recursive)


def _start(observer: BaseObserver, saves: Saves, folder: Path, recursive: bool) -> BaseObserver:
    observer.schedule(saves, str(folder), recursive=recursive)
    observer.start()
    return observer


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
        console.print(Text(line, "bold"), soft_wrap=True)
        last = seen
    except GraderError as error:
        messages.print(Text(for_terminal(translate(error.message))), soft_wrap=True)
        options.write(error, args)
    messages.print(tr("Waiting for the next save; Ctrl-C ends."), style="dim")
    return last


def change(last: Result | None, result: Result) -> str:
    """Return a score compared with the last one: '62 -> 80 (+18)'."""
    score = shown(result.score)
    if last is None:
        return tr("{score} of {max_score}", score=score, max_score=shown(result.max_score))
    by = round(result.score - last.score, 2)
    sign = "+" if by > 0 else ""
    return (
        f"{shown(last.score)} -> {score} ({sign}{shown(by)})"
        if by
        else tr("{score}, as before", score=score)
    )
