"""What a diagnosis is: one cause, for the first line of a report."""

from __future__ import annotations

from dataclasses import dataclass, field

from grader.recording.conduct import Place
from grader.strict_json import SPARSE

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
    time_s: float | None = field(default=None, metadata=SPARSE)
    place: Place | None = field(default=None, metadata=SPARSE)
    check: str = field(default="", metadata=SPARSE)
