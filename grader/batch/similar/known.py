"""What everybody was given, or may have read: it says nothing about two who have it in common.

That is the exercise's starter, its right solutions as far as it names them (mutants.yaml), and the
Python in its sheet.
"""

from __future__ import annotations

import re
import textwrap
from collections.abc import Iterator
from pathlib import Path

from grader.batch.similar.sources import File
from grader.errors import ExerciseError
from grader.exercise.exercise import Exercise
from grader.language.phrase import say
from grader.testing.solutions import FILE_NAME, read_solutions

_FENCED = re.compile(r"^```[^\n]*\n(.*?)^```", re.MULTILINE | re.DOTALL)
_INDENTED = re.compile(r"(?:^ {4,}[^\n]*\n(?:[ \t]*\n)*)+", re.MULTILINE)


def files(exercise: Exercise) -> list[File]:
    """The files that are known, by where they are from.

    Raises:
        ExerciseError: its mutants.yaml cannot be used.
        OSError: one of them cannot be read.
    """
    found = [File(f"sheet/passage_{n}.py", text) for n, text in enumerate(_passages(exercise), 1)]
    if exercise.starter is not None:
        found += _below(exercise.starter, "starter")
    for path in _right_solutions(exercise):
        found += _below(path, "reference")
    return sorted(set(found))


def _right_solutions(exercise: Exercise) -> Iterator[Path]:
    if (exercise.folder / FILE_NAME).is_file():
        yield from (each.path for each in read_solutions(exercise) if each.is_right)


def _below(path: Path, whose: str) -> list[File]:
    if not path.exists():
        raise ExerciseError(
            say("there is no {path}, which is to be known to everybody", path=str(path))
        )
    if path.is_file():
        return [File(f"{whose}/{path.name}", path.read_bytes())]
    below = sorted(path.rglob("*.py"))
    return [File(f"{whose}/{p.relative_to(path).as_posix()}", p.read_bytes()) for p in below]


def _passages(exercise: Exercise) -> Iterator[bytes]:
    for pattern in (_FENCED, _INDENTED):
        for match in pattern.finditer(exercise.task):
            text = match[1] if match.lastindex else match[0]
            yield textwrap.dedent(text).encode("utf-8", "replace")
