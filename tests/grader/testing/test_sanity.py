"""What authors get wrong in a check is noticed, and what is right is let be."""

from __future__ import annotations

import pytest

from grader.exercise import asking
from grader.exercise.loading import load_exercise
from grader.exercise.places import names
from grader.limited import Limits
from grader.recording.recording import Recordings
from grader.testing import drive
from grader.testing.oddities import odd_recordings
from grader.testing.sanity import examine
from tests.grader.testing import exercises

ONE = """from grader import Checks, Evidence, Finding

checks = Checks()
seen = []


@checks()
def only(recordings, tolerances):
    seen.append(1)
    return {result}
"""


def faults(tmp_path, result):
    checks = ONE.format(result=result)
    exercise = load_exercise(exercises.write(tmp_path, checks, points={"only": 1}))
    verdicts, found = examine(exercise, Recordings(drive(lambda *_: None, ticks=5)))
    assert len(verdicts) == 1
    return [fault.text for fault in found]


@pytest.mark.parametrize(
    "result",
    [
        "Finding(1, 'seen')",
        "Finding(0.5, 'seen', 'look')",
        "Finding(1, 'seen', evidence=(Evidence(5, 0.08, 5.5, 5.5, 'here'),))",
    ],
)
def test_a_finding_that_is_in_order_has_no_fault(tmp_path, result):
    assert faults(tmp_path, result) == []


@pytest.mark.parametrize(
    ("result", "words"),
    [
        ("1 / 0", "raises checks.py, line 10: ZeroDivisionError"),
        ("exit(0)", "raises checks.py, line 10: SystemExit: 0"),
        ("None", "returns a NoneType; expected a Finding"),
        ("Finding(2, 'seen')", "share: expected a number from 0 to 1, found 2"),
        ("Finding(float('nan'), 'seen')", "share: expected"),
        ("Finding('all', 'seen')", "share: expected"),
        ("Finding(1, ' ')", "empty rationale"),
        ("Finding(0, 'seen')", "fails without help"),
        ("Finding(len(seen) % 2, 'seen', 'look')", "something else when it is asked again"),
        ("Finding(1, f'{len(seen)} times')", "something else when it is asked again"),
        ("Finding(1, 'seen', '', [])", "evidence: expected a tuple, found a list"),
        ("Finding(1, 'seen', '', (5,))", "evidence: expected Evidence, found a int"),
        ("Finding(1, 's', '', (Evidence(6, 0.096, 1, 1, 'n'),))", "tick 6 is outside"),
        ("Finding(1, 's', '', (Evidence(5, 0.5, 1, 1, 'n'),))", "time_s is not that of the tick"),
        ("Finding(1, 's', '', (Evidence(5, 0.08, 1, 12, 'n'),))", "outside the picture"),
        ("Finding(1, 's', '', (Evidence(5, 0.08, 1, float('nan'), 'n'),))", "a finite number"),
        ("Finding(1, 's', '', (Evidence(5, 0.08, 1, 1, 'n', 1),))", "there is no run 1"),
        ("Finding(1, 's', '', (Evidence(5, 0.08, 1, 1, ''),))", "empty note"),
    ],
)
def test_a_mistake_is_named(tmp_path, result, words):
    found = faults(tmp_path, result)
    assert len(found) == 1
    assert words in found[0]


def test_a_check_without_an_end_is_named_and_no_other_is_blamed(tmp_path, monkeypatch):
    monkeypatch.setattr(asking, "LIMITS", Limits(cpu_s=0.3, wall_s=30.0))
    endless = "\n\n@checks()\ndef endless(recordings, tolerances):\n    while True:\n        pass\n"
    checks = ONE.format(result="Finding(1, 'seen')") + endless
    points = {"only": 1, "endless": 1}
    exercise = load_exercise(exercises.write(tmp_path, checks, points=points))
    _, found = examine(exercise, Recordings(drive(lambda *_: None, ticks=5)))
    assert [fault.check for fault in found] == ["endless"]


@pytest.mark.parametrize("name", names())
def test_our_checks_survive_whatever_a_node_does(name):
    exercise = load_exercise(name)
    recordings = odd_recordings(exercise)
    assert len(recordings) > 10
    faults = {what: examine(exercise, recordings[what])[1] for what in recordings}
    assert {what: found for what, found in faults.items() if found} == {}
