"""Where recordings come from: when, with which versions and of what they were made."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import UTC, datetime


@dataclass(frozen=True)
class Provenance:
    """How the runs of a submission were made; nothing of it decides a verdict.

    Attributes:
        date: when they began, as `now` writes it.
        grader, python, rclpy: versions.
        ros_distro: the ROS 2 release that was sourced; '' where none was.
        submission: what was handed in, by its name.
        submission_sha256: of all its files; see `grader.content`.
        exercise: its name.
        exercise_sha256: of all that it judges by.
        seed: chose where the varied runs start; None where there are none.
        conditions: what of the exercise only a run can follow: "limits.total_s" -> 180.0.
    """

    date: str
    grader: str
    python: str
    rclpy: str
    ros_distro: str = ""
    submission: str = ""
    submission_sha256: str = ""
    exercise: str = ""
    exercise_sha256: str = ""
    seed: int | None = None
    conditions: Mapping[str, float] = field(default_factory=dict)


def now() -> str:
    """This moment, by the machine's clock: '2026-11-21T23:52:52Z'."""
    return datetime.now(UTC).strftime("%Y-%m-%dT%H:%M:%SZ")
