"""Programs that try to earn points without doing their task earn none."""

import pytest

import grader
from grader.exercise.loading import load_exercise
from tests import hand_ins, runs

CASES = {
    (exercise, name): case
    for exercise, cases in hand_ins.read("without_the_task").items()
    for name, case in cases.items()
}


@pytest.mark.parametrize(("exercise", "name"), CASES)
def test_a_check_gives_no_point_for_a_task_that_is_not_done(exercise, name):
    case = CASES[exercise, name]
    result = grader.grade(runs.path_of(f"without_the_task/{exercise}/{name}"), exercise)
    earned = {verdict.check: verdict.score for verdict in result.verdicts if verdict.score}
    points = load_exercise(exercise).points
    assert earned == {check: points[check] for check in case["earns"]}, result.verdicts
    beyond = [verdict for verdict in result.verdicts if verdict.check == "allowed"]
    assert [verdict.passed for verdict in beyond] == ["beyond" not in case] * len(beyond)
    for verdict in beyond if "beyond" in case else ():
        assert f"Your program used {case['beyond']} at " in str(verdict.rationale)
        assert ".py, line " in str(verdict.rationale)
        assert verdict.evidence
