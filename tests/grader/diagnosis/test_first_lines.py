"""Real submissions with a beginner's mistake: the first line of the report names the cause."""

from __future__ import annotations

import pytest

from grader.diagnosis.diagnose import diagnose
from grader.exercise.verdict import Verdict
from grader.message import plain_text
from grader.recording.recording import Recordings
from grader.run.handover import Plan
from grader.run.limits import Patience
from grader.scenes.scene import Limits
from tests import runs
from tests.grader.languages.holes import holes
from tests.submissions.beginners import MISTAKES

PLAN = Plan(Limits(first_motion_s=3, rest_s=1, total_s=10))
#: What loops for ever is not waited for as long as a student's imports would be.
PATIENCE = Patience(stall_cpu_s=0.5, start_cpu_s=1.5)


@pytest.mark.parametrize("name", MISTAKES)
def test_the_first_line_is_the_cause_and_is_said_in_other_languages(name):
    row, lost = MISTAKES[name], []
    if "check" in row:  # what it found
        texts = map(plain_text, row["check"])
        lost = [Verdict("check", plain_text("Check"), "failed", 0, 20, *texts)]
    found = diagnose(Recordings(runs.recorded(name, PLAN, PATIENCE)), lost)
    assert found is not None
    said = f"{found.cause!s} {found.help!s}"
    begin = 0
    for piece in row["says"]:
        assert piece in said[begin:], f"{found.key}: {said}"
        begin = said.index(piece, begin) + len(piece)
    assert found.key == row["key"], said
    for language in ("fr", "zh"):
        assert holes(found.cause, language) == holes(found.help, language) == []
