"""Write into docs/rubric.md what the checks of our exercises measure, as they say it."""

from __future__ import annotations

import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from grader.exercise.loading import load_exercise  # noqa: E402
from grader.exercise.rubric import rubric  # noqa: E402

PAGE = ROOT / "docs" / "rubric.md"
EXERCISES = (
    *("turtlesim_challenge", "square", "state_publisher"),
    *("description_package", "thymio_package"),
)
#: What stands between these two lines is written here.
FIRST, LAST = "<!-- from the checks: python scripts/rubric.py -->", "<!-- so far -->"


def page(old: str) -> str:
    """The page with the rubrics as they are now."""
    before, _, rest = old.partition(FIRST)
    _, _, after = rest.partition(LAST)
    parts = []
    for name in EXERCISES:
        exercise = load_exercise(name)
        parts.append(f"## {exercise.title}\n\n`{name}`\n\n{rubric(exercise)}")
    return f"{before}{FIRST}\n\n{chr(10).join(parts)}\n{LAST}{after}"


if __name__ == "__main__":
    PAGE.write_text(page(PAGE.read_text(encoding="utf-8")), encoding="utf-8")
