"""Arguments with defaults and choices, conditions, expressions, the environment."""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, LogInfo, SetLaunchConfiguration
from launch.conditions import IfCondition, LaunchConfigurationEquals, UnlessCondition
from launch.substitutions import (
    EnvironmentVariable,
    LaunchConfiguration,
    PathJoinSubstitution,
    PythonExpression,
    TextSubstitution,
)
from launch_ros.actions import Node
from launch_ros.substitutions import FindPackageShare


def generate_launch_description():
    rate = LaunchConfiguration("rate")
    return LaunchDescription(
        [
            DeclareLaunchArgument("rate", default_value="4", description="[Hz]"),
            DeclareLaunchArgument("quiet", default_value="false"),
            DeclareLaunchArgument("mode", default_value="fast", choices=["fast", "slow"]),
            SetLaunchConfiguration("prefix", ["node_", LaunchConfiguration("mode")]),
            LogInfo(msg=["rate ", rate]),
            Node(
                package="demo",
                executable="talker",
                name=LaunchConfiguration("prefix"),
                namespace=EnvironmentVariable("NOBODY_SETS_THIS", default_value="robot"),
                parameters=[
                    {"rate": rate, "twice": PythonExpression([rate, " * 2"])},
                    PathJoinSubstitution([FindPackageShare("demo"), "config", "params.yaml"]),
                ],
                condition=UnlessCondition(LaunchConfiguration("quiet")),
            ),
            Node(
                package="demo",
                executable="worker",
                condition=IfCondition(PythonExpression(["'", rate, "' == '9'"])),
            ),
            Node(
                package="demo",
                executable="listener",
                arguments=["--rate", rate, [TextSubstitution(text="at_"), rate]],
                condition=LaunchConfigurationEquals("mode", "fast"),
            ),
        ]
    )
