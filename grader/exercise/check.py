"""The decorator that makes a function a check, and the loop that runs an exercise's checks.

A check is a function of a submission's recordings and the exercise's tolerances; the first line of
its docstring is the title that a student reads. Checks run in the order of their definition. One
that depends on a failed check is not judged, and says for which it waited.
"""

from __future__ import annotations

import inspect
import math
import traceback
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from numbers import Real
from pathlib import Path
from typing import Any

from grader.errors import CheckFailed
from grader.exercise.foreign import contained
from grader.exercise.verdict import Evidence, Finding, Verdict
from grader.recording.recording import NominalAlone, NotOver, Recordings

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

    def __call__(
        self, *wrong: object, after: tuple[str, ...] = ()
    ) -> Callable[[CheckFunction], CheckFunction]:
        """Register the decorated function; `after` names the checks it depends on.

        Raises:
            ValueError: one of them is not defined above it, or the function's own name is taken.
            TypeError: it is no function of recordings and tolerances, or `after` is no tuple.
        """
        if wrong:
            raise TypeError("write @checks(), with brackets")
        if not isinstance(after, tuple | list) or not all(isinstance(n, str) for n in after):
            raise TypeError(f"after: expected a tuple of names, found {after!r}")
        unknown = set(after) - {check.name for check in self._checks}
        if unknown:
            raise ValueError(f"after: no check above is named {', '.join(sorted(unknown))}")

        def register(function: CheckFunction) -> CheckFunction:
            title = (function.__doc__ or function.__name__).strip().splitlines()[0]
            name = function.__name__
            if name in {check.name for check in self._checks}:
                raise ValueError(f"two checks are named {name!r}")
            if not _takes_two(function):
                found = inspect.signature(function)
                raise TypeError(f"{name}: expected (recordings, tolerances), found {found}")
            self._checks.append(Check(name, title.rstrip("."), function, tuple(after)))
            return function

        return register


def _takes_two(function: CheckFunction) -> bool:
    try:
        inspect.signature(function).bind(None, None)
    except TypeError:
        return False
    return True


def judge(
    recordings: Recordings,
    checks: Checks,
    points: Mapping[str, float],
    tolerances: Tolerances,
) -> list[Verdict]:
    """Run every check that the exercise gives points for.

    Raises:
        CheckFailed: a check raised something, or returned what is no finding.
        KeyError: the exercise gives points to a check that does not exist.
    """
    known = {check.name: check for check in checks}
    verdicts: dict[str, Verdict] = {}
    for name in points:
        if name not in known:
            raise KeyError(f"no check is named {name!r}; there are {', '.join(known)}")
    for check in known.values():
        if check.name in points:
            verdicts[check.name] = judge_one(
                check, float(points[check.name]), recordings, tolerances, verdicts
            )
    return [verdicts[name] for name in points]


def judge_one(
    check: Check,
    max_score: float,
    recordings: Recordings,
    tolerances: Tolerances,
    earlier: Mapping[str, Verdict],
) -> Verdict:
    """Run one check, if the `earlier` verdicts of those that it depends on allow it.

    Raises:
        CheckFailed: it raised something, or returned what is no finding.
        NotOver: it asked for a run that is not over.
    """
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
        with contained():
            finding = check.function(recordings, tolerances)
    except (KeyboardInterrupt, NotOver):
        raise
    except BaseException as error:  # SystemExit too: a check must not end us unjudged
        raise CheckFailed(_told(check, error)) from error
    is_alone = isinstance(recordings, NominalAlone)
    wrong = wrong_with(finding, 1 if is_alone else len(list(recordings)))
    if wrong:
        raise CheckFailed(
            f"the check {check.name!r} returned what it should not, so nothing was judged: "
            f"{Path(check.function.__code__.co_filename).name}: {wrong}"
        )
    share = min(max(float(finding.share), 0.0), 1.0)
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


def wrong_with(finding: object, runs: int) -> str:
    """Why something that a check returned is no finding about so many runs; '' if it is one."""
    if not isinstance(finding, Finding):
        return f"returns a {type(finding).__name__}; expected a Finding"
    share: object = finding.share
    if not _is_number(share) or not -1e-9 <= float(share) <= 1 + 1e-9:  # type: ignore[arg-type]
        return f"share: expected a number from 0 to 1, found {share!r}"
    for name in ("rationale", "help"):
        text = getattr(finding, name)
        if not isinstance(text, str):
            return f"{name}: expected a text, found {text!r}"
    evidence: object = finding.evidence
    if not isinstance(evidence, tuple):
        return f"evidence: expected a tuple, found a {type(evidence).__name__}"
    return next(filter(None, (_wrong_with_evidence(item, runs) for item in evidence)), "")


def _wrong_with_evidence(item: object, runs: int) -> str:
    if not isinstance(item, Evidence):
        return f"evidence: expected Evidence, found a {type(item).__name__}"
    for name in ("tick", "run"):
        value = getattr(item, name)
        if type(value) is not int or value < 0:
            return f"evidence: {name}: expected a whole number from 0, found {value!r}"
    for name in ("time_s", "x", "y"):  # JSON has no other numbers than finite ones
        value = getattr(item, name)
        is_number = isinstance(value, int | float) and not isinstance(value, bool)
        if not is_number or not math.isfinite(value) or (name == "time_s" and value < 0):
            return f"evidence: {name}: expected a finite number, found {value!r}"
    if not isinstance(item.note, str):
        return f"evidence: note: expected a text, found {item.note!r}"
    if item.run >= runs:
        return f"evidence: there is no run {item.run}; there are {runs}, from 0 on"
    return ""


def _is_number(value: object) -> bool:
    return isinstance(value, Real) and not isinstance(value, bool)


def _told(check: Check, error: BaseException) -> str:
    """An exception in a check, with the last line of the file that the check stands in."""
    file = check.function.__code__.co_filename
    frames = traceback.extract_tb(error.__traceback__)
    lines = [frame.lineno for frame in frames if frame.filename == file]
    where = f"{Path(file).name}, line {lines[-1]}: " if lines else ""
    text = f"{where}{type(error).__name__}: {error}".rstrip(": ")
    return f"the check {check.name!r} failed itself, so nothing was judged: {text}"
