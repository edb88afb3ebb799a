"""Programs with a beginner's mistake, and what the first line of the report says of each.

They stand in first_lines.yaml and, those for the tutorials' exercises, in tutorials.yaml; most of
them as one right program with some passages replaced.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import yaml

FOLDER = Path(__file__).parent / "first_lines"


def _read(file: str) -> dict[str, dict[str, Any]]:
    rows: dict[str, dict[str, Any]] = yaml.safe_load((FOLDER / file).read_text(encoding="utf-8"))
    return rows


#: Name -> as MISTAKES, with its `exercise`.
TUTORIALS = _read("tutorials.yaml")
ROWS = _read("first_lines.yaml") | TUTORIALS
#: Name -> the rule that finds the cause (`key`), and what the first line `says`.
MISTAKES = {name: row for name, row in ROWS.items() if "key" in row and name not in TUTORIALS}
#: Those that the base is changed for.
CHANGED = tuple(name for name in MISTAKES if "replace" in ROWS[name])


def source(name: str) -> bytes | None:
    """The source of one that is no file of its own; None for others."""
    row = ROWS[name]
    if "source" in row:
        return str(row["source"]).encode(row.get("encoding", "utf-8"))
    return changed(name).encode() if "replace" in row else None


def changed(name: str) -> str:
    """The source of one that is made of another."""
    row = ROWS[name]
    of = row.get("of", "first_lines/base")
    file = FOLDER.parent / f"{of}.py"
    base = changed(of) if of in ROWS else file.read_text(encoding="utf-8")
    rest = base.partition("\n")[2]
    text = f'"""{row["what"]}"""\n{rest}'
    for old, new in row["replace"]:
        if text.count(old) != 1:
            raise ValueError(f"{name}: {old!r} does not stand there exactly once")
        text = text.replace(old, new)
    return text
