"""Write the folder of a class: every folder moves into its place whole or not at all.

    store/KEY/          the files of one run: recording/, source/, thumb.json, which are linked into
                        the folder of each who handed it in; or error.json
    submissions/ID/     the result of one hand-in; see `grader_class.entry`
    aside/ID/           what is no longer among the submissions
    .unfinished/        what is being made; what an interrupted call has left there is removed

A worker fills a folder below .unfinished; only `grader batch` itself moves it to its place.
"""

from __future__ import annotations

import json
import os
import shutil
import uuid
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from itertools import islice
from pathlib import Path

from grader import Exercise
from grader.recording import Clock
from grader.submission import MAX_ENTRIES, is_generated, is_junk
from grader.system import content, files, remove
from grader.system import versions as system
from grader.text import msg
from grader_class.class_file import CLASS
from grader_class.entry import ENTRY, SUBMISSIONS
from grader_class.export import SOURCE
from grader_class.page.thumb import THUMB

STORE, UNFINISHED, ASIDE = "store", ".unfinished", "aside"
#: What a worker leaves: one run, and a folder for each hand-in.
RUN, STUDENTS = "run", "students"
RECORDING, ERROR = "recording", "error.json"
#: The files of a run that are also in the folder of each who handed it in.
SHARED = (RECORDING, SOURCE, THUMB)
#: Prefix of a folder that is being replaced, beside what replaces it.
_OLDER = "older-"


class Store:
    """The folder of a class; `opened` locks it against other writers."""

    def __init__(self, out: Path) -> None:
        self.out = out

    @classmethod
    @contextmanager
    def opened(cls, out: Path) -> Iterator[Store]:
        """Make the folder, if need be, lock it, and clear what an interrupted call has left."""
        _check_is_ours(out)
        is_new = not out.exists()
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
                    for name in (STORE, SUBMISSIONS, *([""] if is_new else [])):
                        with suppress(OSError):
                            (out / name).rmdir()

    def run(self, key: str) -> Path:
        """The path of a run's folder, also before there is one."""
        return self.out / STORE / key[:2] / key

    def has(self, key: str) -> bool:
        """Whether a run is stored; a stored run is complete."""
        return bool(key) and self.run(key).is_dir()

    def student(self, hand_in: str) -> Path:
        """The path of a hand-in's folder, also before there is one."""
        return self.out / SUBMISSIONS / hand_in

    def set_aside(self, hand_ins: Iterable[str]) -> list[str]:
        """Move the folders of all other hand-ins out of the class, and return their names."""
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
        """Make an empty folder for a worker."""
        place = self.out / UNFINISHED / uuid.uuid4().hex[:12]
        files.make_folder(place)
        return place

    def take_out(self, folder: Path) -> None:
        """Remove a folder, whole: what an interrupted call leaves of it, the next one removes."""
        place = self.new_place()
        with files.writing(folder):
            folder.rename(place / "gone")
        if not remove(place):
            raise files.cannot_write(folder, msg("not all of it can be removed"))

    def put(self, key: str, place: Path) -> None:
        """Move the files of a worker into their places: the run first, then each hand-in."""
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
    """Refuse a folder in which another program's files have our names, or that is a link."""
    for name in (STORE, SUBMISSIONS, ASIDE):
        if (out / name).is_symlink():
            raise files.cannot_write(out / name, msg("it is a link; expected a folder, or nothing"))
    if (out / CLASS).is_file():
        return
    for name in (STORE, SUBMISSIONS):
        if (out / name).is_dir() and next((out / name).iterdir(), None) is not None:
            raise files.cannot_write(
                out,
                msg(
                    "it is no folder of a class ({file} is missing), and there is a folder {name} "
                    "in it already. Give another --out. Nothing was changed.",
                    file=CLASS,
                    name=name,
                ),
            )


def _replace(made: Path, target: Path, place: Path) -> None:
    if os.path.lexists(target):
        target.rename(place / f"{_OLDER}{target.name}")
    made.rename(target)


