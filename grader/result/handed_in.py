"""Whose a result is and when it was handed in, as far as that is known."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime
from typing import Annotated, Self

from grader.exercise.late import Late, LatePolicy


def _with_zone(time: str) -> str:
    try:
        is_one = datetime.fromisoformat(time).utcoffset() is not None
    except ValueError:
        is_one = False
    if not is_one:
        raise ValueError(f"expected a time with its zone, found {time!r:.60}")
    return time


@dataclass(frozen=True)
class HandedIn:
    """A hand-in, and what its time costs.

    Attributes:
        id, name: of the student, or the group.
        attempt: counts from 1.
        at: when, in ISO 8601 with its zone; None where nobody knows.
        late_s, days, deducted: see `grader.exercise.late.Late`; `deducted` are its points.
    """

    id: str
    name: str = ""
    attempt: int = 1
    at: Annotated[str, _with_zone] | None = None
    late_s: float = 0.0
    days: int = 0
    deducted: float = 0.0

    @classmethod
    def of(
        cls, id: str, name: str, attempt: int, at: datetime | None, policy: LatePolicy | None
    ) -> Self:
        """Of a hand-in, by what an exercise says of late ones.

        Raises:
            ValueError: the time has no zone.
        """
        late = Late() if at is None or policy is None else policy.deduction(at)
        when = None if at is None else at.isoformat()
        return cls(id, name, attempt, when, late.late_s, late.days, late.points)

    def by(self, policy: LatePolicy | None) -> Self:
        """The same hand-in by what another exercise, or another state of it, says."""
        at = None if self.at is None else datetime.fromisoformat(self.at)
        return type(self).of(self.id, self.name, self.attempt, at, policy)
