"""A launch file that plainly starts several nodes of a package says what to start; none is run."""

import pytest

from grader.errors import SubmissionError
from grader.run.opening import open_submission
from grader.submission.program import EntryPoint, Program, Script
from grader.submission.request import LaunchAsked
from tests.files import lay
from tests.grader.submission.copies import NODE
from tests.grader.submission.test_building import PACKAGE
from tests.hand_ins import SUBMISSIONS

HEAD = """from launch import LaunchDescription
from launch.actions import *
from launch.conditions import IfCondition
from launch.event_handlers import OnShutdown
from launch.substitutions import *
from launch_ros.actions import *
import launch_ros.actions


def generate_launch_description():
"""
LIST = HEAD + "    return LaunchDescription([{}])\n"
DRIVE = "Node(package='spiral', executable='turtle_controller')"
PENS = "Node(package='spiral', executable='pen_node')"
BOTH = LIST.format(f"{DRIVE}, {PENS}")
SCRIPTS = "'turtle_controller = spiral.node:main', 'pen_node = spiral.pens:main'"
TWO = PACKAGE | {
    "setup.py": PACKAGE["setup.py"].replace("'turtle_controller = spiral.node:main'", SCRIPTS),
    "spiral/pens.py": NODE,
}


NOT_INSTALLED = (
    "`ros2 launch` would not find launch/{}: setup.py does not install it; list it in data_files"
)


def opened(path, executable=None, launch=None, programs=()):
    with open_submission(path, executable, launch, programs=programs) as submission:
        return submission


def launched(folder, actions, name="a.launch.py", **asked):
    return opened(lay(folder, TWO | {f"launch/{name}": LIST.format(actions)}), **asked)


def names(submission):
    return [program.name for program in submission.programs]


def notes(submission):
    return [str(note) for note in submission.notes]


@pytest.mark.parametrize(
    ("more", "note"),
    [
        (
            "ExecuteProcess(cmd=['ls', '-l'])",
            "launch/a.launch.py starts programs of other packages, and these were not: ls -l",
        ),
        (
            f"RegisterEventHandler(OnShutdown(on_shutdown=[{PENS}]))",
            "launch/a.launch.py starts programs after an event, and these were not: pen_node",
        ),
    ],
)
def test_what_a_launch_file_does_besides_is_followed_or_named(tmp_path, more, note):
    submission = launched(tmp_path, f"{DRIVE}, {PENS}, {more}")
    assert names(submission) == ["turtle_controller-1", "pen_node-2"]
    assert any(each.startswith(note) for each in notes(submission))


def test_what_is_started_again_is_said_once(tmp_path):
    again = PENS.replace(")", ", respawn=True)")
    submission = launched(tmp_path, f"{DRIVE}, {again}")
    assert names(submission) == ["turtle_controller-1", *["pen_node-2"] * 4]
    assert str(submission.found) == "launch/a.launch.py, which starts turtle_controller, pen_node"


def test_a_launch_file_that_starts_a_program_in_cpp_cannot_be_graded(tmp_path):
    both = LIST.format(f"{DRIVE}, Node(package='arm', executable='move')")
    files = {f"spiral/{name}": text for name, text in TWO.items()}
    files |= {"spiral/launch/a.launch.py": both, "arm/CMakeLists.txt": "project(arm)\n"}
    files |= {"arm/package.xml": "<package><name>arm</name></package>"}
    lay(tmp_path, files)
    with pytest.raises(SubmissionError, match=r"starts arm move, which is not in Python. Only"):
        opened(tmp_path)


INCLUDES = HEAD + (
    "    part = __file__.replace('all', 'part')\n"
    f"    return LaunchDescription([IncludeLaunchDescription(part), {DRIVE}])\n"
)


def test_a_launch_file_that_another_includes_is_none_to_choose(tmp_path):
    part = LIST.format(f"{PENS}, {PENS}")
    files = {"launch/all.launch.py": INCLUDES, "launch/part.launch.py": part}
    submission = opened(lay(tmp_path, TWO | files))
    assert names(submission) == ["pen_node-1", "pen_node-2", "turtle_controller-3"]


