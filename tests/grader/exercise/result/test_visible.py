from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from grader.exercise.loading import load_exercise
from grader.exercise.result.diagnosis import Diagnosis, costliest
from grader.exercise.result.json_file import typed
from grader.exercise.result.result import NotShown, Result, RunSummary
from grader.exercise.result.visible import student_view
from grader.exercise.verdict import Verdict
from grader.judging import judge
from grader.recording.recording import Recordings
from grader.scenes.turtlesim.driving import twist
from grader.testing import drive
from grader.text.message import NOTHING, msg
from tests.grader.reports import samples
from tests.grader.testing import exercises


def verdict(check, status="passed", visible="now", score=None, **more):
    earned = {"passed": 10.0}.get(status, 0.0) if score is None else score
    made = samples.verdict(check, status, earned, **more)
    return replace(typed(Verdict, made), visible=visible)


def result_of(*verdicts, diagnosis="costliest"):
    """As it is built: the cause that a run shows, else the check that costs most."""
    found = costliest(verdicts) if diagnosis == "costliest" else diagnosis
    return Result(
        "some_exercise",
        "controller.py",
        round(sum(v.score for v in verdicts), 2),
        round(sum(v.max_score for v in verdicts), 2),
        tuple(verdicts),
        typed(RunSummary, samples.run()),
        diagnosis=found if any(not v.passed for v in verdicts) else None,
    )


def test_a_result_with_nothing_to_hide_is_shown_as_it_is():
    result = result_of(verdict("a"), verdict("b", "failed"))
    assert student_view(result) is student_view(result, after_due=True) is result


def test_of_points_only_title_status_and_points_stay():
    points = verdict("a", "failed", "points_only", 2.5, evidence=[samples.evidence("a gap")])
    (seen,) = student_view(result_of(points)).verdicts
    assert (seen.check, str(seen.title), seen.status, seen.score, seen.max_score) == (
        *("a", "Title of a", "failed"),
        *(2.5, 10),
    )
    assert str(seen.rationale) == (
        "“Title of a” did not pass in full. What was found is not shown: only its points are."
    )
    assert (seen.help, seen.evidence) == (NOTHING, ())


@pytest.mark.parametrize("visible", ["never", "after_due"])
def test_what_is_hidden_is_not_there_and_not_in_the_totals(visible):
    result = result_of(verdict("a"), verdict("b", "failed", visible, 4))
    seen = student_view(result)
    assert [v.check for v in seen.verdicts] == ["a"]
    assert (seen.score, seen.max_score, seen.diagnosis) == (10, 10, None)
    assert seen.not_shown == NotShown(1, 10, int(visible == "after_due"))


def test_when_the_exercise_is_over_the_rest_stays_hidden():
    late = verdict("a", "failed", "after_due")
    result = result_of(late, verdict("b", visible="never"), verdict("c", visible="points_only"))
    seen = student_view(result, after_due=True)
    assert seen.verdicts[0] == late
    assert [v.check for v in seen.verdicts] == ["a", "c"]
    assert seen.not_shown == NotShown(1, 10)
    assert seen.diagnosis == result.diagnosis


def test_the_first_line_is_of_what_is_shown_and_tells_a_finding_if_it_may():
    hidden = verdict("hidden", "failed", "never", max_score=80)
    points = verdict("points", "failed", "points_only", max_score=40)
    shown = verdict("shown", "failed")
    seen = student_view(result_of(hidden, points, shown))
    assert seen.diagnosis.check == "shown"
    alone = student_view(result_of(hidden, points, verdict("shown")))
    assert str(alone.diagnosis.cause).startswith("“Title of points” did not pass in full.")


def test_what_a_run_shows_by_itself_is_said_where_points_that_are_shown_are_lost():
    crashed = Diagnosis("crashed", msg("You crashed."), msg("Mend it."))
    hidden = verdict("b", "failed", "never")
    lost = result_of(verdict("a", "failed"), hidden, diagnosis=crashed)
    assert student_view(lost).diagnosis == crashed
    assert student_view(result_of(verdict("a"), hidden, diagnosis=crashed)).diagnosis is None


def test_a_check_that_is_shown_does_not_name_a_hidden_one_that_it_waits_for():
    """An exercise like that is not loaded; a file may say it."""
    hidden = verdict("hidden", "failed", "never")
    waits = verdict("waits", "not_judged", depends_on=["hidden"], rationale="Title of hidden")
    (seen,) = student_view(result_of(hidden, waits)).verdicts
    assert "hidden" not in str(seen)
    assert seen.depends_on == ()


VISIBLE = st.sampled_from(["now", "points_only", "after_due", "never"])
STATUS = st.sampled_from(["passed", "failed", "not_judged"])


@st.composite
def twins(draw):
    """Two results that differ in hidden verdicts only, and whether the exercise is over."""
    after_due = draw(st.booleans())
    one, other = [], []
    for number in range(draw(st.integers(1, 5))):
        visible, before = draw(VISIBLE), [v.check for v in one if v.visible == "now"]
        waits = draw(st.lists(st.sampled_from(before), max_size=1)) if before else []
        most = draw(st.sampled_from([1.0, 5.0, 30.0]))
        more = {"max_score": most, "depends_on": waits}

        def drawn(kind=visible, more=more, most=most, number=number):
            status = draw(STATUS)
            score = most if status == "passed" else 0.0
            told = {"rationale": draw(st.text(max_size=3)), "help": draw(st.text(max_size=3))}
            return verdict(f"c{number}", status, kind, score, **more, **told)

        one.append(drawn())
        is_hidden = visible == "never" or (visible == "after_due" and not after_due)
        other.append(drawn() if is_hidden else one[-1])
    run = draw(
        st.sampled_from(["costliest", Diagnosis("crashed", msg("You crashed."), msg("Mend it."))])
    )
    return result_of(*one, diagnosis=run), result_of(*other, diagnosis=run), after_due


@given(twins())
def test_whatever_came_of_hidden_checks_the_same_is_shown(made):
    one, other, after_due = made
    seen = student_view(one, after_due)
    assert seen == student_view(other, after_due)
    assert student_view(seen, after_due) == seen
    assert Result.from_json(seen.to_json()) == seen


def test_a_result_says_what_students_see_of_it_and_no_remark_tells_that_all_passed(tmp_path):
    """A remark on a node that crashed after its work says that this costs nothing."""
    exercise = load_exercise(exercises.write(tmp_path / "ahead", visible={"far": "never"}))
    shown = load_exercise(exercises.write(tmp_path / "shown", exercise="shown"))

    def controller(tick, pose, arena):
        twist(arena, 1.0, 0.0)

    ran = drive(controller, ticks=200)
    ran = replace(ran, run=replace(ran.run, outcome="crashed", exit_code=1))
    whole, hiding = (judge(Recordings(ran), each) for each in (shown, exercise))
    assert [v.visible for v in hiding.verdicts] == ["now", "never"]
    assert all(v.passed for v in (*whole.verdicts, *hiding.verdicts))
    assert "it costs no points" in " ".join(map(str, whole.run.flags))
    assert "it costs no points" not in " ".join(map(str, hiding.run.flags))
    assert Result.from_json(hiding.to_json()) == hiding
