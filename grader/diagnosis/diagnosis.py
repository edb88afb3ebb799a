"""What a diagnosis is: one cause, for the first line of a report."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any, Self

from grader.recording.conduct import Place

#: The key of a diagnosis that repeats the finding of a check.
CHECK = "check"


@dataclass(frozen=True)
class Diagnosis:
    """Why points were lost: the earliest cause that is sure.

    Attributes:
        key: the rule that found it, as 'crashed'; `CHECK` where a check did.
        cause: what was found and what was expected, in one line.
        help: what to do.
        run: in which run: 0 nominal, 1, 2, ... varied.
        time_s: when in it [s]; None where that is not known or says nothing.
        place: in the submission's own files; None where that is not known.
        check: the check that found it; '' for what a run shows by itself.
    """

    key: str
    cause: str
    help: str
    run: int = 0
    time_s: float | None = None
    place: Place | None = None
    check: str = ""

    def to_json(self) -> dict[str, Any]:
        """The diagnosis as the result file holds it: what is not known is left out."""
        left_out = {name for name in ("time_s", "place", "check") if not getattr(self, name)}
        if self.time_s is not None:
            left_out.discard("time_s")
        return {name: value for name, value in asdict(self).items() if name not in left_out}

    @classmethod
    def from_json(cls, data: Mapping[str, Any]) -> Self:
        """The diagnosis that a result file holds; it follows the schema."""
        place = data.get("place")
        made = Place(**{**place, "line": int(place["line"])}) if place is not None else None
        return cls(**{**data, "run": int(data["run"]), "place": made})