def test_several_nodes_of_a_launch_file_are_started(tmp_path):
    submission = launched(tmp_path, f"{DRIVE}, {PENS}", "both.launch.py")
    root = submission.root
    assert submission.programs == (
        Program(
            *("turtle_controller-1", "spiral", "turtle_controller"),
            *(EntryPoint("spiral.node", "main"), root),
        ),
        Program("pen_node-2", "spiral", "pen_node", EntryPoint("spiral.pens", "main"), root),
    )
    assert notes(submission) == [NOT_INSTALLED.format("both.launch.py")]
    assert "rclpy" in submission.imports.surely


def test_it_settles_what_to_start_where_no_script_has_the_usual_name(tmp_path):
    files = {
        name: text.replace("turtle_controller", "drive")
        for name, text in (TWO | {"launch/both.launch.py": BOTH}).items()
    }
    assert names(opened(lay(tmp_path, files))) == ["drive-1", "pen_node-2"]


def test_who_asks_for_one_program_gets_that_alone(tmp_path):
    submission = launched(tmp_path, f"{DRIVE}, {PENS}", "both.launch.py", executable="pen_node")
    assert submission.entry == EntryPoint("spiral.pens", "main")
    assert str(submission.remarks[-1]) == (
        "launch/both.launch.py was evaluated and not run: pen_node was started by itself, "
        "without turtle_controller"
    )


def test_the_simulator_is_there_already_and_other_programs_are_told(tmp_path):
    simulator = "Node(package='turtlesim', executable='turtlesim_node')"
    other = "Node(package='rqt_graph', executable='rqt_graph')"
    submission = launched(tmp_path, f"{simulator}, {DRIVE}, {other}, {PENS}", "all_launch.py")
    assert notes(submission) == [
        "launch/all_launch.py starts programs of other packages, and these were not: "
        "rqt_graph rqt_graph",
        NOT_INSTALLED.format("all_launch.py"),
    ]


@pytest.mark.parametrize(
    ("actions", "note"),
    [
        (
            f"nothing(), {DRIVE}",
            "launch/a.launch.py was not run, and what it starts cannot be read (NameError: name "
            "'nothing' is not defined): judged is turtle_controller alone",
        ),
        (
            DRIVE.replace(")", ", namespace='left')"),
            "launch/a.launch.py was evaluated and not run: turtle_controller was started by "
            "itself, without its namespace",
        ),
        (DRIVE.replace(")", ", name='me')"), "another program"),
    ],
)
def test_a_launch_file_that_is_not_run_is_told_where_it_matters(tmp_path, actions, note):
    submission = launched(tmp_path, actions)
    assert submission.entry == EntryPoint("spiral.node", "main")
    assert any(str(remark).startswith(note) for remark in submission.remarks)


def test_what_ros2_launch_would_not_find_is_told(tmp_path):
    other = DRIVE.replace("turtle_controller", "turtle_controller.py")
    remarks = launched(tmp_path, other).remarks
    assert any("would not find launch/a.launch.py" in str(remark) for remark in remarks)
    assert any("starts turtle_controller.py, which setup.py" in str(remark) for remark in remarks)


OTHER = LIST.format(f"{PENS}, {DRIVE}")


def test_of_two_launch_files_one_has_to_be_chosen_where_no_script_fits(tmp_path):
    renamed = TWO["setup.py"].replace("turtle_controller =", "drive_node =")
    files = {"launch/a.launch.py": BOTH, "launch/b.launch.py": OTHER}
    files = {name: text.replace("turtle_controller", "drive_node") for name, text in files.items()}
    lay(tmp_path, TWO | files | {"setup.py": renamed})
    with pytest.raises(SubmissionError) as caught:
        opened(tmp_path)
    said = "choose one with --launch launch/a.launch.py, --launch launch/b.launch.py"
    assert said in str(caught.value)
    for file in ("b.launch.py", "launch/b.launch.py", "./launch/b.launch.py"):
        chosen = opened(tmp_path, launch=LaunchAsked(file))
        assert names(chosen) == ["pen_node-1", "drive_node-2"]


def test_the_launch_file_that_is_asked_for_may_start_one_program_by_its_arguments(tmp_path):
    node = "Node(package='spiral', executable=LaunchConfiguration('which'), name='n')"
    asked = LaunchAsked("a.launch.py", {"which": "pen_node"})
    found = launched(tmp_path, f"DeclareLaunchArgument('which'), {node}", launch=asked)
    assert names(found) == ["pen_node-1"]
    assert found.programs[0].arguments[-1] == "__node:=n"
    with pytest.raises(SubmissionError, match="was not provided"):
        opened(tmp_path, launch=LaunchAsked("a.launch.py"))


