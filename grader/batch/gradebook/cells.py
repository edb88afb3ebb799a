"""Cells of CSV: what is for people is made harmless, what a system looks up stays what it is."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Iterable, Sequence

from grader.reports.csv import cell

__all__ = ["cell", "is_safe_id", "table"]

#: What a spreadsheet may make of a cell when it begins like this: a formula. Without brackets,
#: quotes, `!` and `|` it can call and fetch nothing: +41791234567, @anna, -7.
_BEGINS_FORMULA = re.compile(r"[=+@\-\uff1d\uff0b\uff0d\uff20]")
_HARMLESS = re.compile(r"[+@-]?[\w.@+-]*")
_HAS_CONTROLS = re.compile(r"[\x00-\x1f\x7f-\x9f\u2028\u2029\ud800-\udfff]")


def is_safe_id(value: str) -> bool:
    """Whether an id may stand in a cell as it is.

    A system finds people by it, so that it cannot be mended as a name can.
    """
    if _HAS_CONTROLS.search(value):
        return False
    return not _BEGINS_FORMULA.match(value) or _HARMLESS.fullmatch(value) is not None


def table(rows: Iterable[Sequence[str]]) -> str:
    r"""The text of a file: commas, quotes where they are needed, `\n` after each row."""
    out = io.StringIO()
    csv.writer(out, lineterminator="\n").writerows(rows)
    return out.getvalue()
