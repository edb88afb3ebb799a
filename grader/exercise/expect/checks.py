"""Makes a check of each entry of `expect:`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Final

from grader.cast import script
from grader.exercise.cases import USUAL, RunCase
from grader.exercise.check import Checks
from grader.exercise.expect import judging
from grader.exercise.expect.expectations import Expectation, parse
from grader.exercise.verdict import Finding
from grader.message import msg
from grader.recording.recording import Recordings
from grader.yaml_file import Mistake, expect

#: What a peer does under an id: the key of an expectation -> the part of the peer.
_IDS: Final = {"call": "calls", "goal": "goals", "parameter": "parameters"}


def add_checks(
    checks: Checks, data: Any, cases: Sequence[RunCase], keys: tuple[str, ...] = ("expect",)
) -> set[str]:
    """Add a check for each entry; return the topics that they judge.

    Args:
        cases: those of the exercise, with their peers.

    Raises:
        Mistake: something in it is wrong; its keys name the place.
    """
    what = "expected names of checks, each with what is expected; found {found}"
    expect(isinstance(data, dict) and bool(data), keys, what, data)
    topics: set[str] = set()
    known = [each.name or USUAL for each in cases]
    casts = [script.parse(each.cast or {}).values() for each in cases]
    for name, values in data.items():
        at = (*keys, str(name))
        is_name = isinstance(name, str) and name.isidentifier()
        expect(is_name, at, "expected a name such as talks, found {found}", name)
        expectation = parse(values, at)
        unknown = sorted({*expectation.cases} - {*known})
        what = "expected some of {known}, found {found}"
        expect(not unknown, (*at, "cases"), what, unknown, known=", ".join(known))
        for key, part in _IDS.items():
            if (wanted := getattr(expectation, key, None)) is None:
                continue
            ids = [[each for peer in peers for each in getattr(peer, part)] for peers in casts]
            if max(each.count(wanted) for each in ids) != 1:
                what = "expected one that a peer has among its {part}, {ids}; found {found}"
                listed = ", ".join(dict.fromkeys(each for case in ids for each in case)) or "none"
                raise Mistake((*at, key), what, part=part, ids=listed, found=repr(wanted))
        check = _check(str(name), expectation)
        try:
            checks(after=expectation.after)(check)
        except ValueError as error:
            raise Mistake(at, msg("{what}", what=str(error))) from None
        topics.update(expectation.topics)
    return topics


def _check(name: str, expectation: Expectation) -> Any:
    """Return the function of a check."""

    def check(recordings: Recordings, tolerances: Mapping[str, Any]) -> Finding:
        return judging.judge(expectation, recordings)

    check.__name__ = name
    title = expectation.title or name.replace("_", " ").capitalize()
    check.__doc__ = f"{title}\n\n{expectation.rubric}"
    return check
