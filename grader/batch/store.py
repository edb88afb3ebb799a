"""The folder of a class, as it is written: everything comes into its place whole or not at all.

    store/KEY/          what one run has left: recording/, source/, similar.json, thumb.json, which
                        everybody who has handed it in has too; or error.json
    submissions/ID/     what came of it for one hand-in; see `grader.batch.entry`
    aside/ID/           what is no longer among the submissions
    before/N/           what a regrade has replaced; see `grader.batch.regrade.applying`
    .unfinished/        what is being made; whatever an interrupted call has left there goes

A worker fills a folder below .unfinished; only `grader batch` itself moves it to its place.
"""

from __future__ import annotations

import os
import shutil
import uuid
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from grader import files
from grader.batch.class_file import CLASS
from grader.batch.entry import ENTRY, SUBMISSIONS
from grader.batch.page.thumb import THUMB
from grader.batch.similar.behaviour import NAME as BEHAVIOUR
from grader.batch.similar.sources import SOURCE
from grader.language.phrase import Phrase, say
from grader.removal import remove

STORE, UNFINISHED, ASIDE, BEFORE = "store", ".unfinished", "aside", "before"
#: What a worker leaves: one run, and a folder for each hand-in.
RUN, STUDENTS = "run", "students"
RECORDING, ERROR = "recording", "error.json"
#: What of a run lies in the folder of everybody who has handed it in, too.
SHARED = (RECORDING, SOURCE, BEHAVIOUR, THUMB)
#: Before the name of what is being replaced, beside what replaces it.
_OLDER = "older-"


class Store:
    """The folder of a class; nobody else writes into it while `opened` holds."""

    def __init__(self, out: Path) -> None:
        self.out = out

    @classmethod
    @contextmanager
    def opened(cls, out: Path) -> Iterator[Store]:
        """Make the folder, if need be, and clear what an interrupted call has left.

        Raises:
            UsageError: it cannot be written, or another grading writes into it.
        """
        _check_is_ours(out)
        files.make_folder(out)
        with files.sole_writer(out):
            _put_back(out)
            remove(out / UNFINISHED)
            try:
                for name in (STORE, SUBMISSIONS, UNFINISHED):
                    files.make_folder(out / name)
                yield cls(out)
            finally:
                remove(out / UNFINISHED)
                if not (out / CLASS).is_file():  # refused: nothing is left of it
                    for name in (STORE, SUBMISSIONS, ""):
                        with suppress(OSError):
                            (out / name).rmdir()

    def run(self, key: str) -> Path:
        """Where a run is, or will be."""
        return self.out / STORE / key[:2] / key

    def has(self, key: str) -> bool:
        """Whether a run is there; then it is whole."""
        return bool(key) and self.run(key).is_dir()

    def student(self, hand_in: str) -> Path:
        """Where the folder of a hand-in is, or will be."""
        return self.out / SUBMISSIONS / hand_in

    def set_aside(self, hand_ins: Iterable[str]) -> list[str]:
        """Move all folders of hand-ins but these out of the class; which they were.

        Raises:
            UsageError: one cannot be moved.
        """
        ids = set(hand_ins)
        others = [path for path in (self.out / SUBMISSIONS).glob("*/") if path.name not in ids]
        try:
            for path in others:
                remove(self.out / ASIDE / path.name)
                files.make_folder(self.out / ASIDE)
                path.rename(self.out / ASIDE / path.name)
        except OSError as error:
            raise files.cannot_write(self.out, str(error)) from None
        return sorted(path.name for path in others)

    def new_place(self) -> Path:
        """An empty folder for a worker.

        Raises:
            UsageError: it cannot be made.
        """
        place = self.out / UNFINISHED / uuid.uuid4().hex[:12]
        files.make_folder(place)
        return place

    def put(self, key: str, place: Path) -> None:
        """Move what a worker has made to its place: the run first, then each hand-in.

        Raises:
            UsageError: it cannot be written.
        """
        try:
            _flush(place)
            if (place / RUN).is_dir():
                self.run(key).parent.mkdir(exist_ok=True)
                _replace(place / RUN, self.run(key), place)
            for made in sorted((place / STUDENTS).glob("*/")):
                if key:
                    _link_all(self.run(key), made)
                _replace(made, self.student(made.name), place)
        except OSError as error:
            raise files.cannot_write(self.out, str(error)) from None
        remove(place)


def _check_is_ours(out: Path) -> None:
    """Refuse a folder in which somebody else's files have our names, or links lead out of it."""
    for name in (STORE, SUBMISSIONS, ASIDE, BEFORE):
        if (out / name).is_symlink():
            raise files.cannot_write(out / name, say("it is a link; expected a folder, or nothing"))
    if (out / CLASS).is_file():
        return
    for name in (STORE, SUBMISSIONS):
        if (out / name).is_dir() and next((out / name).iterdir(), None) is not None:
            raise files.cannot_write(
                out,
                say(
                    "it is no folder of a class ({file} is missing), and there is a folder {name} "
                    "in it already. Give another --out. Nothing was changed.",
                    file=CLASS,
                    name=Phrase(name),
                ),
            )


def _replace(made: Path, target: Path, place: Path) -> None:
    if os.path.lexists(target):
        target.rename(place / f"{_OLDER}{target.name}")
    made.rename(target)


def _put_back(out: Path) -> None:
    """Give a hand-in its folder back that an interrupted call had taken away to replace it."""
    for older in sorted((out / UNFINISHED).glob(f"*/{_OLDER}*")):
        target = out / SUBMISSIONS / older.name.removeprefix(_OLDER)
        if (older / ENTRY).is_file() and not os.path.lexists(target):
            with suppress(OSError):
                older.rename(target)


def _flush(place: Path) -> None:
    """Have it on the disk before it gets its name: power may go at any moment."""
    for at, _, names in os.walk(place):
        for path in (Path(at, name) for name in names):
            with suppress(OSError), path.open("rb") as file:  # what cannot be opened is a link
                os.fsync(file.fileno())


def _link_all(run: Path, student: Path) -> None:
    """What is shared, in a student's folder too: as links, or as copies where there are none."""
    for name in SHARED:
        if (run / name).is_symlink():
            continue  # none of ours
        if (run / name).is_dir():
            shutil.copytree(run / name, student / name, symlinks=True, copy_function=_link)
        elif (run / name).exists():
            _link(str(run / name), str(student / name))


def _link(source: str, target: str) -> str:
    try:
        os.link(source, target)
    except OSError:
        shutil.copy2(source, target)
    return target
