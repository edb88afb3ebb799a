"""gradebook.jsonl: one line of JSON a person, for programs."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

from grader.batch.gradebook.grade import Grade
from grader.text import plain_all


def render(grades: Sequence[Grade]) -> str:
    """The same as gradebook.csv; nothing is put before what a spreadsheet would compute."""
    return "".join(f"{json.dumps(_line(g), ensure_ascii=False, allow_nan=False)}\n" for g in grades)


def _line(grade: Grade) -> Any:
    entry, hand_in = grade.entry, grade.entry.hand_in
    verdicts = () if entry.result is None else entry.result.verdicts
    line = {
        "id": grade.person.id,
        "name": grade.person.name,
        "hand_in": hand_in.id,
        "group": list(grade.group),
        "attempt": hand_in.attempt,
        "handed_in": None if hand_in.at is None else hand_in.at.isoformat(),
        "state": entry.state,
        "score": grade.score,
        "late_deduction": grade.late_deduction,
        "final": grade.final,
        "max_score": entry.max_score,
        "checks": {verdict.check: verdict.score for verdict in verdicts},
        "message": entry.message,
    }
    return plain_all(line)
