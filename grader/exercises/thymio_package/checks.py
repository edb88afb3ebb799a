"""What is looked at: what description_package looks at, and what a Thymio is asked for besides."""

from __future__ import annotations

from grader.exercise.check import Checks, Tolerances
from grader.exercise.verdict import Finding
from grader.exercises.description_package import checks as of_packages
from grader.exercises.description_package import spawning
from grader.exercises.description_package.looked import looked_at
from grader.exercises.thymio_package import parametric
from grader.recording.recording import Recordings

checks = Checks()
for check in of_packages.checks:
    checks()(check.function)


@checks()
def spawns(recordings: Recordings, tolerances: Tolerances) -> Finding:
    """A launch file puts the robot into Gazebo.

    As `spawn`, and one has to be there.
    """
    return looked_at(recordings, lambda looked: spawning.judge(looked, True))


@checks()
def parameters(recordings: Recordings, tolerances: Tolerances) -> Finding:
    """The numbers of the xacro are what the robot is made of.

    Each of the properties {numbers} is doubled, and xacro run again: a part has to change its size,
    and what hangs on it away from its middle, along that side, has to move. The share of those that
    do so is the share of the points.
    """
    names = [str(each) for each in tolerances["numbers"]]
    return looked_at(recordings, lambda looked: parametric.judge(looked, names))


@checks()
def masses(recordings: Recordings, tolerances: Tolerances) -> Finding:
    """The robot weighs what it should.

    All links together weigh {mass_kg} kg, give or take {mass_error%}, and each link with a
    collision has an inertial. Otherwise half of the points; none without any mass.
    """
    mass_kg, error = tolerances["mass_kg"], tolerances["mass_error"]
    return looked_at(recordings, lambda looked: parametric.judge_masses(looked, mass_kg, error))


@checks()
def one_source(recordings: Recordings, tolerances: Tolerances) -> Finding:
    """Beside Gazebo nothing else publishes joint states.

    No launch file that puts the robot into Gazebo starts a joint_state_publisher. All or nothing.
    """
    return looked_at(recordings, spawning.judge_one_source)


@checks.tolerance
def numbers(value: object) -> None:
    """Look at the names of properties."""
    if not isinstance(value, list) or not all(isinstance(each, str) for each in value):
        raise ValueError(f"expected a list of names, found {value!r}")
