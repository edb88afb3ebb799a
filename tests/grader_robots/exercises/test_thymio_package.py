"""A Thymio loses what it should, and the first line names why."""

import pytest

from grader.exercise.loading import load_exercise
from grader.testing.checking import examine
from grader.testing.solutions import read_solutions
from grader_robots.inspection.oddities import odd_traces
from tests.grader_robots.packages import graded, lost, recorded, written
from tests.tiers import others_are_more

EXERCISE = load_exercise("thymio_package")
REFERENCE = EXERCISE.folder / "reference"
SOLUTIONS = {solution.name: solution for solution in read_solutions(EXERCISE)}
FIRST_LINES = {
    "wheels_stay_beside": "base_width changes the size of a part, and left_wheel_link does not",
    "caster_stays": "base_length changes the size of a part, and caster_wheel_link does not",
    "body_of_numbers": "doubling base_length changes the size of nothing",
    "in_grams": "weighs 270000 g",
    "caster_without_inertial": "The link 'caster_wheel_link' has a collision and no inertial",
    "sliders_beside_gazebo": "joint_state_publisher_gui beside Gazebo",
    "never_put_there": "No launch file puts the robot into Gazebo",
}


RIGHT = [name for name, each in SOLUTIONS.items() if each.is_right]
EACH = "half a second each; the first mutant is graded by each make test"


@pytest.mark.parametrize("name", others_are_more(EACH, RIGHT, RIGHT[-1]))
def test_a_right_thymio_keeps_all_points(name, tmp_path):
    assert lost(graded(SOLUTIONS[name].lay_out(tmp_path), EXERCISE)) == {}


@pytest.mark.parametrize(
    "name", others_are_more(EACH, FIRST_LINES, "body_of_numbers", "in_grams", "never_put_there")
)
def test_the_first_line_of_a_wrong_thymio_names_its_mistake(name, tmp_path):
    solution = SOLUTIONS[name]
    result = graded(solution.lay_out(tmp_path), EXERCISE)
    assert FIRST_LINES[name] in str(result.diagnosis.cause)
    assert lost(result) == solution.leaves


def test_its_checks_survive_whatever_a_package_is():
    for what, trace in odd_traces().items():
        assert examine(EXERCISE, recorded(trace))[1] == [], what


def test_a_xacro_that_is_not_installed_has_its_numbers_all_the_same(tmp_path):
    cmake = (REFERENCE / "CMakeLists.txt").read_text().replace(" urdf", "")
    result = graded(written(tmp_path, {"CMakeLists.txt": cmake}, REFERENCE), EXERCISE)
    assert not {"parameters", "masses", "wheels", "urdf"} & lost(result).keys()


def test_what_waits_for_a_robot_is_not_judged_where_xacro_makes_none(tmp_path):
    xacro = (REFERENCE / "urdf/thymio.urdf.xacro").read_text().replace("</robot>", "")
    result = graded(written(tmp_path, {"urdf/thymio.urdf.xacro": xacro}, REFERENCE), EXERCISE)
    left = {verdict.check: verdict.status for verdict in result.verdicts if not verdict.passed}
    waits = ("meshes", "parameters", "masses", "wheels", "spawns", "one_source")
    assert left == {"urdf": "failed", "launch": "failed"} | dict.fromkeys(waits, "not_judged")
