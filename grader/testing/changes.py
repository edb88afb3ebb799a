"""What makes a mutant of a right solution: files written or taken away, and passages replaced."""

from __future__ import annotations

import shutil
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from grader.errors import ExerciseError
from grader.exercise import places
from grader.language.phrase import say

#: The keys of a solution that is made of the first one.
MADE = frozenset(("replace", "files", "put"))


@dataclass(frozen=True)
class Change:
    """One of them.

    Attributes:
        old, new: a passage that stands there exactly once, and what stands there instead. Without
            `old`, `new` is all of the file, and None takes it away.
        file: in which file of a folder; '' where the solution is a file.
    """

    old: str | None
    new: str | None
    file: str = ""


def read(words: Mapping[str, Any], program: str, folder: Path) -> tuple[Change, ...]:
    """The changes that `put`, `files` and `replace` name, in this order.

    Args:
        program: the file of a folder in which passages stand where `in` names none.
        folder: beside what is `put` somewhere.

    Raises:
        TypeError, KeyError, AttributeError: they are no such.
        OSError: what is put somewhere cannot be read.
    """
    put = {
        file: places.locate(folder, str(where)).read_text(encoding="utf-8")
        for file, where in words.get("put", {}).items()
    }
    written = {**put, **words.get("files", {})}
    return (
        *(Change(None, None if t is None else str(t), str(f)) for f, t in written.items()),
        *(
            Change(str(each["old"]), str(each["new"]), str(each.get("in", program)))
            for each in words.get("replace", ())
        ),
    )


def changed(name: str, path: Path, changes: Sequence[Change]) -> Mapping[str, str | None]:
    """File -> its text with the changes, None where it is taken away; '' is the solution itself.

    Raises:
        ExerciseError: a passage does not stand there exactly once, or there is no such file.
    """
    texts: dict[str, str | None] = {}
    for change in changes:
        file = path / change.file if change.file else path
        is_there = texts[change.file] is not None if change.file in texts else file.is_file()
        if not is_there and (change.old is not None or change.new is None):
            raise ExerciseError(
                say(
                    "mutants: {name}: there is no file {file!r} in {path}",
                    name=name,
                    file=change.file,
                    path=str(path),
                )
            )
        if change.old is None:
            texts[change.file] = change.new
            continue
        text = texts.get(change.file) or file.read_text(encoding="utf-8")
        if text.count(change.old) != 1:
            raise ExerciseError(
                say(
                    "mutants: {name}: {old!r} stands {count} times in {in_file}; expected once",
                    name=name,
                    old=change.old,
                    count=text.count(change.old),
                    in_file=file.name,
                )
            )
        texts[change.file] = text.replace(change.old, change.new or "")
    return texts


def lay_out(name: str, path: Path, changes: Sequence[Change], folder: Path) -> Path:
    """A changed copy in a new folder."""
    copy = folder / name / path.name
    texts = changed(name, path, changes)
    if path.is_dir():
        shutil.copytree(path, copy, ignore=shutil.ignore_patterns("__pycache__"))
    else:
        copy.parent.mkdir(parents=True)
    for file, text in texts.items():
        target = copy / file if file else copy
        if text is None:
            target.unlink()
        else:
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_text(text, encoding="utf-8")
    return copy
