"""The sources of a class as JPlag and Dolos read them, which compare sources.

    export/jplag/students/ID/...py    a folder for each hand-in
    export/jplag/base/...py           what everybody was given
    export/dolos.zip                  students/ID.py, starter.py, info.csv

    java -jar jplag.jar -l python3 export/jplag/students -bc export/jplag/base
    dolos run -l python export/dolos.zip

JPlag takes the folders below the one that it is given for submissions, and leaves out what matches
the base code (its wiki, How to Use JPlag). Dolos compares file with file, so that each hand-in is
one; its info.csv has a row a file, and the one whose `ignored` is true is its template (its docs,
Adding metadata; dataset.ts).
"""

from __future__ import annotations

import csv
import io
import shutil
import zipfile
from collections.abc import Sequence
from pathlib import Path
from typing import Final

from grader import files as whole_files
from grader.batch.entry import Entry
from grader.batch.similar import known
from grader.batch.similar.sources import SOURCE, File, kept
from grader.exercise.exercise import Exercise

FOLDER: Final = "export"
JPLAG, DOLOS = "jplag", "dolos.zip"
_GIVEN: Final = "starter.py"
_EARLIEST: Final = (1980, 1, 1, 0, 0, 0)  # that a zip knows; so the same class gives the same bytes


def write(entries: Sequence[Entry], exercise: Exercise, out: Path) -> None:
    """Make both exports anew in the folder of a class. No names are in them, but ids.

    Raises:
        UsageError: they cannot be written, or sources not read.
        ExerciseError: the exercise's solutions cannot be used.
    """
    with whole_files.writing(out / FOLDER):
        given = known.files(exercise)
        sources = [(entry, kept(entry.folder / SOURCE)) for entry in entries]
        present = [(entry, files) for entry, files in sources if files]
        _write_jplag(present, given, out / FOLDER / JPLAG)
        whole_files.put(out / FOLDER / DOLOS, dolos(present, given))


def dolos(present: Sequence[tuple[Entry, list[File]]], given: Sequence[File]) -> bytes:
    """The zip for Dolos."""
    members = {f"students/{entry.id}.py": _joined(files) for entry, files in present}
    rows = [_row(entry) for entry, _ in present]
    if given:
        members[_GIVEN] = _joined(given)
        rows.append([_GIVEN, "given", "", "true"])
    has_times = all(row[2] for row in rows[: len(present)])
    table = io.StringIO()
    writer = csv.writer(table, lineterminator="\n")
    for row in (["filename", "full_name", "created_at", "ignored"], *rows):
        # an empty time is an error to Dolos, a missing column is not
        writer.writerow(row if has_times else [*row[:2], row[3]])
    members["info.csv"] = table.getvalue().encode("utf-8")
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        for name in sorted(members):
            member = zipfile.ZipInfo(name, _EARLIEST)
            member.external_attr = 0o644 << 16
            archive.writestr(member, members[name], zipfile.ZIP_DEFLATED)
    return packed.getvalue()


def _row(entry: Entry) -> list[str]:
    # In front of what a spreadsheet would take for a formula.
    shown = f"'{entry.id}" if entry.id.startswith(("=", "+", "-", "@")) else entry.id
    at = entry.hand_in.at
    return [f"students/{entry.id}.py", shown, "" if at is None else at.isoformat(" "), ""]


def _joined(files: Sequence[File]) -> bytes:
    """Files as one, each below its name."""
    if len(files) == 1:
        return files[0].data
    parts = (f"# {file.name}\n".encode() + file.data.rstrip(b"\n") + b"\n" for file in files)
    return b"\n".join(parts)


def _write_jplag(
    present: Sequence[tuple[Entry, list[File]]], given: Sequence[File], folder: Path
) -> None:
    if folder.is_symlink():
        folder.unlink()  # none of ours
    elif folder.exists():
        shutil.rmtree(folder)
    below = [(f"students/{entry.id}", file) for entry, files in present for file in files]
    for place, file in (*below, *(("base", file) for file in given)):
        path = folder / place / file.name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(file.data)
