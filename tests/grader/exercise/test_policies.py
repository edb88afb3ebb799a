"""What exercise.yaml says of who sees what, of late hand-ins, and of each student's own starts."""

from datetime import UTC, datetime, timedelta, timezone

import pytest
import yaml

from grader.exercise.loading import load_exercise
from grader.exercise.policies import Late, LatePolicy
from grader.exercise.sheet import Start, sheet
from grader.scenes.subject import load_subject
from tests.grader.testing import exercises
from tests.grader.testing.exercises import edited, refusal

NAME = "turtlesim_challenge"


def loaded(tmp_path, text):
    return load_exercise(edited(tmp_path, text))


def test_what_is_said_is_part_of_the_rubric_and_not_of_what_a_run_depends_on(tmp_path):
    original = load_exercise(NAME)
    assert (dict(original.visible), original.late) == ({}, None)
    exercise = loaded(
        tmp_path,
        "visible: {steady_rate: points_only, edge_stop: after_due}\n"
        "late: {due: 2026-11-30T23:59:00+01:00, grace_min: 10, per_day: 10, most: 50}\n",
    )
    assert exercise.visible == {"steady_rate": "points_only", "edge_stop": "after_due"}
    due = datetime(2026, 11, 30, 22, 59, tzinfo=UTC)
    assert exercise.late == LatePolicy(due, 10, 10, 50)
    shown = loaded(tmp_path, "visible: {edge_stop: never}")
    late = loaded(tmp_path, "late: {due: 2026-11-30T23:59:00Z}")
    assert shown.conditions == late.conditions == original.conditions
    assert len({original.sha256, shown.sha256, late.sha256}) == 3


@pytest.mark.parametrize("due", ["2026-11-30T23:59+01:00", "'2026-11-30 22:59Z'"])
def test_a_due_time_may_be_written_as_people_write_it(tmp_path, due):
    late = loaded(tmp_path, f"late: {{due: {due}}}").late
    assert late is not None
    assert late.due == datetime(2026, 11, 30, 22, 59, tzinfo=UTC)
    assert (late.grace_min, late.per_day, late.most) == (0, 0, 100)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("visible: never", "line 2: visible: expected an object, found 'never'"),
        (
            "visible:\n  edge: now",
            "line 2: visible: no check is named 'edge'; did you mean 'edge_s",
        ),
        ("visible:\n  edge_stop: no", "line 3: visible: edge_stop: expected one of now, after_due"),
        (
            "late: tomorrow",
            "line 2: late: expected an object of due, grace_min, per_day",
        ),
        ("late: {per_day: 1}", "line 2: late: expected an object of due, grace_min"),
        (
            "late:\n  due: 2026-11-30T23:59:00",
            "line 3: late: due: expected a date, a time and its ",
        ),
        ("late:\n  due: 2026-11-30", "its zone, e.g. 2026-11-30T23:59:00+01:00; found 2026-11-30"),
        ("late:\n  due: soon", "line 3: late: due: expected a date, a time and its zone"),
        ("late:\n  due: 5", "line 3: late: due: expected a date, a time and its zone"),
        (
            "late:\n  due: 2026-11-30T23:59:00Z\n  per_day: 10 %",
            "line 4: late: per_day: expected a number, found '10 %'",
        ),
        ("late: {due: 2026-11-30T23:59:00Z, most: -1}", "late: most: expected 0 or more, found -1"),
        (
            "late: {due: 2026-11-30T23:59:00Z, grace: 1}",
            "grace_min, per_day, most, found ['grace']",
        ),
        ("varied_runs:\n  per_student: 1", "line 3: varied_runs: per_student: expected true or "),
    ],
)
def test_a_slip_is_told_with_file_and_line(tmp_path, text, words):
    said = refusal(edited(tmp_path, text))
    assert words in said
    assert "mine.yaml, line " in said


@pytest.mark.parametrize(
    ("one", "other", "is_refused"),
    [
        *(("never", "now", True), ("never", "after_due", True), ("after_due", "points_only", True)),
        *(("points_only", "now", False), ("after_due", "never", False), ("never", "never", False)),
    ],
)
def test_a_check_is_not_shown_before_one_that_it_waits_for(tmp_path, one, other, is_refused):
    """For "not judged" would tell of the other."""
    path = exercises.write(tmp_path / "ahead", visible={"commands": one, "far": other})
    if is_refused:
        assert f"commands: {one}, but 'far'" in refusal(path)
    else:
        assert load_exercise(path).visible["far"] == other


