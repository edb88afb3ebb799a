"""The result of trying an exercise: which mutants each check catches, and what to fix."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

from grader.exercise.verdict import Verdict
from grader.testing.solutions import Solution
from grader.text.message import Message, joined, msg
from grader.text.strings import listed

SCHEMA = "turtlesim-grader/examination/v1"


class Fault(NamedTuple):
    """Something to fix; `check` is "" where it concerns no single check."""

    check: str
    text: Message


@dataclass(frozen=True)
class Trial:
    """A solution with its verdicts.

    Attributes:
        remarks: on the run, for the author of the exercise.
    """

    solution: Solution
    verdicts: tuple[Verdict, ...]
    remarks: tuple[Message, ...] = ()

    @property
    def caught_by(self) -> tuple[str, ...]:
        """The checks that failed; those that were not judged because of them do not count."""
        return tuple(v.check for v in self.verdicts if v.status == "failed")


@dataclass(frozen=True)
class Problem:
    """Something to fix, and the solutions that show it."""

    fault: Fault
    on: tuple[str, ...] = ()

    @property
    def text(self) -> Message:
        """The problem in words: 'CHECK: what is wrong (on SOLUTIONS)'."""
        parts: list[str | Message] = [
            f"{self.fault.check}: " if self.fault.check else "",
            self.fault.text,
        ]
        if self.on:
            parts.append(msg(" (on {solutions})", solutions=listed(self.on, 3)))
        return joined(parts)


@dataclass(frozen=True)
class Examination:
    """An exercise that was tried on its solutions.

    Attributes:
        exercise: its name.
        checks: those that are worth points, in the exercise's order.
        trials: the right solutions, then the mutants.
        problems: what to fix; empty where all is fine.
        parrots: of the right solutions: programs that repeat what these sent, and hear nothing.
    """

    exercise: str
    checks: tuple[str, ...]
    trials: tuple[Trial, ...]
    problems: tuple[Problem, ...]
    parrots: tuple[Trial, ...] = ()

    @property
    def is_fine(self) -> bool:
        """Whether there is nothing to fix."""
        return not self.problems

    @property
    def mutants(self) -> tuple[Trial, ...]:
        """The trials of mutants."""
        return tuple(trial for trial in self.trials if not trial.solution.is_right)

    @property
    def catches(self) -> Mapping[str, tuple[str, ...]]:
        """Check -> the mutants that it catches."""
        return {
            check: tuple(t.solution.name for t in self.mutants if check in t.caught_by)
            for check in self.checks
        }

    @property
    def uncaught(self) -> tuple[str, ...]:
        """The mutants that no check catches."""
        return tuple(t.solution.name for t in self.mutants if not t.caught_by)

    def to_json(self) -> dict[str, Any]:
        """Return everything as data for JSON."""
        return {
            "schema": SCHEMA,
            "exercise": self.exercise,
            "fine": self.is_fine,
            "problems": [
                {"check": p.fault.check, "text": str(p.fault.text), "on": list(p.on)}
                for p in self.problems
            ],
            "catches": {check: list(names) for check, names in self.catches.items()},
            "uncaught": list(self.uncaught),
            "parrots": {
                trial.solution.name: {v.check: v.score for v in trial.verdicts if v.score}
                for trial in self.parrots
            },
            "solutions": [
                {
                    "name": trial.solution.name,
                    "right": trial.solution.is_right,
                    "remarks": list(map(str, trial.remarks)),
                    "checks": {
                        v.check: {"status": v.status, "score": v.score, "max_score": v.max_score}
                        for v in trial.verdicts
                    },
                }
                for trial in self.trials
            ],
        }

    def to_markdown(self) -> str:
        """Return a table with a row a solution and a column a check; the same in any language."""
        head = ["", *(f"`{check}`" for check in self.checks), "caught by"]
        rows = [head, ["---", *("---" for _ in self.checks), "---:"]]
        for trial in self.trials:
            cells = [_cell(verdict) for verdict in trial.verdicts]
            number = "right" if trial.solution.is_right else str(len(trial.caught_by))
            rows.append([f"`{trial.solution.name}`", *cells, number])
        caught = [str(len(names)) for names in self.catches.values()]
        count = len(self.mutants)
        rows.append(["catches", *caught, f"{count - len(self.uncaught)} of {count}"])
        return "".join(f"| {' | '.join(row)} |\n" for row in rows)


def _cell(verdict: Verdict) -> str:
    """Return the share of a check's points that is left; '' where it is all of them."""
    if verdict.status == "passed":
        return ""
    if verdict.status == "not_judged":
        return "–"
    share = verdict.score / verdict.max_score if verdict.max_score else 0.0
    return f"**{100 * share:.0f} %**"
