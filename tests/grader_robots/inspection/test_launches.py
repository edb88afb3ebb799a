"""Launch files are taken as ROS takes them, and what they start is taken down."""

import textwrap
from collections.abc import Iterable, Mapping
from pathlib import Path

import pytest
import yaml

from grader.submission.package_trace import LaunchFile, PackageTrace
from tests.grader_robots.packages import looked_at, written

FILE = "launch/display.launch.py"
CASES = yaml.safe_load(Path(__file__).with_name("launches.yaml").read_text(encoding="utf-8"))
HEAD = """
from launch import LaunchDescription
from launch.actions import *
from launch.conditions import *
from launch.substitutions import *
from launch_ros.actions import *
from launch_ros.substitutions import *
"""


def launched(folder, body: str, file: str = FILE) -> LaunchFile:
    return traced(folder, {file: body}).launches[0]


def traced(folder, bodies: Mapping[str, str]) -> PackageTrace:
    """A package with these launch files and no others, which are told in the order of names."""
    files = dict.fromkeys((FILE, "launch/spawn.launch.py"))
    for file, body in bodies.items():
        if file.endswith(".py"):
            inner = textwrap.indent(textwrap.dedent(body).strip(), "    ")
            body = f"{HEAD}\ndef generate_launch_description():\n{inner}\n"
        files[file] = body
    return looked_at(written(folder, files))


def started(folder, body: str, file: str = FILE) -> LaunchFile:
    """A launch file that comes to its end."""
    launch = launched(folder, body, file)
    assert launch.problem is None
    return launch


def each_launched(folder, bodies: Iterable[str], kind: str = "py") -> tuple[LaunchFile, ...]:
    names = (f"launch/a{number:02}.launch.{kind}" for number in range(40))
    return traced(folder, dict(zip(names, bodies, strict=False))).launches


@pytest.mark.parametrize(
    ("cases", "body", "kind"),
    [
        ("refused", "return LaunchDescription([{}])", "py"),
        ("xml", "<launch>{}</launch>", "xml"),
        ("yaml", "{}", "yaml"),
    ],
)
def test_what_the_original_refuses_is_refused(cases, body, kind, tmp_path):
    refused = CASES[cases]
    found = each_launched(tmp_path, map(body.format, refused), kind)
    for launch, (action, says) in zip(found, refused.items(), strict=True):
        assert launch.problem is not None and launch.problem.kind == "error", action
        assert says in str(launch.problem.text)


def test_how_a_launch_file_ends_is_told_apart(tmp_path):
    found = each_launched(tmp_path, [end["body"] for end in CASES["ends"]])
    for launch, end in zip(found, CASES["ends"], strict=True):
        problem = launch.problem
        assert problem is not None
        assert (problem.kind, end["says"] in str(problem.text)) == (end["kind"], True), problem


def test_conditions_groups_and_includes_are_followed(tmp_path):
    launch = started(
        tmp_path,
        """
        go = LaunchConfiguration('go')
        rviz = dict(package='rviz2', executable='rviz2')
        return LaunchDescription([
            DeclareLaunchArgument('go', default_value='True'),
            GroupAction([SetLaunchConfiguration('go', '0'), PushRosNamespace('in'),
                         Node(name='no', condition=IfCondition(go), **rviz),
                         Node(name='group', condition=UnlessCondition(go), **rviz)]),
            Node(name='yes', condition=IfCondition(go), **rviz),
            OpaqueFunction(function=lambda context: [Node(name=go.perform(context), **rviz)]),
            RegisterEventHandler(__import__('launch').event_handlers.OnProcessExit(
                on_exit=[Node(name='after', **rviz)])),
            ExecuteProcess(cmd=['ros2', 'topic', 'list']),
        ])
        """,
    )
    told = [(node.name, node.namespace, node.later) for node in launch.nodes]
    assert told == [
        ("group", "in", False),
        ("yes", "", False),
        ("True", "", False),
        ("after", "", True),
    ]
    assert launch.processes == ("ros2 topic list",)
    assert launch.declared == ("go",)


