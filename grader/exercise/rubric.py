"""What an exercise's checks measure, with the tolerances in force, in a reader's words.

The text is that of the checks' docstrings, so that it stands beside the code that it tells of.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

from grader.exercise.check import Check
from grader.exercise.exercise import Exercise
from grader.language import telling
from grader.language.phrase import joined, say
from grader.language.telling import tell

_PLACE = re.compile(r"\{(?P<name>\w+)(?P<percent>%?)\}")


def told(check: Check, tolerances: Mapping[str, Any]) -> str:
    """What a check measures and how its points are computed: paragraphs, and lists with '- '.

    It is in the language of this process's user, where the exercise has that.

    Empty where the author has written no more than a title.
    """
    return in_force(telling.told(check.rubric), tolerances)


def in_force(text: str, tolerances: Mapping[str, Any]) -> str:
    """A text with the tolerances that it names in braces, as '{edge_m}'; all else is left."""

    def put_in(found: re.Match[str]) -> str:
        value = tolerances.get(found["name"])
        if isinstance(value, list):
            return ", ".join(map(str, value))
        if isinstance(value, bool) or not isinstance(value, int | float):
            return found[0] if value is None else str(value)
        return f"{100 * value:g} %" if found["percent"] else f"{value:g}"

    return _PLACE.sub(put_in, text)


def rubric(exercise: Exercise) -> str:
    """All checks of an exercise with their points, as Markdown, without a heading above them."""
    known = {check.name: check for check in exercise.checks}
    parts = []
    for name, points in exercise.points.items():
        check = known[name]
        waits = [known[other].title for other in check.depends_on if other in exercise.points]
        heading = tell("{title}: {points} points", title=check.title, points=f"{points:g}")
        parts.append(f"### {heading}\n\n`{name}`")
        if waits:
            first = joined([say("“{title}”", title=title) for title in waits], ", ")
            parts[-1] += " · " + tell("judged when passed: {titles}", titles=first)
        text = told(check, exercise.tolerances)
        if text:
            parts.append(text)
    return "\n\n".join(parts) + "\n"
