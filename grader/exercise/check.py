"""The decorator that makes a function a check, and the loop that runs an exercise's checks.

A check is a function of a submission's recordings and the exercise's tolerances; the first line of
its docstring is the title that a student reads. Checks run in the order of their definition. One
that depends on a failed check is not judged, and says for which it waited.
"""

from __future__ import annotations

import traceback
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from grader.errors import CheckFailed
from grader.exercise.verdict import Finding, Verdict
from grader.recording.recording import Recordings

Tolerances = Mapping[str, Any]
CheckFunction = Callable[[Recordings, Tolerances], Finding]


@dataclass(frozen=True)
class Check:
    """A named check function and the checks that must have passed before it."""

    name: str
    title: str
    function: CheckFunction
    depends_on: tuple[str, ...]


class Checks:
    """The checks of one exercise, in the order of their definition."""

    def __init__(self) -> None:
        self._checks: list[Check] = []

    def __iter__(self) -> Iterator[Check]:
        return iter(self._checks)

    def wrapped(self, wrap: Callable[[Check], CheckFunction]) -> Checks:
        """The same checks with other functions, e.g. to look at what they return."""
        other = Checks()
        other._checks = [replace(check, function=wrap(check)) for check in self]
        return other

    def __call__(self, *, after: tuple[str, ...] = ()) -> Callable[[CheckFunction], CheckFunction]:
        """Register the decorated function; `after` names the checks it depends on.

        Raises:
            ValueError: one of them is not defined above it.
        """
        unknown = set(after) - {check.name for check in self._checks}
        if unknown:
            raise ValueError(f"after: no check above is named {', '.join(sorted(unknown))}")

        def register(function: CheckFunction) -> CheckFunction:
            title = (function.__doc__ or function.__name__).strip().splitlines()[0]
            name = function.__name__
            self._checks.append(Check(name, title.rstrip("."), function, after))
            return function

        return register


def judge(
    recordings: Recordings,
    checks: Checks,
    points: Mapping[str, float],
    tolerances: Tolerances,
) -> list[Verdict]:
    """Run every check that the exercise gives points for.

    Raises:
        KeyError: the exercise gives points to a check that does not exist.
    """
    known = {check.name: check for check in checks}
    verdicts: dict[str, Verdict] = {}
    for name in points:
        if name not in known:
            raise KeyError(f"no check is named {name!r}; there are {', '.join(known)}")
    for check in known.values():
        if check.name in points:
            verdicts[check.name] = _judge_one(
                check, float(points[check.name]), recordings, tolerances, verdicts
            )
    return [verdicts[name] for name in points]


def _judge_one(
    check: Check,
    max_score: float,
    recordings: Recordings,
    tolerances: Tolerances,
    earlier: Mapping[str, Verdict],
) -> Verdict:
    missing = [n for n in check.depends_on if n in earlier and earlier[n].status != "passed"]
    if missing:
        return Verdict(
            check.name,
            check.title,
            "not_judged",
            0.0,
            max_score,
            f"Not judged, because {' and '.join(repr(name) for name in missing)} did not pass.",
            f"Look at {missing[0]!r} first.",
            (),
            check.depends_on,
        )
    try:
        finding = check.function(recordings, tolerances)
    except Exception as error:
        raise CheckFailed(_told(check, error)) from error
    share = min(max(finding.share, 0.0), 1.0)
    passed = share >= 1.0
    return Verdict(
        check.name,
        check.title,
        "passed" if passed else "failed",
        round(max_score * share, 2),
        max_score,
        finding.rationale,
        "" if passed else finding.help,
        finding.evidence,
        check.depends_on,
    )


def _told(check: Check, error: Exception) -> str:
    """An exception in a check, with the last line of the file that the check stands in."""
    file = check.function.__code__.co_filename
    frames = traceback.extract_tb(error.__traceback__)
    lines = [frame.lineno for frame in frames if frame.filename == file]
    where = f"{Path(file).name}, line {lines[-1]}: " if lines else ""
    text = f"{where}{type(error).__name__}: {error}".rstrip(": ")
    return f"the check {check.name!r} failed itself, so nothing was judged: {text}"
