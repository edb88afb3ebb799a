"""What is of other packages is told apart: known, unknown, and ours under a wrong name."""

from grader.submission.package_trace import Include
from tests.grader_robots.inspection.test_launches import each_launched, started

MODEL = "walker.urdf.xacro"


def test_an_action_of_another_package_is_taken_down_as_what_it_is(tmp_path):
    launch = started(
        tmp_path,
        """
        from ros_gz_sim.actions import GzServer
        return LaunchDescription([
            GzServer(world_sdf_file='a'),
            GzServer(condition=IfCondition('false'), container_name='b'),
            Node(package='rviz2', executable='rviz2'),
        ])
        """,
    )
    assert launch.includes == (Include("ros_gz_sim", "actions.GzServer()", ()),)
    assert len(launch.nodes) == 1


def test_launch_files_of_urdf_tutorial_start_what_they_start(tmp_path):
    launch = started(
        tmp_path,
        f"""
        own = FindPackageShare('walker_description')
        return LaunchDescription([IncludeLaunchDescription(
            [FindPackageShare('urdf_tutorial'), '/launch/display.launch.py'],
            launch_arguments={{'model': PathJoinSubstitution([own, 'urdf', '{MODEL}'])}}.items())])
        """,
    )
    names = [node.executable for node in launch.nodes]
    assert names == ["robot_state_publisher", "joint_state_publisher_gui", "rviz2"]
    assert launch.nodes[2].arguments[0] == "-d"


def test_a_package_that_nobody_knows_is_used_and_not_lacking(tmp_path):
    launch = started(
        tmp_path,
        """
        share = FindPackageShare('some_lidar')
        return LaunchDescription([
            Node(package='some_planner', executable='plan'),
            IncludeLaunchDescription([share, '/launch/scan.launch.py']),
        ])
        """,
    )
    assert launch.lacking == ()
    assert {"some_planner", "some_lidar"} <= set(launch.packages)
    assert launch.includes[0] == Include("some_lidar", "launch/scan.launch.py", ())


def test_a_package_of_which_our_files_are_asked_for_is_a_wrong_name(tmp_path):
    asked = (
        f"LogInfo(msg=Command(['xacro ', FindPackageShare('strider'), '/urdf/{MODEL}']))",
        "Node(package='walker_descripton', executable='walk')",
    )
    found = each_launched(tmp_path, [f"return LaunchDescription([{each}])" for each in asked])
    for launch, name in zip(found, ("strider", "walker_descripton"), strict=True):
        assert launch.problem is None
        assert [(each.kind, each.name) for each in launch.lacking][:1] == [("package", name)]


def test_what_a_running_system_would_answer_is_left_open(tmp_path):
    launch = started(
        tmp_path,
        """
        asked = Command('ros2 param get --hide-type /robot_state_publisher robot_description')
        share = Command('ros2 pkg prefix --share walker_description')
        return LaunchDescription([
            Node(package='controller_manager', executable='ros2_control_node',
                 parameters=[{'robot_description': asked, 'share': share}])])
        """,
    )
    assert any("asks a running system" in str(remark) for remark in launch.remarks)
    values = {each.name: each.value for each in launch.nodes[0].parameters}
    assert values["share"] == "/prefix/share/walker_description"


def test_an_argument_without_a_default_takes_the_first_of_its_choices(tmp_path):
    launch = started(
        tmp_path,
        """
        return LaunchDescription([
            DeclareLaunchArgument('kind', choices=['small', 'large']),
            Node(package='rviz2', executable='rviz2', name=LaunchConfiguration('kind'))])
        """,
    )
    assert launch.nodes[0].name == "small"
    assert "its argument kind has no default" in str(launch.remarks[0])


def test_a_path_below_the_home_folder_is_told_as_one(tmp_path):
    launch = started(
        tmp_path,
        """
        import os
        path = os.path.join(os.path.expanduser('~'), 'ros2_ws/src/a/urdf/walker.urdf.xacro')
        return LaunchDescription([LogInfo(msg=Command(['xacro ', path]))])
        """,
    )
    assert launch.lacking[0].name == "~/ros2_ws/src/a/urdf/walker.urdf.xacro"
