"""Write into docs/rubric.md what the checks of our exercises measure: their rubrics."""

from __future__ import annotations

import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from grader.exercise.loading import load_exercise  # noqa: E402
from grader.exercise.sheet import check_rubric  # noqa: E402
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
        checks = {check.name: check for check in exercise.checks}
        above, own, first = [], [], {}
        for check, worth in exercise.points.items():
            text = check_rubric(checks[check], exercise.tolerances)
            if text in first_in:
                above.append(f"- `{check}`: {points(worth)} points, as in `{first_in[text]}`")
                continue
            waits = ", ".join(f"`{n}`" for n in checks[check].depends_on if n in exercise.points)
            condition = f" · judged when passed: {waits}" if waits else ""
            own.append(f"### {checks[check].title!s}: {worth:g} points\n\n`{check}`{condition}")
            if text:
                own.append(text)
                first[text] = name
        first_in |= first
        parts.append(f"## {exercise.title!s}\n\n`{name}`\n")
        if above:
            parts.append("\n".join(above) + "\n")
        parts.append("\n\n".join(own) + "\n")
    return f"{before}{FIRST}\n\n{chr(10).join(parts)}\n{LAST}{after}"


if __name__ == "__main__":
    PAGE.write_text(page(PAGE.read_text(encoding="utf-8")), encoding="utf-8")