def test_the_launch_file_that_is_asked_for_is_looked_at_however_many_there_are(tmp_path):
    files = {f"launch/{n:02}.launch.py": BOTH for n in range(41)}
    submission = opened(lay(tmp_path, TWO | files), launch=LaunchAsked("launch/40.launch.py"))
    assert names(submission) == ["turtle_controller-1", "pen_node-2"]


def test_an_argument_that_is_not_declared_is_told(tmp_path):
    declares = "DeclareLaunchArgument('speed', default_value='1')"
    asked = LaunchAsked("a.launch.py", {"sped": "2"})
    found = launched(tmp_path, f"{declares}, {DRIVE}, {PENS}", launch=asked)
    assert "launch/a.launch.py declares no argument sped, only speed" in notes(found)
    assert names(found) == ["turtle_controller-1", "pen_node-2"]


def test_of_two_launch_files_none_is_needed_where_the_exercise_names_the_programs(tmp_path):
    lay(tmp_path, TWO | {"launch/a.launch.py": BOTH, "launch/b.launch.py": OTHER})
    assert names(opened(tmp_path)) == ["turtle_controller-1"]
    found = opened(tmp_path, programs=("pen_node", "turtle_controller"))
    assert names(found) == ["pen_node-1", "turtle_controller-2"]
    assert "several launch files start several programs, and none of them was used: " in " ".join(
        notes(found)
    )


def test_a_launch_file_that_fails_half_way_starts_nothing_and_is_told(tmp_path):
    fails = f"{DRIVE}, OpaqueFunction(function=lambda _: 1 / 0), {PENS}"
    found = launched(tmp_path, fails, programs=("pen_node", "turtle_controller"))
    assert names(found) == ["pen_node-1", "turtle_controller-2"]
    said = "launch/a.launch.py cannot be launched: ZeroDivisionError: division by zero"
    assert f"{said} (launch/a.launch.py, line 11)" in notes(found)


def test_a_file_of_parameters_that_is_not_there_is_only_told(tmp_path):
    node = DRIVE.replace(")", ", parameters=['/nowhere/all.yaml'])")
    found = launched(tmp_path, f"{node}, {PENS}")
    assert names(found) == ["turtle_controller-1", "pen_node-2"]
    assert any("was started without --params-file, /nowhere/all.y" in each for each in notes(found))


def test_a_launch_file_that_is_asked_for_and_not_there_is_told(tmp_path):
    lay(tmp_path, TWO | {"launch/a.launch.py": BOTH})
    with pytest.raises(SubmissionError, match=r"no launch file c.launch.py; it has: launch/a"):
        opened(tmp_path, launch=LaunchAsked("c.launch.py"))
    with pytest.raises(SubmissionError, match="no package with launch files"):
        opened(tmp_path / "spiral/node.py", launch=LaunchAsked("a.launch.py"))


def test_the_programs_of_an_exercise_are_started_where_they_are_there(tmp_path):
    lay(tmp_path, TWO | {"launch/a.launch.py": BOTH})
    assert names(opened(tmp_path, programs=("pen_node",))) == ["pen_node-1"]
    pair = ("pen_node", "turtle_controller")
    assert names(opened(tmp_path, programs=pair)) == ["turtle_controller-1", "pen_node-2"]
    (tmp_path / "launch/a.launch.py").write_text(LIST.format(PENS))
    assert names(opened(tmp_path, programs=pair)) == ["pen_node-1"]  # as it is launched
    (tmp_path / "launch/a.launch.py").unlink()
    assert names(opened(tmp_path, programs=pair)) == ["pen_node-1", "turtle_controller-2"]
    others = opened(tmp_path, programs=("talker", "listener"))
    assert names(others) == ["turtle_controller-1", "pen_node-2"]  # as many


