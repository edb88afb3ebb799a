"""A launch file that plainly starts several nodes of a package says what to start; none is run."""

from pathlib import Path

import pytest

from grader.errors import SubmissionError
from grader.run.opening import open_submission
from grader.submission.start import EntryPoint, Launch, Program, Submission
from tests.files import lay
from tests.grader.submission.test_building import PACKAGE
from tests.grader.submission.test_opening import NODE

HEAD = """from launch import LaunchDescription
from launch_ros.actions import Node
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


def opened(path: Path, executable: str | None = None) -> Submission:
    with open_submission(path, executable) as submission:
        return submission


@pytest.mark.parametrize(
    ("node", "arguments"),
    [
        ("", ()),
        (", output='screen', emulate_tty=True", ()),
        (", name='a', namespace='left'", ("-r", "__node:=a", "-r", "__ns:=/left")),
        (", remappings=[('a', '/b'), ('~/c', 'd')]", ("-r", "a:=/b", "-r", "~/c:=d")),
        (
            ", parameters=[{'rate': 2.5, 'on': True}, {'name': 'x: y', 'many': [1, 2]}]",
            ("-p", "rate:=2.5", "-p", "on:=true", "-p", 'name:="x: y"', "-p", "many:=[1, 2]"),
        ),
        (", arguments=['--fast']", None),
    ],
)
def test_what_a_node_is_given_becomes_the_arguments_of_ros(
    tmp_path: Path, node: str, arguments: tuple[str, ...] | None
) -> None:
    words = ("--fast",) if arguments is None else ("--ros-args", *arguments) if arguments else ()
    given = DRIVE.replace(")", f"{node})")
    text = LIST.format(f"{given}, {PENS}")
    start = opened(lay(tmp_path, TWO | {"launch/a.launch.py": text})).start
    assert isinstance(start, Launch)
    assert start.programs[0].arguments == words


@pytest.mark.parametrize(
    "body",
    [
        f"    a = {DRIVE}\n    b = {PENS}\n    return LaunchDescription([a, b])\n",
        f"    ld = LaunchDescription()\n    ld.add_action({DRIVE})\n    b = {PENS}\n"
        "    ld.add_action(b)\n    return ld\n",
        f"    '''Both.'''\n    both = [launch_ros.actions.{DRIVE}, {PENS}]\n"
        "    return LaunchDescription(initial_entities=both)\n",
        "    names = ['turtle_controller', 'pen_node']\n"
        "    return LaunchDescription([Node(package='spiral', executable=n) for n in names])\n",
    ],
)
def test_however_a_launch_file_is_written_what_counts_is_what_it_starts(
    tmp_path: Path, body: str
) -> None:
    start = opened(lay(tmp_path, TWO | {"launch/a.launch.py": HEAD + body})).start
    assert isinstance(start, Launch)
    assert [program.name for program in start.programs] == ["turtle_controller", "pen_node"]


@pytest.mark.parametrize(
    "more",
    [
        "DeclareLaunchArgument('a', default_value='b')",
        "ExecuteProcess(cmd=['ls'])",
        "Node(package='spiral', executable='pen_node', name='a b')",
        "Node(package='spiral', executable='pen_node', condition=IfCondition('true'))",
        "TimerAction(period=1.0, actions=[Node(package='spiral', executable='pen_node')])",
    ],
)
def test_a_launch_file_that_does_more_than_start_nodes_settles_nothing(
    tmp_path: Path, more: str
) -> None:
    head = "from launch.actions import *\nfrom launch.conditions import IfCondition\n"
    text = head + LIST.format(f"{DRIVE}, {PENS}, {more}")
    submission = opened(lay(tmp_path, TWO | {"launch/a.launch.py": text}))
    assert submission.start == EntryPoint("spiral.node", "main")
    assert str(submission.notes[-1]) == (
        "launch/a.launch.py was evaluated and not run: turtle_controller was started by itself, "
        "without pen_node"
    )


def test_a_launch_file_in_xml_is_evaluated_too(tmp_path: Path) -> None:
    node = "<node pkg='spiral' exec='{}' {}>{}</node>"
    inside = "<remap from='a' to='/b'/><param name='rate' value='2.5'/>"
    drive = node.format("turtle_controller", "name='n' output='screen'", inside)
    text = f"<launch>{drive}{node.format('pen_node', '', '')}</launch>"
    start = opened(lay(tmp_path, TWO | {"launch/a.launch.xml": text})).start
    assert isinstance(start, Launch)
    words = ("--ros-args", "-r", "__node:=n", "-r", "a:=/b", "-p", "rate:=2.5")
    assert [program.arguments for program in start.programs] == [words, ()]


def test_several_nodes_of_a_launch_file_are_started(tmp_path: Path) -> None:
    submission = opened(lay(tmp_path, TWO | {"launch/both.launch.py": BOTH}))
    assert submission.start == Launch(
        (
            Program("turtle_controller", EntryPoint("spiral.node", "main"), ()),
            Program("pen_node", EntryPoint("spiral.pens", "main"), ()),
        )
    )
    assert (
        str(submission.found) == "launch/both.launch.py, which starts turtle_controller, pen_node"
    )
    assert submission.notes == ()
    assert "rclpy" in submission.imports.surely


def test_it_settles_what_to_start_where_no_script_has_the_usual_name(tmp_path: Path) -> None:
    files = {
        name: text.replace("turtle_controller", "drive")
        for name, text in (TWO | {"launch/both.launch.py": BOTH}).items()
    }
    start = opened(lay(tmp_path, files)).start
    assert isinstance(start, Launch)
    assert [program.name for program in start.programs] == ["drive", "pen_node"]


def test_who_asks_for_one_program_gets_that_alone(tmp_path: Path) -> None:
    submission = opened(lay(tmp_path, TWO | {"launch/both.launch.py": BOTH}), "pen_node")
    assert submission.start == EntryPoint("spiral.pens", "main")
    assert str(submission.remarks[-1]) == (
        "launch/both.launch.py was evaluated and not run: pen_node was started by itself, "
        "without turtle_controller"
    )


def test_the_simulator_is_there_already_and_other_programs_are_told(tmp_path: Path) -> None:
    simulator = "Node(package='turtlesim', executable='turtlesim_node')"
    other = "Node(package='rqt_graph', executable='rqt_graph')"
    text = LIST.format(f"{simulator}, {DRIVE}, {other}, {PENS}")
    submission = opened(lay(tmp_path, TWO | {"launch/all_launch.py": text}))
    assert tuple(map(str, submission.notes)) == (
        "launch/all_launch.py starts programs of other packages, and these were not: "
        "rqt_graph rqt_graph",
    )


@pytest.mark.parametrize(
    ("text", "note"),
    [
        (
            LIST.format("nothing(), " + DRIVE),
            "launch/a.launch.py was not run, and what it starts cannot be read (NameError: name "
            "'nothing' is not defined): judged is turtle_controller alone",
        ),
        (
            LIST.format(DRIVE.replace(")", ", namespace='left')")),
            "launch/a.launch.py was evaluated and not run: turtle_controller was started by "
            "itself, without its namespace",
        ),
        (LIST.format(DRIVE.replace(")", ", name='me')")), "another console script"),
    ],
)
def test_a_launch_file_that_is_not_run_is_told_where_it_matters(
    tmp_path: Path, text: str, note: str
) -> None:
    submission = opened(lay(tmp_path, TWO | {"launch/a.launch.py": text}))
    assert submission.start == EntryPoint("spiral.node", "main")
    assert any(str(remark).startswith(note) for remark in submission.remarks)


def test_what_ros2_launch_would_not_find_is_told(tmp_path: Path) -> None:
    other = LIST.format(DRIVE.replace("turtle_controller", "turtle_controller.py"))
    remarks = opened(lay(tmp_path, TWO | {"launch/a.launch.py": other})).remarks
    assert any("would not find launch/a.launch.py" in str(remark) for remark in remarks)
    assert any("starts turtle_controller.py, which setup.py" in str(remark) for remark in remarks)


def test_two_launch_files_that_differ_settle_nothing(tmp_path: Path) -> None:
    other = LIST.format(f"{PENS}, {DRIVE}")
    lay(tmp_path, TWO | {"launch/a.launch.py": BOTH, "launch/b.launch.py": other})
    assert opened(tmp_path).start == EntryPoint("spiral.node", "main")


def test_a_launch_file_from_somewhere_else_is_not_read(tmp_path: Path) -> None:
    lay(tmp_path / "spiral", TWO | {"launch/README": ""})
    (tmp_path / "bob.launch.py").write_text(BOTH)
    (tmp_path / "spiral/launch/a.launch.py").symlink_to("../../bob.launch.py")
    with pytest.raises(SubmissionError, match="a link to a place outside"):
        opened(tmp_path / "spiral")
