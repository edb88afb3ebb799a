"""A policy for late hand-ins is kept: nobody is graded by it whose lateness is not known."""

import pytest

from tests.files import lay
from tests.grader_class.classes import batch, rows, work_here

NODE = "import rclpy\n"
LATE = "late: {due: 2026-11-30T23:59:00Z, grace_min: 5, per_day: 10}\n"
ROSTER = "id,at\n1,2026-11-30T10:00:00Z\n2,2026-12-02T10:00:00Z\n"


@pytest.fixture
def exercise(tmp_path):
    text = f"exercise: square\nlimits: {{total_s: 1}}\nvaried_runs: {{count: 1}}\n{LATE}"
    return lay(tmp_path, {"late.yaml": text}) / "late.yaml"


@pytest.fixture
def graded(exercise, tmp_path, monkeypatch):
    """The exit code of a class, what was said, and each one's days and points of lateness."""
    work_here(monkeypatch)

    def call(files):
        out = tmp_path / "class"
        handed_in = lay(tmp_path / "handed_in", files)
        code, said = batch(handed_in, "--out", out, "--exercise", exercise)
        book = rows(out / "gradebook.csv") if code == 0 else {}
        return code, said, {id: (r["late_days"], r["late_deduction"]) for id, r in book.items()}

    return call


CANVAS = {"ann_1_11_node.py": NODE, "bob_2_12_node.py": NODE}
MOODLE = {
    "Ann A_1_assignsubmission_file/node.py": NODE,
    "Bob B_2_assignsubmission_file/node.py": NODE,
}
PLAIN = {"1.py": NODE, "2.py": NODE}


@pytest.mark.parametrize("files", [CANVAS, MOODLE, PLAIN], ids=["Canvas", "Moodle", "folder"])
def test_a_class_without_times_is_refused_until_a_roster_has_them(files, graded):
    code, said, _ = graded(files)
    said = " ".join(said.split())
    assert (code, "when they were handed in is not known: 1, 2" in said) == (2, True), said
    assert "a roster.csv with the columns id and at" in said
    code, said, late = graded({**files, "roster.csv": ROSTER})
    assert (code, late["1"][0], late["2"][0]) == (0, "0", "2"), said


def test_who_handed_in_nothing_needs_no_time(graded):
    code, said, late = graded({"1.py": NODE, "roster.csv": ROSTER + "3,\n"})
    assert (code, late["3"]) == (0, ("0", "0.00")), said


def test_what_canvas_marks_as_late_is_a_day_late_and_nobody_else_is(graded):
    code, said, late = graded({"ann_1_11_node.py": NODE, "bob_LATE_2_12_node.py": NODE})
    assert (code, late["1"][0], late["2"][0]) == (0, "0", "1"), said
