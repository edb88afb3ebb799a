"""The reference controller with one thing spoiled at a time, and what each mutant must lose.

They stand in the exercise's mutants.yaml, for `grader check-exercise`. Here `lost` names the checks
that lose points, each with the points that remain: a number, or "some" for partial credit. Every
other check must give full points.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import turtlesim_challenge
from grader.exercise.loading import load_exercise
from grader.testing.solutions import Solution, read_solutions

REFERENCE = Path(turtlesim_challenge.__file__).with_name("turtle_controller.py")
EXERCISE = load_exercise("turtlesim_challenge")


@dataclass(frozen=True)
class Mutant:
    """Replacements in the reference's text, and the points that remain where some are lost."""

    solution: Solution
    lost: dict[str, float | str]

    def text(self) -> str:
        """The mutant's source."""
        return self.solution.text()


MUTANTS = {
    mutant.name: Mutant(
        mutant,
        {
            check: left if left == "some" else EXERCISE.points[check] * left
            for check, left in (mutant.leaves or {}).items()
        },
    )
    for mutant in read_solutions(EXERCISE)
    if not mutant.is_right
}
