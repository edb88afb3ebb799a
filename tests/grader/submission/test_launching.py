"""A launch file that plainly starts several nodes of a package says what to start; none is run."""

from pathlib import Path

import pytest

from grader.errors import SubmissionError
from grader.submission.launch_files import Node, read_launch_file
from grader.submission.opening import EntryPoint, Launch, Submission, open_submission
from grader.submission.start import Program
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


def nodes(tmp_path: Path, text: str, name: str = "a.launch.py") -> tuple[Node, ...] | str:
    """What a launch file starts, or why that is not known."""
    (tmp_path / name).write_text(text)
    launch = read_launch_file(tmp_path / name)
    return launch.unread or launch.nodes


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
    ],
)
def test_what_a_node_is_given_becomes_the_arguments_of_ros(
    tmp_path: Path, node: str, arguments: tuple[str, ...]
) -> None:
    words = ("--ros-args", *arguments) if arguments else ()
    text = LIST.format(f"Node(package='p', executable='e'{node})")
    assert nodes(tmp_path, text) == (Node("p", "e", words),)


@pytest.mark.parametrize(
    "body",
    [
        f"    return LaunchDescription([{DRIVE}, {PENS}])\n",
        f"    a = {DRIVE}\n    b = {PENS}\n    return LaunchDescription([a, b])\n",
        f"    ld = LaunchDescription()\n    ld.add_action({DRIVE})\n    b = {PENS}\n"
        "    ld.add_action(b)\n    return ld\n",
        f"    d = LaunchDescription([{DRIVE}])\n    d.add_action({PENS})\n    return d\n",
        f"    '''Both.'''\n    both = [launch_ros.actions.{DRIVE}, {PENS}]\n"
        "    return LaunchDescription(initial_entities=both)\n",
    ],
)
def test_the_usual_ways_to_write_a_launch_file_are_read(tmp_path: Path, body: str) -> None:
    expected = (Node("spiral", "turtle_controller"), Node("spiral", "pen_node"))
    assert nodes(tmp_path, HEAD + body) == expected


@pytest.mark.parametrize(
    ("text", "why"),
    [
        (LIST.format("DeclareLaunchArgument('a'), " + DRIVE), "it holds DeclareLaunchArgument"),
        (LIST.format("ExecuteProcess(cmd=['ls'])"), "it holds ExecuteProcess beside nodes"),
        (LIST.format("Node(package=p(), executable='e')"), "the package of a node in line 7"),
        (LIST.format("Node(package='p', executable='e', parameters=[f])"), "are computed"),
        (LIST.format("Node(package='p', executable='e', parameters=['a.yaml'])"), "not written"),
        (LIST.format("Node(package='p', executable='e', condition=c)"), "has condition"),
        (LIST.format("Node(package='p', executable='e', **more)"), "has **"),
        (LIST.format("Node(package='p', executable='e', name='a b')"), "a name in it"),
        (LIST.format("*more()"), "something else beside nodes"),
        (HEAD + f"    if x:\n        return LaunchDescription([{DRIVE}])\n", "in line 7"),
        (HEAD + f"    a = {DRIVE}\n    a = {PENS}\n    return LaunchDescription([a])\n", "line 8"),
        (HEAD + "    return 1\n", "it returns no LaunchDescription"),
        ("x = 1\n", "no function generate_launch_description"),
        ("def generate(:\n", "it does not parse"),
    ],
)
def test_what_only_a_run_could_tell_makes_a_launch_file_unread(
    tmp_path: Path, text: str, why: str
) -> None:
    told = nodes(tmp_path, text)
    assert isinstance(told, str) and why in told


def test_a_launch_file_in_xml_is_read_too(tmp_path: Path) -> None:
    node = "<node pkg='p' exec='e' {}>{}</node>"
    inside = "<remap from='a' to='/b'/><param name='rate' value='2.5'/>"
    text = "<launch>" + node.format("name='n' output='screen'", inside) + "</launch>"
    words = ("--ros-args", "-r", "__node:=n", "-r", "a:=/b", "-p", "rate:=2.5")
    assert nodes(tmp_path, text, "a.launch.xml") == (Node("p", "e", words),)
    for unread in (
        "<launch><arg name='a'/></launch>",
        "<launch>" + node.format("if='$(var a)'", "") + "</launch>",
        "<launch><node pkg='$(env HOME)' exec='e'/></launch>",
        "<!DOCTYPE a [<!ENTITY b 'c'>]><launch/>",
        "<launch>",
    ):
        assert isinstance(nodes(tmp_path, unread, "a.launch.xml"), str)


def test_several_nodes_of_a_launch_file_are_started(tmp_path: Path) -> None:
    submission = opened(lay(tmp_path, TWO | {"launch/both.launch.py": BOTH}))
    assert submission.start == Launch(
        (
            Program("turtle_controller", EntryPoint("spiral.node", "main"), ()),
            Program("pen_node", EntryPoint("spiral.pens", "main"), ()),
        )
    )
    assert submission.found == "launch/both.launch.py, which starts turtle_controller, pen_node"
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
    assert submission.remarks[-1] == (
        "launch/both.launch.py was not run: judged is pen_node alone, without turtle_controller"
    )


def test_the_simulator_is_there_already_and_other_programs_are_told(tmp_path: Path) -> None:
    simulator = "Node(package='turtlesim', executable='turtlesim_node')"
    other = "Node(package='rqt_graph', executable='rqt_graph')"
    text = LIST.format(f"{simulator}, {DRIVE}, {other}, {PENS}")
    assert opened(lay(tmp_path, TWO | {"launch/all_launch.py": text})).notes == (
        "launch/all_launch.py starts programs of other packages, and these were not: "
        "rqt_graph rqt_graph",
    )


@pytest.mark.parametrize(
    ("text", "note"),
    [
        (
            LIST.format("DeclareLaunchArgument('a'), " + DRIVE),
            "launch/a.launch.py was not run, and what it starts cannot be read (it holds "
            "DeclareLaunchArgument beside nodes): judged is turtle_controller alone",
        ),
        (
            LIST.format(PENS.replace("pen_node", "pem_node") + ", " + DRIVE),
            "launch/a.launch.py was not run: judged is turtle_controller alone, without pem_node",
        ),
        (
            LIST.format(DRIVE.replace(")", ", namespace='left')")),
            "launch/a.launch.py was not run: turtle_controller was started without its namespace, "
            "remappings or parameters",
        ),
        (LIST.format(DRIVE.replace(")", ", name='me')")), "another console script"),
    ],
)
def test_a_launch_file_that_is_not_run_is_told_where_it_matters(
    tmp_path: Path, text: str, note: str
) -> None:
    submission = opened(lay(tmp_path, TWO | {"launch/a.launch.py": text}))
    assert submission.start == EntryPoint("spiral.node", "main")
    assert submission.remarks[-1].startswith(note)


def test_two_launch_files_that_differ_settle_nothing(tmp_path: Path) -> None:
    other = LIST.format(f"{DRIVE}, {PENS}, {PENS}")
    lay(tmp_path, TWO | {"launch/a.launch.py": BOTH, "launch/b.launch.py": other})
    assert opened(tmp_path).start == EntryPoint("spiral.node", "main")


def test_a_launch_file_from_somewhere_else_is_not_read(tmp_path: Path) -> None:
    lay(tmp_path / "spiral", TWO | {"launch/README": ""})
    (tmp_path / "bob.launch.py").write_text(BOTH)
    (tmp_path / "spiral/launch/a.launch.py").symlink_to("../../bob.launch.py")
    with pytest.raises(SubmissionError, match="a link to a place outside"):
        opened(tmp_path / "spiral")
