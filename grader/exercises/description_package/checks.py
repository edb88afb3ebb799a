"""What is looked at: the installation, the launch files, the description, its meshes, the rest."""

from __future__ import annotations

from grader.exercise.check import Checks, Tolerances
from grader.exercise.verdict import Finding
from grader.exercises.description_package import (
    installing,
    launching,
    needs,
    robots,
    spawning,
)
from grader.exercises.description_package.looked import looked_at
from grader.recording.recording import Recordings

checks = Checks()


@checks()
def installed(recordings: Recordings, tolerances: Tolerances) -> Finding:
    """Everything that is asked for is installed.

    setup.py is run with a `setup()` that only takes its arguments down (of a CMakeLists.txt, the
    install() commands are read), and the files are laid out below an empty prefix. What launch
    files ask for (descriptions, meshes, RViz's files, other launch files, programs, packages) has
    to be there, in that prefix and when it is moved to another place.

    - setup.py ends with an error, or lists a file that is not there, or a folder: 0, for colcon
      build stops there.
    - One thing is missing: half of the points. The files of one folder count as one thing.
    - More is missing: 0.

    A marker below share/ament_index, or a package.xml, that nothing installs costs nothing: colcon
    adds both.
    """
    return looked_at(recordings, installing.judge)


@checks()
def launch(recordings: Recordings, tolerances: Tolerances) -> Finding:
    """A launch file shows the robot: its description, its joints, RViz.

    Each launch file (Python, XML or YAML) is evaluated with its default arguments, and nothing is
    started. The best of them counts, of those that start RViz, where any does:

    - robot_state_publisher with the parameter robot_description: half of the points,
    - something that publishes joint states, if any joint moves: joint_state_publisher, with or
      without gui, a node of the package, a controller, a simulator: a quarter,
    - rviz2 with a file: a quarter. Who opens RViz by hand needs an .rviz file that is installed.

    If it ends with an error: 0; if another one of the package does: half at most. One that uses
    what the grader does not know makes this check not judged, where nothing else passes it.
    """
    return looked_at(recordings, launching.judge)


@checks()
def urdf(recordings: Recordings, tolerances: Tolerances) -> Finding:
    """The description is a valid URDF, of which nothing is dropped.

    What robot_state_publisher gets is read by the rules of urdfdom 4.0.2, ROS 2 Jazzy's; where no
    launch file hands on any, what the files of the package give.

    - urdfdom refuses it, or xacro has not been run on it: 0.
    - urdfdom drops a part (it says so, and the robot shows without it), or accepts what cannot be
      meant (limits with lower above upper, an axis 0 0 0, a link with two parents, a mimic of no
      joint, a mass or moment of inertia that no body has, an rpy of more than a turn): half of
      the points.
    """
    return looked_at(recordings, robots.judge)


@checks()
def meshes(recordings: Recordings, tolerances: Tolerances) -> Finding:
    """Meshes are named by package://, and are there.

    Each file that the description names, textures too, has to be found from its name: by
    package://PACKAGE/PATH, or a file:// that $(find) has made. The share of those that are so is
    the share of the points. One that the package has and does not install is no fault here.
    A description without any gets all points, if a launch file starts anything.
    """
    return looked_at(recordings, robots.judge_meshes)


@checks()
def dependencies(recordings: Recordings, tolerances: Tolerances) -> Finding:
    """package.xml declares the packages that are used.

    Used are those whose nodes or files a launch file starts or includes, whose meshes the
    description names, and xacro. What every desktop installation of ROS 2 has
    (robot_state_publisher, rviz2, tf2_ros, ...) need not be declared. The share that is, is the
    share of the points.
    """
    return looked_at(recordings, needs.judge)


@checks()
def spawn(recordings: Recordings, tolerances: Tolerances) -> Finding:
    """What puts the robot into Gazebo has the right arguments.

    spawn_entity.py of gazebo_ros, or create of ros_gz_sim: exactly one origin (-topic, -file, ...),
    a name where one is needed, numbers as places, and a topic that a launch file publishes.
    All or nothing; a package that puts nothing into Gazebo gets the points.
    """
    return looked_at(recordings, lambda looked: spawning.judge(looked, False))
