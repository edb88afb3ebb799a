"""Write into docs/rubric.md what the checks of our exercises measure: their rubrics."""

from __future__ import annotations

import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from grader.exercise.exercise import Exercise  # noqa: E402
from grader.exercise.loading import load_exercise  # noqa: E402
from grader.exercise.sheet import check_rubric, rubric  # noqa: E402
from grader.text import points  # noqa: E402

PAGE = ROOT / "docs" / "rubric.md"
EXERCISES = (
    *("turtlesim_challenge", "square", "state_publisher"),
    *("description_package", "thymio_package"),
    *("talker", "listener", "service_server", "service_client", "parameters", "action_server"),
    *("action_client", "tf2_static_broadcaster", "own_interfaces", "qos"),
)
#: The text between these two lines is generated.
FIRST, LAST = "<!-- from the checks: python scripts/rubric.py -->", "<!-- so far -->"


def page(old: str) -> str:
    """The page with the rubrics as they are now; what two exercises share stands there once."""
    before, _, rest = old.partition(FIRST)
    _, _, after = rest.partition(LAST)
    parts = []
    first_in: dict[str, str] = {}  # what a check measures -> the first exercise with it
    for name in EXERCISES:
        exercise = load_exercise(name)
        texts = {check.name: check_rubric(check, exercise.tolerances) for check in exercise.checks}
        above = {
            check: first_in[texts[check]] for check in exercise.points if texts[check] in first_in
        }
        first = (texts[check] for check in exercise.points if check not in above)
        first_in |= {text: name for text in first if text}
        parts.append(f"## {exercise.title!s}\n\n`{name}`\n")
        if above:
            parts.append("\n".join(_as_in(exercise, *each) for each in above.items()) + "\n")
        parts.append(rubric(exercise, above))
    return f"{before}{FIRST}\n\n{chr(10).join(parts)}\n{LAST}{after}"


def _as_in(exercise: Exercise, check: str, other: str) -> str:
    return f"- `{check}`: {points(exercise.points[check])} points, as in `{other}`"


if __name__ == "__main__":
    PAGE.write_text(page(PAGE.read_text(encoding="utf-8")), encoding="utf-8")
