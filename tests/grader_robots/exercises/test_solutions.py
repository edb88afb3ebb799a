"""Right solutions and mutants may be packages."""

import pytest

from grader.exercise.loading import load_exercise
from grader.testing import check_exercise
from grader.testing.solutions import read_solutions


def test_a_solution_may_be_a_package_of_which_files_are_changed_put_and_removed(tmp_path):
    found = {each.name: each for each in read_solutions(load_exercise("state_publisher"))}
    loop = found["constructor_loop"].lay_out(tmp_path)
    assert "create_rate" in (loop / "walker" / "state_publisher.py").read_text()
    assert found["constructor_loop"].is_right
    assert not (found["no_launch_file"].lay_out(tmp_path) / "launch" / "walker.launch.py").exists()
    setup = (found["urdf_not_installed"].lay_out(tmp_path) / "setup.py").read_text()
    assert "urdf/*.xacro" in setup


@pytest.mark.more("a grading for each right solution and each mutant")
@pytest.mark.timeout(3600)
@pytest.mark.parametrize("name", ["description_package", "thymio_package", "state_publisher"])
def test_every_solution_is_judged_and_told_as_its_list_says(name):
    problems = check_exercise(name).problems
    assert [str(each.text) for each in problems] == []