def test_each_student_has_starts_of_his_own_where_the_exercise_says_so(tmp_path):
    exercise = loaded(tmp_path, "varied_runs: {per_student: true, seed: 1946}")
    assert exercise.seed_for("4711") == 1048175886
    assert exercise.seed_for("Zoe\u0308") == exercise.seed_for("Zo\u00eb")
    starts = [exercise.starts(exercise.seed_for(student)) for student in ("4711", "4712")]
    assert starts[0] != starts[1]
    reseeded = loaded(tmp_path, "varied_runs: {per_student: true, seed: 99}")
    assert reseeded.seed_for("4711") != exercise.seed_for("4711")
    assert load_exercise(NAME).seed_for("4711") is None
    # ... and where there is a secret
    asked = (("4711", "this"), ("4712", "this"), ("4711", "that"))
    assert len({load_exercise(NAME).seed_for(*each) for each in asked} - {None}) == 3
    assert loaded(tmp_path, "varied_runs: {per_student: false}").seed_for("4711") is None
    own = loaded(tmp_path, "varied_runs: {per_student: true}")
    assert own.conditions["varied_runs.per_student"] == 1
    assert "varied_runs.per_student" not in load_exercise(NAME).conditions


@pytest.mark.parametrize(
    ("policy", "told", "untold"),
    [
        (
            {"visible": {"far": "never"}},
            ["10 points", "`commands` | | 6 | a check that no report shows | |"],
            ["`far`", "It drives for half a metre"],
        ),
        (
            {"visible": {"commands": "points_only", "far": "after_due"}},
            ["no report and no total: `far`.", "not what was found: `commands`."],
            [],
        ),
        (
            {"late": {"due": "2026-11-30T23:59:00Z", "grace_min": 10, "per_day": 2}},
            [
                "It is due on 2026-11-30 at 23:59:00 (UTC+00:00). Another 10 minutes cost nothing.",
                "From then on each started day costs 2 points, 10 at most; nobody has fewer than 0",
            ],
            [],
        ),
        ({"late": {"due": "2026-12-01T23:59:00Z"}}, ["To hand it in later costs no points."], []),
    ],
)
def test_the_sheet_tells_what_is_shown_when_and_what_lateness_costs(tmp_path, policy, told, untold):
    exercise = load_exercise(exercises.write(tmp_path / "ahead", **policy))
    text = sheet(exercise, load_subject(exercise.scene), Start("node.py", "", "grader run mine"))
    text = " ".join(text.split())
    assert [words for words in told if words not in text] == []
    assert [words for words in untold if words in text] == []


def test_an_edited_copy_can_take_back_what_its_original_says(tmp_path):
    late = {"due": datetime(2026, 11, 30, 23, 59, tzinfo=UTC)}
    folder = exercises.write(tmp_path / "ahead", late=late, visible={"far": "never"})
    copy = folder / "open.yaml"
    copy.write_text(yaml.safe_dump({"exercise": "ahead", "late": None, "visible": {}}))
    exercise = load_exercise(copy)
    assert (dict(exercise.visible), exercise.late) == ({}, None)


DUE = datetime(2026, 11, 30, 23, 59, tzinfo=timezone(timedelta(hours=1)))
POLICY = LatePolicy(DUE, grace_min=10, per_day=10, most=25)
DAY_S = 86_400


@pytest.mark.parametrize(
    ("after", "expected"),
    [
        (timedelta(days=-3), Late()),
        (timedelta(0), Late()),
        (timedelta(minutes=10), Late(600)),
        (timedelta(minutes=10, microseconds=1), Late(600.000001, 1, 10)),
        (timedelta(days=1, minutes=10), Late(DAY_S + 600, 1, 10)),
        (timedelta(days=1, hours=3), Late(DAY_S + 10_800, 2, 20)),
        (timedelta(days=2, hours=3), Late(2 * DAY_S + 10_800, 3, 25)),
        (timedelta(days=400), Late(400 * DAY_S, 400, 25)),
    ],
)
def test_each_started_day_after_due_and_grace_costs_up_to_the_limit(after, expected):
    assert POLICY.deduction(DUE + after) == expected


def test_a_time_is_the_same_in_any_zone_and_must_have_one():
    at = DUE + timedelta(hours=5)
    assert POLICY.deduction(at.astimezone(UTC)) == POLICY.deduction(at) == Late(18_000, 1, 10)
    with pytest.raises(ValueError, match=r"with its zone, found 2026-12-01T00:00:00"):
        POLICY.deduction(datetime(2026, 12, 1))
