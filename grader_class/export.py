"""Keep the sources of a class, and export them for compare50, JPlag and Dolos.

    DIR/submissions/ID/source/        the Python files of a hand-in
    export/jplag/students/ID/...py    a folder for each hand-in
    export/jplag/base/...py           what everybody was given
    export/dolos.zip                  students/ID.py, starter.py, info.csv

    compare50 export/jplag/students/* -d export/jplag/base/* -o REPORT
    java -jar jplag.jar -l python3 export/jplag/students -bc export/jplag/base
    dolos run -l python export/dolos.zip

Names are made valid for every system; files beyond the limits are left out. What everybody was
given, or may have read, is no sign of copying: the exercise's starter, and its right solutions if
it names them (mutants.yaml).

JPlag reads each folder below the given one as a submission, and ignores what matches the base code
(its wiki, How to Use JPlag). Dolos compares files, so each hand-in is one file; its info.csv has a
row for each, and the one whose `ignored` is true is the template (its docs, Adding metadata;
dataset.ts).
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Final, NamedTuple

from grader import Exercise, SubmissionError, errors
from grader.submission import files_below, read_bounded
from grader.system import files as whole_files
from grader.system import remove
from grader.testing import right_solutions
from grader_class.entry import Entry
from grader_class.reports.csv import cell, table
from grader_class.zipping import zipped

SOURCE: Final = "source"
MOST_FILES: Final = 60
MOST_BYTES: Final = 1_000_000  # of all of them together
_STRANGE = re.compile(r"[^A-Za-z0-9._+-]|^[.-]")
FOLDER: Final = "export"
JPLAG, DOLOS = "jplag", "dolos.zip"
_GIVEN: Final = "starter.py"


class File(NamedTuple):
    """A kept file: its name below the folder, with '/', and its content."""

    name: str
    data: bytes


def keep(copy: Path, into: Path) -> None:
    """Copy the sources of a submission into a folder, which is made anew.

    Args:
        copy: the private copy of the submission; links out of it are not followed.
    """
    remove(into)
    into.mkdir(parents=True)
    names: set[str] = set()
    size = 0
    for path in _sources(copy):
        data = read_bounded(path)
        if data is None or len(names) >= MOST_FILES or size + len(data) > MOST_BYTES:
            continue
        size += len(data)
        target = into / _free_name(path.relative_to(copy), names)
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes(data)


def kept(folder: Path) -> list[File]:
    """Return the files that `keep` has written, sorted by name; empty where there is no folder."""
    if folder.is_symlink():
        return []  # the grader makes no links
    paths = [path for path in folder.rglob("*.py") if path.is_file() and not path.is_symlink()]
    named = sorted((path.relative_to(folder).as_posix(), path) for path in paths)
    return [File(name, read_bounded(path) or b"") for name, path in named[:MOST_FILES]]


def _sources(copy: Path) -> Iterator[Path]:
    base = os.path.realpath(copy)
    try:
        found = files_below(copy)
    except SubmissionError:  # too many files to be graded
        return
    for path in found:
        inside = Path(os.path.realpath(path)).is_relative_to(base)
        if path.suffix == ".py" and path.is_file() and inside:
            yield path


def _free_name(path: Path, names: set[str]) -> str:
    """Return an unused name for a file, also on systems that ignore case; add it to `names`."""
    parts = [_STRANGE.sub("_", part)[:80] for part in path.with_suffix("").parts]
    stem, number = "/".join(parts), 1
    name = f"{stem}.py"
    while name.lower() in names:
        number += 1
        name = f"{stem}_{number}.py"
    names.add(name.lower())
    return name


def given_files(exercise: Exercise) -> list[File]:
    """Return the files that everybody was given, named by their origin."""
    starter = exercise.starter_files("").items()
    found = [File(f"starter/{name}", data) for name, data in starter if name.endswith(".py")]
    for path in right_solutions(exercise):
        found += _below(path)
    return sorted(set(found))


def _below(path: Path) -> list[File]:
    if not path.exists():
        raise errors.ExerciseError(
            "there is no {path}, which is to be known to everybody", path=str(path)
        )
    if path.is_file():
        return [File(f"reference/{path.name}", path.read_bytes())]
    below = sorted(path.rglob("*.py"))
    return [File(f"reference/{p.relative_to(path).as_posix()}", p.read_bytes()) for p in below]


def write_exports(entries: Sequence[Entry], exercise: Exercise, out: Path) -> None:
    """Write both exports into the folder of a class; they contain ids, but no names."""
    with whole_files.writing(out / FOLDER):
        given = given_files(exercise)
        sources = [(entry, kept(entry.folder / SOURCE)) for entry in entries]
        present = [(entry, files) for entry, files in sources if files]
        _write_jplag(present, given, out / FOLDER / JPLAG)
        whole_files.put(out / FOLDER / DOLOS, dolos(present, given))


def dolos(present: Sequence[tuple[Entry, list[File]]], given: Sequence[File]) -> bytes:
    members = {f"students/{entry.id}.py": _joined(files) for entry, files in present}
    rows = [_row(entry) for entry, _ in present]
    if given:
        members[_GIVEN] = _joined(given)
        rows.append([_GIVEN, "given", "", "true"])
    has_times = all(row[2] for row in rows[: len(present)])
    # an empty time is an error to Dolos, a missing column is not
    shown = [
        row if has_times else [*row[:2], row[3]]
        for row in (["filename", "full_name", "created_at", "ignored"], *rows)
    ]
    members["info.csv"] = table(shown).encode("utf-8")
    return zipped(sorted(members.items()))


def _row(entry: Entry) -> list[str]:
    at = entry.hand_in.at
    return [f"students/{entry.id}.py", cell(entry.id), "" if at is None else at.isoformat(" "), ""]


def _joined(files: Sequence[File]) -> bytes:
    """Join files into one, each below its name."""
    if len(files) == 1:
        return files[0].data
    parts = (f"# {file.name}\n".encode() + file.data.rstrip(b"\n") + b"\n" for file in files)
    return b"\n".join(parts)


def _write_jplag(
    present: Sequence[tuple[Entry, list[File]]], given: Sequence[File], folder: Path
) -> None:
    remove(folder)
    below = [(f"students/{entry.id}", file) for entry, files in present for file in files]
    for place, file in (*below, *(("base", file) for file in given)):
        path = folder / place / file.name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(file.data)