def test_the_environment_is_appended_to_or_prepended_with_any_separator(tmp_path):
    launch = started(
        tmp_path,
        """
        def told(name):
            return Node(package='rviz2', executable='rviz2', arguments=[EnvironmentVariable(name)])
        return LaunchDescription([
            AppendEnvironmentVariable('A', 'a'), AppendEnvironmentVariable('A', 'b'),
            AppendEnvironmentVariable('A', 'c', prepend=True),
            AppendEnvironmentVariable('A', 'd', True, TextSubstitution(text='-')), told('A'),
            SetEnvironmentVariable('B', ''), AppendEnvironmentVariable('B', 'b', separator=','),
            told('B')])
        """,
    )
    assert [node.arguments for node in launch.nodes] == [("d-c:a:b",), (",b",)]
    in_xml = launched(
        tmp_path / "xml",
        """<launch>
        <append_env name="A" value="a"/>
        <append_env name="A" value="b" prepend="true" separator="-"/>
        <node pkg="rviz2" exec="rviz2" args="$(env A)"/>
        </launch>""",
        "launch/display.launch.xml",
    )
    assert [node.arguments for node in in_xml.nodes] == [("b-a",)]


def test_values_of_parameters_go_through_yaml_where_the_original_does_so(tmp_path):
    launch = launched(
        tmp_path,
        """
        text = TextSubstitution
        return LaunchDescription([Node(package='rviz2', executable='rviz2', parameters=[{
            'a': text(text='false'), 'b': 'false', 'c': [1, 2], 'd': {'e': 1.5}}])])
        """,
    )
    values = {each.name: each.value for each in launch.nodes[0].parameters}
    assert values == {"a": "false", "b": "false", "c": "[1, 2]", "d.e": "1.5"}
    fragile = launched(
        tmp_path / "more",
        """
        text = TextSubstitution(text='<a> <!-- b: c --> </a>: {')
        return LaunchDescription([Node(package='rviz2', executable='rviz2',
                                       parameters=[{'a': text}])])
        """,
    )
    assert fragile.problem is not None and "as yaml" in str(fragile.problem.text)


IN_XML = """<launch>
<arg name="rviz" default="true"/>
<let name="file" value="$(find-pkg-share rviz2)/a.rviz"/>
<group if="$(var rviz)">
  <push_ros_namespace namespace="in"/>
  <node pkg="rviz2" exec="rviz2" name="$(var rviz)" args="-d $(var file) --x">
    <param name="a" value="1.5"/><param name="b" value="1" type="str"/>
    <remap from="c" to="d"/>
  </node>
</group>
<include file="$(find-pkg-share gazebo_ros)/launch/gazebo.launch.py">
  <arg name="pause" value="true"/>
</include>
</launch>"""
IN_YAML = """launch:
  - arg: {name: rviz, default: "true"}
  - group:
      - push_ros_namespace: {namespace: in}
      - node:
          if: $(var rviz)
          pkg: rviz2
          exec: rviz2
          name: $(var rviz)
          args: -d $(find-pkg-share rviz2)/a.rviz --x
          param: [{name: a, value: 1.5}, {name: b, value: [1, 2]}, {name: c, value: true}]
          remap: [{from: c, to: d}]
  - include:
      file: $(find-pkg-share gazebo_ros)/launch/gazebo.launch.py
      arg: [{name: pause, value: "true"}]
"""


@pytest.mark.parametrize(
    ("kind", "body", "values"),
    [
        ("xml", IN_XML, {"a": "1.5", "b": "1"}),
        ("yaml", IN_YAML, {"a": "1.5", "b": "[1, 2]", "c": "true"}),
    ],
)
def test_a_launch_file_in_xml_or_yaml_starts_what_it_says(kind, body, values, tmp_path):
    launch = started(tmp_path, body, f"launch/display.launch.{kind}")
    (node,) = launch.nodes
    assert (node.name, node.namespace, node.remappings) == ("true", "in", ("c:=d",))
    assert node.arguments == ("-d", "/opt/ros/jazzy/share/rviz2/a.rviz", "--x")
    assert {each.name: each.value for each in node.parameters} == values
    include = launch.includes[0]
    assert (include.package, include.arguments) == ("gazebo_ros", ("pause:=true",))


def test_a_package_that_is_asked_for_has_a_folder_of_its_own(tmp_path):
    body = """
    import os
    from ament_index_python.packages import get_package_prefix, get_package_share_directory
    shares = [get_package_prefix("rviz2") + "/share/rviz2", get_package_share_directory("xacro")]
    found = [os.path.basename(os.path.realpath(each)) for each in shares if os.path.isdir(each)]
    return LaunchDescription([Node(package="rviz2", executable="rviz2", arguments=found)])
    """
    launch = started(tmp_path, body)
    assert launch.nodes[0].arguments == ("rviz2", "xacro")


def test_a_node_that_starts_later_is_said_in_its_own_launch_file(tmp_path):
    file = "launch/display.launch.xml"
    node = "<node pkg='rviz2' exec='rviz2'/>"
    launch = started(tmp_path, f"<launch><timer period='1.0'>{node}</timer></launch>", file)
    assert [each.file for each in launch.nodes] == [file]
