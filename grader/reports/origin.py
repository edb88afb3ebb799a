"""Where a result comes from, in a few sentences: for the foot of a page."""

from __future__ import annotations

from grader import text
from grader.result.provenance import Origin

#: So many digits of a hash tell one from another; the result file has all.
_DIGITS = 12


def sentences(origin: Origin) -> list[str]:
    """When and with what it was run and judged, and of what."""
    judged, recorded = origin.judged, origin.recorded
    found = []
    if recorded is not None:
        ros = f", ROS 2 {recorded.ros_distro}" if recorded.ros_distro else ""
        found.append(
            f"Run {_when(recorded.date)} with grader {recorded.grader}, Python {recorded.python}, "
            f"rclpy {recorded.rclpy}{ros}"
        )
    found.append(f"Judged {_when(judged.date)} by grader {judged.grader}")
    if recorded is not None:
        found.append(f"SHA-256 of the submission {_short(recorded.submission_sha256)}")
    found.append(f"SHA-256 of the exercise {_short(judged.exercise_sha256)}")
    if recorded is not None and recorded.seed is not None:
        found.append(f"Seed {recorded.seed}")
    return [text.one_line(sentence) for sentence in found]


def _when(date: str) -> str:
    """'2026-11-21T23:52:52Z' for people."""
    day, _, time = date.partition("T")
    return f"{day} at {time[:5]} UTC"


def _short(sha256: str) -> str:
    return f"{sha256[:_DIGITS]}…" if sha256 else "unknown"