def test_programs_of_several_packages_of_a_workspace_are_started(tmp_path):
    other = {
        name.replace("spiral", "pens"): text.replace("spiral", "pens")
        for name, text in PACKAGE.items()
    }
    other["setup.py"] = other["setup.py"].replace("turtle_controller", "pen_node")
    for folder, files in (("spiral", PACKAGE), ("pens", other)):
        lay(tmp_path / "src" / folder, files)
    launch = LIST.format(f"{DRIVE}, {PENS.replace('spiral', 'pens')}")
    bringup = {"package.xml": PACKAGE["package.xml"].replace("spiral", "bringup")}
    bringup |= {"CMakeLists.txt": "project(bringup)\n", "launch/all.launch.py": launch}
    lay(tmp_path / "src/bringup", bringup)
    submission = opened(tmp_path)
    assert names(submission) == ["turtle_controller-1", "pen_node-2"]
    assert [each.package for each in submission.programs] == ["spiral", "pens"]
    assert [each.root.name for each in submission.programs] == ["spiral", "pens"]


IN_CMAKE = SUBMISSIONS / "launched/in_cmake"


def test_what_cmake_installs_is_a_program_by_its_package_and_name():
    submission = opened(IN_CMAKE)
    paths = [program.entry.path for program in submission.programs]
    assert names(submission) == ["teller-1", "node.py-2"]
    assert [path.parts[-3:] for path in paths] == [
        ("tells", "scripts", "node.py"),
        ("hears", "scripts", "node.py"),
    ]
    left = "PYTHONPATH of teller, PYTHONPATH of node.py"
    assert notes(submission) == [f"of tells/launch/both.launch.py was not followed: {left}"]


def test_one_of_those_that_cmake_installs_can_be_asked_for():
    submission = opened(IN_CMAKE, "teller")
    assert str(submission.found) == "src/tells/scripts/node.py, a program of tells"
    assert "another program was not started: node.py" in notes(submission)


def test_a_script_that_setup_py_installs_is_a_program(tmp_path):
    files = {"scripts/draw": "#!/usr/bin/env python3\n" + NODE, "scripts/run.sh": "#!/bin/sh\n"}
    listed = "('lib/spiral', ['scripts/draw', 'scripts/run.sh'])"
    text = TWO["setup.py"].replace("data_files=[", f"data_files=[{listed}, ")
    assert listed in text
    submission = opened(lay(tmp_path, TWO | files | {"setup.py": text}), "draw")
    assert submission.entry == Script(submission.root / "draw")


def test_of_several_launch_files_the_one_that_starts_all_programs_is_followed(tmp_path):
    files = {"launch/a.launch.py": LIST.format(DRIVE), "launch/b.launch.py": LIST.format(PENS)}
    files |= {"launch/both.launch.py": BOTH}
    submission = opened(lay(tmp_path, TWO | files), programs=("turtle_controller", "pen_node"))
    assert str(submission.found).startswith("launch/both.launch.py, which starts")


def test_launch_files_of_one_name_in_two_packages_are_two(tmp_path):
    other = {name: text.replace("spiral", "zigzag") for name, text in TWO.items()}
    files = {f"a/{name}": text for name, text in (TWO | {"launch/all.launch.py": BOTH}).items()}
    second = other | {"launch/all.launch.py": BOTH.replace("spiral", "zigzag")}
    files |= {f"b/{name.replace('spiral', 'zigzag')}": text for name, text in second.items()}
    lay(tmp_path, files)
    with pytest.raises(SubmissionError, match=r"--launch zigzag/launch/all.launch.py"):
        opened(tmp_path)
    for place, package in (("", "spiral"), ("a/", "spiral"), ("b/", "zigzag"), ("x/b/", "zigzag")):
        submission = opened(tmp_path, launch=LaunchAsked(f"{place}launch/all.launch.py"))
        assert {program.package for program in submission.programs} == {package}


@pytest.mark.parametrize("mark", ["COLCON_IGNORE", "AMENT_IGNORE"])
def test_a_package_that_colcon_passes_by_has_no_programs(tmp_path, mark):
    files = {f"{place}/{name}": text for place in ("a", "old") for name, text in PACKAGE.items()}
    submission = opened(lay(tmp_path, files | {f"old/{mark}": ""}))
    assert submission.root == submission.folder / "a"


def test_more_packages_than_are_looked_at_are_refused(tmp_path):
    files = {f"p{n}/{name}": text for n in range(51) for name, text in PACKAGE.items()}
    with pytest.raises(SubmissionError, match=r"has 51 packages; 50 at most are looked at"):
        opened(lay(tmp_path, files))
