"""Where a result comes from, in a few sentences: for the foot of a page."""

from __future__ import annotations

from grader import text
from grader.language.telling import tell
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
            tell(
                "Run {when} with grader {grader}, Python {python}, rclpy {rclpy}{ros}",
                when=_when(recorded.date),
                grader=recorded.grader,
                python=recorded.python,
                rclpy=recorded.rclpy,
                ros=ros,
            )
        )
    found.append(
        tell("Judged {when} by grader {grader}", when=_when(judged.date), grader=judged.grader)
    )
    if recorded is not None:
        sha256 = _short(recorded.submission_sha256)
        found.append(tell("SHA-256 of the submission {sha256}", sha256=sha256))
    sha256 = _short(judged.exercise_sha256)
    found.append(tell("SHA-256 of the exercise {sha256}", sha256=sha256))
    if recorded is not None and recorded.seed is not None:
        found.append(tell("Seed {seed}", seed=str(recorded.seed)))
    return [text.one_line(sentence) for sentence in found]


def _when(date: str) -> str:
    """'2026-11-21T23:52:52Z' for people."""
    day, _, time = date.partition("T")
    year, _, rest = day.partition("-")
    month, _, of_month = rest.partition("-")
    return tell(
        "{year}-{month}-{day} at {time} UTC",
        **{"year": year, "month": month, "day": of_month, "time": time[:5]},
    )


def _short(sha256: str) -> str:
    return f"{sha256[:_DIGITS]}…" if sha256 else tell("unknown")
