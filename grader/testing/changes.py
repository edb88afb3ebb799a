"""What makes a mutant of a right solution: passages replaced, files written, files taken away."""

from __future__ import annotations

import shutil
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from grader.errors import ExerciseError


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


def read(words: Mapping[str, Any]) -> tuple[Change, ...]:
    """The changes that `replace` and `files` of a mutant name.

    Raises:
        TypeError, KeyError: they are no such.
    """
    replaced = [
        Change(str(each["old"]), str(each["new"]), str(each.get("in", "")))
        for each in words.get("replace", ())
    ]
    files = words.get("files", {})
    written = [Change(None, None if t is None else str(t), str(f)) for f, t in files.items()]
    return (*replaced, *written)


def changed(name: str, path: Path, changes: Sequence[Change]) -> Mapping[str, str | None]:
    """File -> its text with the changes, None where it is taken away; '' is the solution itself.

    Raises:
        ExerciseError: a passage does not stand there exactly once, or there is no such file.
    """
    texts: dict[str, str | None] = {}
    for change in changes:
        file = path / change.file if change.file else path
        if change.old is None:
            texts[change.file] = change.new
            continue
        text = texts.get(change.file)
        if text is None:
            if not file.is_file():
                raise ExerciseError(f"mutants: {name}: there is no file {change.file!r} in {path}")
            text = file.read_text(encoding="utf-8")
        if text.count(change.old) != 1:
            raise ExerciseError(
                f"mutants: {name}: {change.old!r} stands {text.count(change.old)} times in "
                f"{file.name}; expected once"
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
            target.unlink(missing_ok=True)
        else:
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_text(text, encoding="utf-8")
    return copy
