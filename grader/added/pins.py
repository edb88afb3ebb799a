"""The folder of added exercises, each with its pin: where it came from, its commit, its hash.

    $XDG_DATA_HOME/turtlesim-grader/exercises/NAME/pin.json     the pin
                                              NAME/exercise/    its files

A folder `exercise` beside a pin.json holds an added exercise wherever it lies: a copy of one, as a
cluster's worker has it, is judged confined as well.
"""

from __future__ import annotations

import os
import uuid
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from grader import content, files, strict_json
from grader.errors import ExerciseError
from grader.message import msg
from grader.removal import remove

PIN, FILES = "pin.json", "exercise"
#: Before the name of an exercise while an update puts another in its place.
_OLDER: Final = ".older-"
#: No pin is longer [bytes].
_MOST_BYTES: Final = 20_000


@dataclass(frozen=True)
class Origin:
    """Where an exercise was added from.

    Attributes:
        address: of the git repository.
        tag: what was asked for of it: a tag, a branch or a commit; '' for its head.
        folder: where in it the exercise lies; '' for its root.
        commit: of which the files are.
        sha256: of the files; see `grader.content`.
    """

    address: str
    tag: str
    folder: str
    commit: str
    sha256: str

    def __str__(self) -> str:
        """What `grader exercises add` was given."""
        tag = f"@{self.tag}" if self.tag else ""
        return self.address + tag + (f"#{self.folder}" if self.folder else "")


@dataclass(frozen=True)
class Pin:
    """The name of an added exercise, and its origin."""

    name: str
    origin: Origin

    def differs(self, folder: Path) -> str:
        """Return the hash of the files in a folder where they are not those; '' where they are.

        Raises:
            OSError: one of them cannot be read.
        """
        found = content.of_folder(folder)
        return "" if found == self.origin.sha256 else found

    def check(self, folder: Path) -> None:
        """Refuse files that are not those that were added.

        Raises:
            ExerciseError: they are others.
            OSError: one of them cannot be read.
        """
        if found := self.differs(folder):
            raise ExerciseError(
                "the exercise {name}, added from {origin}, is no longer what was added: its files "
                "have the hash {found}, expected {wanted}. Fetch them again: grader exercises "
                "update {name}",
                name=self.name,
                origin=str(self.origin),
                found=found,
                wanted=self.origin.sha256,
            )


def home() -> Path:
    """Return the folder of this user's added exercises, which may be missing.

    Raises:
        RuntimeError: this user has no home.
    """
    given = os.environ.get("XDG_DATA_HOME", "")
    # a relative one is to be ignored: https://specifications.freedesktop.org/basedir-spec
    base = Path(given) if given.startswith("/") else Path.home() / ".local" / "share"
    return base / "turtlesim-grader" / "exercises"


def names() -> list[str]:
    """Return the names of the added exercises."""
    with suppress(OSError, RuntimeError):
        places = sorted(home().iterdir())
        return [each.name for each in places if is_name(each.name) and (each / PIN).is_file()]
    return []


def is_name(name: str) -> bool:
    """Whether a name can be that of an added exercise, and of its folder."""
    return bool(name) and not name.startswith(".") and Path(name).name == name


def folder_of(name: str) -> Path | None:
    """Return the folder with the files of an added exercise; None where there is none."""
    with suppress(OSError, RuntimeError):
        if is_name(name) and (home() / name / PIN).is_file():
            return home() / name / FILES
    return None


def around(folder: Path) -> Pin | None:
    """Return the pin of an added exercise; None where a folder holds none.

    Raises:
        ExerciseError: the pin cannot be read.
    """
    folder = folder.resolve()
    path = folder.parent / PIN
    if folder.name != FILES or not os.path.lexists(path):
        return None
    try:
        text = files.read_ours(path, _MOST_BYTES).decode()
        return strict_json.from_json(Pin, strict_json.loads(text))
    except (OSError, ValueError, RecursionError) as error:
        raise ExerciseError(
            "{path} is damaged: {why}. Remove the exercise, and add it again",
            path=str(path),
            why=str(error),
        ) from None


# Writing --------------------------------------------------------------------------------------


@contextmanager
def unfinished() -> Iterator[Path]:
    """Yield an empty folder for an exercise, which `put` moves to its place.

    Raises:
        UsageError: it cannot be made, or another call adds exercises.
    """
    try:
        top = home()
    except RuntimeError as error:
        raise files.cannot_write(Path("~"), str(error)) from None
    files.make_folder(top)
    with files.sole_writer(top), files.writing(top):
        for left in top.glob(".*"):  # by a call that was cut off
            name = left.name.removeprefix(_OLDER)
            if name != left.name and not (top / name).exists():
                left.rename(top / name)
            else:
                remove(left)
        place = top / f".{uuid.uuid4().hex[:12]}"
        (place / FILES).mkdir(parents=True)
        try:
            yield place
        finally:
            remove(place)


def write(place: Path, pin: Pin) -> None:
    """Write the pin of an unfinished exercise.

    Raises:
        UsageError: it cannot be written.
    """
    files.put(place / PIN, strict_json.line(pin))


def put(place: Path, name: str) -> None:
    """Move a finished exercise to its place, instead of an older one.

    Raises:
        UsageError: it cannot be moved.
    """
    there = place.with_name(name)
    older = place.with_name(f"{_OLDER}{name}")
    with files.writing(there):
        if there.exists():
            there.rename(older)
        place.rename(there)
        remove(older)


def drop(name: str) -> None:
    """Remove an added exercise.

    Raises:
        UsageError: it cannot be removed.
    """
    there = home() / name
    with files.sole_writer(home()):
        if not remove(there):
            raise files.cannot_write(there, msg("it cannot be removed"))
