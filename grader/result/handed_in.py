"""Whose a result is and when it was handed in, as far as that is known."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from datetime import datetime
from typing import Any, Self

from grader.exercise.late import Late, LatePolicy


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
    at: str | None = None
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

    def to_json(self) -> dict[str, Any]:
        """As the result file holds it."""
        return asdict(self)

    @classmethod
    def from_json(cls, data: Mapping[str, Any]) -> Self:
        """What a result file holds; it follows the schema.

        Raises:
            ValueError: its time is none, or has no zone.
        """
        at = data["at"]
        if at is not None and not _is_a_time(at):
            raise ValueError(f"is damaged: its handed_in.at is no time with a zone: {at:.60}")
        whole = {key: int(data[key]) for key in ("attempt", "days")}
        return cls(**{**data, **whole})


def _is_a_time(text: str) -> bool:
    try:
        return datetime.fromisoformat(text).utcoffset() is not None
    except ValueError:
        return False
