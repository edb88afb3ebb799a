"""Where a result comes from: how its runs were made, and by what they were judged."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Self

from grader import versions
from grader.exercise.exercise import Exercise
from grader.recording.provenance import Provenance, now
from grader.recording.recording import Recordings
from grader.strict_json import SPARSE


@dataclass(frozen=True)
class Judged:
    """When and by what the recordings were judged; the same day as the runs, or later.

    Attributes:
        date: as `grader.recording.provenance.now` writes it.
        grader: its version.
        exercise_sha256: see `grader.exercise.exercise.Exercise`.
    """

    date: str
    grader: str
    exercise_sha256: str


@dataclass(frozen=True)
class Origin:
    """Both of it.

    Attributes:
        recorded: None where the recordings do not tell.
    """

    judged: Judged
    recorded: Provenance | None = field(default=None, metadata=SPARSE)

    @classmethod
    def of(cls, recordings: Recordings, exercise: Exercise) -> Self:
        """Of recordings that are being judged."""
        judged = Judged(now(), versions.grader(), exercise.sha256)
        return cls(judged, recordings.nominal.provenance)