def _put_back(out: Path) -> None:
    """Restore the folders of hand-ins that an interrupted call had moved aside to replace them."""
    for older in sorted((out / UNFINISHED).glob(f"*/{_OLDER}*")):
        target = out / SUBMISSIONS / older.name.removeprefix(_OLDER)
        if (older / ENTRY).is_file() and not os.path.lexists(target):
            with suppress(OSError):
                older.rename(target)


def _flush(place: Path) -> None:
    """Sync the files to the disk before they get their names: power may fail at any moment."""
    for at, _, names in os.walk(place):
        for path in (Path(at, name) for name in names):
            with suppress(OSError), path.open("rb") as file:  # what cannot be opened is a link
                os.fsync(file.fileno())


def _link_all(run: Path, student: Path) -> None:
    """Put the shared files of a run into a student's folder: as links, else as copies."""
    for name in SHARED:
        if (run / name).is_symlink():
            continue  # the grader makes no links
        if (run / name).is_dir():
            shutil.copytree(run / name, student / name, symlinks=True, copy_function=link)
        elif (run / name).exists():
            link(str(run / name), str(student / name))


def link(source: str, target: str) -> str:
    """Link a file, or copy it where the file system links none; as `shutil.copytree` asks."""
    try:
        os.link(source, target)
    except OSError:
        shutil.copy2(source, target)
    return target


def installed_versions() -> dict[str, str]:
    """Return the versions that a run depends on; the same on all machines of one class."""
    return {
        "grader": system.grader_version(),
        "python": system.python_version(),
        "rclpy": system.rclpy_version(),
        "ros_distro": system.ros_distro(),
    }


def of_run(submission: str, exercise: Exercise, time: Clock, seed: int | None) -> str:
    """Return the key of a run: a hash of everything that it depends on.

    Args:
        submission: the hash of the submission, from `of_hand_in`.
        seed: chooses where the varied runs start; None: the exercise's own.
    """
    depends_on = {
        "submission": submission,
        "scene": exercise.scene,
        "conditions": exercise.conditions,
        "time": time,
        "seed": exercise.varied.seed if seed is None else seed,
        **installed_versions(),
    }
    if exercise.setting:
        depends_on["setting"] = content.of_bytes(exercise.setting.encode())
    return content.of_bytes(json.dumps(depends_on, sort_keys=True).encode())[:32]


def of_hand_in(path: Path, filename: str) -> str:
    """Return the hash of a submission's names and contents.

    What nobody hands in by intention, as a .git, a __pycache__ or a venv, does not count.
    """
    if path.is_dir():
        # no pipe, socket or device: they would be waited for
        found = (each for each in below(path) if each[1].is_symlink() or each[1].is_file())
        # a submission with more files is refused when it is opened
        return content.of_files({name: _hash(at) for name, at in islice(found, MAX_ENTRIES + 1)})
    return content.of_files({filename or path.name: content.of_file(path)})


def below(
    top: Path, is_left_out: Callable[[Path], bool] | None = None
) -> Iterator[tuple[str, Path]]:
    """Yield what is below a folder, as relative name and path; a folder before its content.

    Args:
        is_left_out: whether to leave out a path and all below it; None: what no run would see.
    """
    left_out = is_left_out or _is_unseen
    for at, folders, names in os.walk(top):
        folders[:] = sorted(name for name in folders if not left_out(Path(at, name)))
        others = (name for name in sorted(names) if not left_out(Path(at, name)))
        for path in (Path(at, name) for name in (*folders, *others)):
            yield path.relative_to(top).as_posix(), path


def _is_unseen(path: Path) -> bool:
    if is_junk(path.name):
        return True
    if os.path.islink(path):  # noqa: PTH114  where the path is too long, it is none
        return False
    return not os.access(path, os.R_OK) or (path.is_dir() and is_generated(path))


def _hash(path: Path) -> str:
    if path.is_symlink():
        return content.of_bytes(os.fsencode(path.readlink()))
    return content.of_file(path)
