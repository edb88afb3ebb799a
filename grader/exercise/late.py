"""What handing in late costs: whole points for each started day, up to a limit."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime, timedelta

_DAY = timedelta(days=1)


@dataclass(frozen=True)
class Late:
    """What the time of a hand-in means.

    Attributes:
        late_s: after it was due [s], grace included; 0 where it came in time.
        days: so many started days of it cost points.
        points: what that costs.
    """

    late_s: float = 0.0
    days: int = 0
    points: float = 0.0


@dataclass(frozen=True)
class LatePolicy:
    """When an exercise is due, and what it costs to hand in later.

    What it costs depends on nothing but the time: not on the score, which could else be told from
    it where a part of it is not shown.

    Attributes:
        due: with its time zone.
        grace_min: so long after it costs nothing [minutes]; the first day begins when that is over.
        per_day: points for each started day of 24 hours.
        most: so many points in all.
    """

    due: datetime
    grace_min: float
    per_day: float
    most: float

    def deduction(self, at: datetime) -> Late:
        """What a hand-in at some time costs.

        Raises:
            ValueError: the time has no zone.
        """
        if at.utcoffset() is None:
            raise ValueError(f"expected a time with its zone, found {at.isoformat()}")
        late = at - self.due
        charged = late - timedelta(minutes=self.grace_min)
        days = max(-(-charged // _DAY), 0)
        points = min(days * self.per_day, self.most)
        return Late(max(late.total_seconds(), 0.0), days, round(points, 2))
