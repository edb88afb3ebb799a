"""A folder of files and folders, one a student: `alice.py`, `bob/`, `carol.zip`."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Final

from grader.batch.find.attempt import Attempt, Item, Piece, Reading, person
from grader.language.phrase import say
from grader.submission.folder import listed, shown
from grader.submission.unpacking import is_archive

LAYOUT: Final = say("a plain folder, with one file or folder a student")
#: What lies beside hand-ins and is none.
_OTHERS: Final = (".csv", ".json", ".md", ".ods", ".txt", ".xls", ".xlsx", ".yaml", ".yml", ".html")
#: With any of these at its top a folder is a package.
_PACKAGE: Final = ("setup.py", "setup.cfg", "pyproject.toml", "package.xml", "CMakeLists.txt")
#: Folders of a colcon workspace.
_WORKSPACE: Final = {"src", "build", "install", "log"}


def one_submission(items: Sequence[Item]) -> str:
    """What says that a folder is itself one submission; '' if nothing does."""
    names = {item.name for item in items}
    if found := [name for name in _PACKAGE if name in names]:
        return found[0]
    folders = {item.name for item in items if item.is_folder}
    return "src" if "src" in folders and folders <= _WORKSPACE else ""


def read(items: Sequence[Item]) -> Reading:
    """The hand-ins in one."""
    own = [item for item in items if _may_be_one(item)]
    others = [item.name for item in items if not _may_be_one(item)]
    # of alice.py and alice.zip the first of this order is taken, and the other told
    own.sort(key=lambda item: (not item.is_folder, not is_archive(item.path)))
    notes, whose = [], dict[str, Item]()
    for item in own:
        name = stem(item)
        if name in whose:
            notes.append(
                say(
                    "{file} is left out: {other} is of the same name.",
                    file=shown(item.name),
                    other=shown(whose[name].name),
                )
            )
        else:
            whose[name] = item
    attempts = [
        Attempt(name, (person(name),), (Piece(item.path, "" if item.is_folder else item.name),))
        for name, item in sorted(whose.items())
    ]
    if others:
        notes.append(say("Left out, since they are no submissions: {names}.", names=listed(others)))
    return Reading(LAYOUT, attempts, notes)


def stem(item: Item) -> str:
    """A name without the ending that says what kind of file it is."""
    if item.is_folder:
        return item.name
    name = re.sub(r"\.tar\.gz$", ".tgz", item.name, flags=re.IGNORECASE)
    return name.rpartition(".")[0] or name


def _may_be_one(item: Item) -> bool:
    return item.is_folder or not item.name.lower().endswith(_OTHERS)
