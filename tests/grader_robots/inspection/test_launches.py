"""Launch files are taken as ROS takes them, and what they start is taken down."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Mapping

from grader.inspection.trace import LaunchFile, PackageTrace
from tests.grader_robots.packages import looked_at, written

FILE = "launch/display.launch.py"
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


def each_launched(folder, bodies: Iterable[str], kind: str = "py") -> tuple[LaunchFile, ...]:
    names = (f"launch/a{number:02}.launch.{kind}" for number in range(40))
    return traced(folder, dict(zip(names, bodies, strict=False))).launches


REFUSED = [
    ("Node('rviz2', 'rviz2')", "takes 1 positional argument"),
    ("Node(package='rviz2')", "missing 1 required keyword-only argument: 'executable'"),
    ("Node(package='rviz2', executable='rviz2', node_name='a')", "unexpected keyword"),
    ("Node(package='rviz2', executable='rviz2', parameters={})", "Expected 'parameters'"),
    ("Node(package='rviz2', executable='rviz2', arguments='-d a')", "a list of arguments"),
    ("Node(package='rviz2', executable='rviz2', remappings=['a'])", "two-tuples"),
    ("Node(package='rviz2', executable='rviz2', parameters=[{'a': None}])", "Allowed value"),
    ("Node(package=2, executable='rviz2')", "Failed to normalize"),
    ("TimerAction(2.0, [])", "positional argument"),
    ("IncludeLaunchDescription('a', arguments={})", "unexpected keyword"),
    ("DeclareLaunchArgument('a', default='b')", "unexpected keyword"),
    ("AppendEnvironmentVariable('A', 'a', prepend='at')", "Failed to convert 'at' to bool"),
    ("DeclareLaunchArgument('a', default_value='b', choices=['c'])", "is not in provided"),
    ("LogInfo(msg=LaunchConfiguration('none'))", "'none' does not exist"),
    ("LogInfo(msg='a', condition=IfCondition('yes'))", "invalid condition expression 'yes'"),
    ("LogInfo(msg=EnvironmentVariable('NOWHERE'))", "'NOWHERE' does not exist"),
    ("'rviz2'", "expected an action"),
    ("LogInfo(msg=Command('false'))", "executed command failed"),
    ("LogInfo(msg=Command(['xacro', '/a']))", "file not found"),
]


def test_what_the_original_refuses_is_refused(tmp_path):
    bodies = [f"return LaunchDescription([{action}])" for action, _ in REFUSED]
    for launch, (action, says) in zip(each_launched(tmp_path, bodies), REFUSED, strict=True):
        assert launch.problem is not None and launch.problem.kind == "error", action
        assert says in str(launch.problem.text)


ENDS = [
    ("import launch\nlaunch.Wonder", "unknown", "launch.Wonder"),
    ("from launch.actions import Wonder", "unknown", "launch.actions.Wonder"),
    ("import launch_ros.wonder", "unknown", "launch_ros.wonder"),
    ("import launch_testing", "unknown", "launch_testing"),
    ("import nav2_common.launch as n; n.Rewritten.made", "unknown", "nav2_common.launch.Rewri"),
    ("import moveit_configs_utils as m; m.A('a').made()", "unknown", "moveit_configs_utils.A"),
    ("return LaunchDescription([LogInfo(msg=Command('gzz p'))])", "unknown", "it runs gzz"),
    ("import os; os.environ['ROBOT']", "unknown", "environment variable ROBOT"),
    ("import numpyy", "error", "No module named 'numpyy'"),
    ("import os; os._exit(3)", "limit", "ended the process that it ran in (exit code 3)"),
    ("raise SystemExit", "error", "SystemExit"),
    ("return None", "error", "returned NoneType; expected a LaunchDescription"),
    (
        "return LaunchDescription([DeclareLaunchArgument('a')])",
        "argument",
        'Required launch argument "a"',
    ),
]


def test_how_a_launch_file_ends_is_told_apart(tmp_path):
    found = each_launched(tmp_path, [body for body, *_ in ENDS])
    for launch, (_, kind, says) in zip(found, ENDS, strict=True):
        problem = launch.problem
        assert problem is not None
        assert (problem.kind, says in str(problem.text)) == (kind, True), problem


def test_conditions_groups_and_includes_are_followed(tmp_path):
    launch = launched(
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
    assert launch.problem is None
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
    launch = launched(
        tmp_path,
        """
        def told(name):
            return Node(package='rviz2', executable='rviz2', arguments=[EnvironmentVariable(name)])
        return LaunchDescription([
            AppendEnvironmentVariable('A', 'a'), AppendEnvironmentVariable('A', 'b'),
            AppendEnvironmentVariable('A', 'c', prepend='yes'),
            AppendEnvironmentVariable('A', 'd', True, TextSubstitution(text='-')), told('A'),
            SetEnvironmentVariable('B', ''), AppendEnvironmentVariable('B', 'b', separator=','),
            told('B')])
        """,
    )
    assert launch.problem is None
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


NO_XML = [
    ("<node pkg='rviz2'/>", "Attribute 'exec' of Entity 'node' not found"),
    ("<node package='rviz2' exec='rviz2'/>", "Attribute 'pkg'"),
    ("<node pkg='rviz2' exec='rviz2' typ='a'/>", "Unexpected attribute(s)"),
    ("<node pkg='rviz2' exec='$(find rviz2)'/>", "Unknown substitution: find"),
    ("<node pkg='rviz2' exec='$(arg a)'/>", "Unknown substitution: arg"),
    ("<param name='robot_description' value='a'/>", "Unrecognized entity of the type: param"),
    ("<node", "ParseError"),
    ("<arg name='a'/><let name='b'/>", "Attribute 'value'"),
    ("<set_env name='a' value='b' prepend='true'/>", "Unexpected attribute(s)"),
]


def test_a_launch_file_in_xml_is_refused_where_the_original_does_so(tmp_path):
    bodies = [f"<launch>{element}</launch>" for element, _ in NO_XML]
    for launch, (_, says) in zip(each_launched(tmp_path, bodies, "xml"), NO_XML, strict=True):
        assert launch.problem is not None
        assert says in str(launch.problem.text)


def test_a_launch_file_in_xml_starts_what_it_says(tmp_path):
    launch = launched(
        tmp_path,
        """<launch>
        <arg name="rviz" default="true"/>
        <let name="file" value="$(find-pkg-share rviz2)/a.rviz"/>
        <group if="$(var rviz)">
          <push_ros_namespace namespace="in"/>
          <node pkg="rviz2" exec="rviz2" name="$(var rviz)" args="-d '$(var file)' --x">
            <param name="a" value="1.5"/><param name="b" value="1" type="str"/>
            <remap from="c" to="d"/>
          </node>
        </group>
        <include file="$(find-pkg-share gazebo_ros)/launch/gazebo.launch.py">
          <arg name="pause" value="true"/>
        </include>
        </launch>""",
        "launch/display.launch.xml",
    )
    assert launch.problem is None
    node = launch.nodes[0]
    assert (node.name, node.namespace, node.remappings) == ("true", "in", ("c:=d",))
    assert node.arguments == ("-d", "/opt/ros/jazzy/share/rviz2/a.rviz", "--x")
    assert [each.value for each in node.parameters] == ["1.5", "1"]
    include = launch.includes[0]
    assert (include.package, include.arguments) == ("gazebo_ros", ("pause:=true",))


def test_a_launch_file_in_yaml_starts_what_one_in_xml_does(tmp_path):
    launch = launched(
        tmp_path,
        """
        launch:
          - arg: {name: rviz, default: "true"}
          - group:
              - push_ros_namespace: {namespace: in}
              - node:
                  if: $(var rviz)
                  pkg: rviz2
                  exec: rviz2
                  args: -d $(find-pkg-share rviz2)/a.rviz
                  param: [{name: a, value: 1.5}, {name: b, value: [1, 2]}, {name: c, value: true}]
                  remap: [{from: c, to: d}]
          - include:
              file: $(find-pkg-share gazebo_ros)/launch/gazebo.launch.py
              arg: [{name: pause, value: "true"}]
        """,
        "launch/display.launch.yaml",
    )
    assert launch.problem is None
    (node,) = launch.nodes
    assert (node.namespace, node.remappings) == ("in", ("c:=d",))
    assert node.arguments == ("-d", "/opt/ros/jazzy/share/rviz2/a.rviz")
    values = {each.name: each.value for each in node.parameters}
    assert values == {"a": "1.5", "b": "[1, 2]", "c": "true"}
    assert launch.includes[0].arguments == ("pause:=true",)


NO_YAML = [
    ("- node: {}", "expected 'launch' as the one root, found list"),
    ("launch: {node: {}}", "expected a list of entities"),
    ("launch: [node]", "expected one entity in each entry"),
    ("launch: [{node: {pkg: rviz2}}]", "Attribute 'exec' of Entity 'node' not found"),
    ("launch: [", "ParserError"),
]


def test_a_launch_file_in_yaml_is_refused_where_it_is_none(tmp_path):
    found = each_launched(tmp_path, [text for text, _ in NO_YAML], "yaml")
    for launch, (_, says) in zip(found, NO_YAML, strict=True):
        assert launch.problem is not None and launch.problem.kind == "error"
        assert says in str(launch.problem.text)


def test_a_package_that_is_asked_for_has_a_folder_of_its_own(tmp_path):
    body = """
    import os
    from ament_index_python.packages import get_package_prefix, get_package_share_directory
    shares = [get_package_prefix("rviz2") + "/share/rviz2", get_package_share_directory("xacro")]
    found = [os.path.basename(os.path.realpath(each)) for each in shares if os.path.isdir(each)]
    return LaunchDescription([Node(package="rviz2", executable="rviz2", arguments=found)])
    """
    launch = launched(tmp_path, body)
    assert launch.problem is None
    assert launch.nodes[0].arguments == ("rviz2", "xacro")
