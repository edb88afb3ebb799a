"""A table of a spreadsheet's or a course system's, as CSV."""

from __future__ import annotations

import codecs
import csv
import io
from collections import Counter
from pathlib import Path
from typing import Final

from grader.errors import UsageError
from grader.language.phrase import say
from grader.submission.folder import shown

MAX_BYTES: Final = 50_000_000
_DELIMITERS: Final = ",;\t|"
_UTF_16: Final = (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)


def read_table(path: Path) -> tuple[list[str], list[list[str]]]:
    """The titles of the columns, and the rows; each as long as the titles are many.

    UTF-8, with or without a mark at its start; UTF-16 with one, as Excel's "Unicode text" has it;
    else Windows' letters of Western Europe. What separates the cells is that of comma, semicolon,
    tab and bar which stands most often in the first line, outside of quotes; `sep=;`, as Excel
    understands it, goes before.

    Raises:
        UsageError: there is no such file, or it is no table.
    """
    name = shown(path.name)
    try:
        with path.open("rb") as file:
            raw = file.read(MAX_BYTES + 1)
    except OSError as error:
        raise UsageError(
            say("cannot read the roster {path}: {why}", path=shown(path), why=str(error.strerror))
        ) from None
    if len(raw) > MAX_BYTES:
        raise UsageError(
            say(
                "{name} has more than {size:g} MB: that is no roster",
                name=name,
                size=MAX_BYTES / 1e6,
            )
        )
    text = _decoded(raw)
    if "\0" in text:
        raise UsageError(
            say("{name} is no CSV file. Save the table as CSV, and name that.", name=name)
        )
    first, _, rest = text.partition("\n")
    if first.strip().lower().startswith("sep="):
        delimiter, text = first.strip()[4:5] or ",", rest
    else:
        delimiter = _delimiter(first)
    try:
        lines = list(csv.reader(io.StringIO(text, newline=""), delimiter=delimiter))
    except csv.Error as error:
        raise UsageError(
            say("{name} is no table in CSV: {error}", name=name, error=str(error))
        ) from None
    filled = [line for line in lines if any(cell.strip() for cell in line)]
    if not filled:
        raise UsageError(
            say("{name} is empty: expected a first line with titles such as id,name", name=name)
        )
    titles = [cell.strip() for cell in filled[0]]
    rows = [[cell.strip() for cell in line[: len(titles)]] for line in filled[1:]]
    return titles, [row + [""] * (len(titles) - len(row)) for row in rows]


def _decoded(raw: bytes) -> str:
    if raw.startswith(_UTF_16):
        return raw.decode("utf-16", "replace")
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError:
        return raw.decode("cp1252", "replace")


def _delimiter(line: str) -> str:
    outside = "".join(line.split('"')[::2])
    times = Counter(sign for sign in outside if sign in _DELIMITERS)
    return max(_DELIMITERS, key=lambda sign: times[sign]) if times else ","
