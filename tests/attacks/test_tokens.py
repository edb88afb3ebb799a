"""Tokens of CI systems never reach a submission's process by a course's grade.sh either."""

import pytest

from tests.attacks.attacks import ATTACKS, MOVES
from tests.attacks.handed_in import folder
from tests.attacks.test_one_of_each_kind import SECRET, TOKENS
from tests.grader_class.course.machine import Machine, scripts


@pytest.mark.more("`grader run` alone, in test_one_of_each_kind")
def test_a_submission_that_grade_sh_grades_sees_no_token(tmp_path):
    machine = Machine(tmp_path, real=True)
    student = folder(machine.folder / "student", ATTACKS["reads_environment"].program, {})
    exercise = machine.folder / "exercise.yaml"
    exercise.write_text("exercise: turtlesim_challenge\n" + MOVES)
    tokens = dict.fromkeys(TOKENS, SECRET)
    done = machine.bash(
        scripts() / "grade.sh", student, machine.work, EXERCISE=str(exercise), **tokens
    )
    assert done.returncode == 0, done.stdout + done.stderr
    graded = machine.work / "graded"
    assert "ACHIEVED environment" in (graded / "output.txt").read_text()
    files = [path for path in graded.rglob("*") if path.is_file()]
    assert [path for path in files if SECRET.encode() in path.read_bytes()] == []
