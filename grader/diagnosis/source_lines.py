"""Finds the line to change by what the source shows, where the run shows only its effect."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator

from grader.diagnosis.case import Case
from grader.recording.observations import LintFinding, LintKind, SourceLine


def of_kind(case: Case, *kinds: LintKind) -> Iterator[LintFinding]:
    """Yield the lint findings of these kinds."""
    return (finding for finding in case.observed.lint_findings if finding.kind in kinds)


def first_of(case: Case, kind: LintKind) -> SourceLine | None:
    """Return the place of the first finding of a kind."""
    return next((finding.place for finding in of_kind(case, kind)), None)


def named_at(case: Case, name: str, place: SourceLine | None) -> SourceLine | None:
    """Return the line of a name, where that is a constant apart from its use."""
    if place is None or name.lstrip("/") in place.text:
        return place
    for finding in of_kind(case, "constant"):
        if finding.name.lstrip("/") == name.lstrip("/"):
            return finding.place
    return place


def number(text: str) -> float:
    """Parse a number of a source; not a number where it is none."""
    try:
        return float(text)
    except ValueError:
        return math.nan


def imported_at(case: Case, end_type: str, wanted: str) -> SourceLine | None:
    """Return the import of a class that has the right name and is another package's."""
    package, _, rest = end_type.partition("/")
    name = rest.rpartition("/")[2]
    for finding in of_kind(case, "imports"):
        if finding.name == name == wanted.rpartition("/")[2] and finding.near.startswith(package):
            return finding.place
    return None


def given_at(case: Case, field: str, fits: Callable[[str], bool]) -> SourceLine | None:
    """Return the line that gives a field of a message a number that does not fit."""
    wrong = (each for each in of_kind(case, "argument") if not fits(each.near))
    names = (field, f"linear.{field}", f"angular.{field}", "colour")
    return next((each.place for each in wrong if each.name in names), None)


def set_at(case: Case, text: str) -> SourceLine | None:
    """Return where the field of a message is set that a finding names first."""
    if value := re.search(r"\b(linear\.x|angular\.z) is (-?[\d.]+)", text):
        for finding in of_kind(case, "argument"):
            if finding.name == value[1] and number(finding.near) == number(value[2].rstrip(".")):
                return finding.place
    if "limits does your node compare" in text or "look at its conditions" in text:
        middles = [*of_kind(case, "at_middle")]
        off = [each for each in middles if not 5.4 < number(each.near) < 5.65]
        zero = [each for each in of_kind(case, "at_wall") if number(each.near) == 0]
        for finding in (*off, *zero, *middles):
            return finding.place
    if "wall watched" in text or "zeros to stop" in text or "condition ever true" in text:
        for finding in of_kind(case, "at_wall"):
            return finding.place
    found = [
        (at, finding.place)
        for finding in of_kind(case, "sets")
        if (at := text.find(finding.name)) >= 0
        and ("." in finding.name or f"`{finding.name}`" in text)
    ]
    return min(found, key=lambda each: each[0])[1] if found else None
