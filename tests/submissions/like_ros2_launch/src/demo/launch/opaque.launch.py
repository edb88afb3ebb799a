"""As many nodes as an argument says, made by a function; what is set for all of them."""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, GroupAction, OpaqueFunction, TimerAction
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node, PushROSNamespace, SetParameter, SetParametersFromFile, SetRemap
from launch_ros.substitutions import FindPackageShare


def robots(context):
    number = int(LaunchConfiguration("number").perform(context))
    return [
        Node(package="demo", executable="talker", namespace=f"robot_{n}", parameters=[{"id": n}])
        for n in range(number)
    ]


def generate_launch_description():
    return LaunchDescription(
        [
            DeclareLaunchArgument("number", default_value="2"),
            SetParameter("use_sim_time", True),
            OpaqueFunction(function=robots),
            GroupAction(
                [
                    PushROSNamespace("left"),
                    SetRemap("chatter", "/all"),
                    SetParametersFromFile([FindPackageShare("demo"), "/config/params.yaml"]),
                    Node(
                        package="demo", executable="listener", parameters=[{"use_sim_time": False}]
                    ),
                    GroupAction(
                        [PushROSNamespace("arm"), Node(package="demo", executable="listener")]
                    ),
                    TimerAction(
                        period=0.3, actions=[Node(package="demo", executable="worker", name="w")]
                    ),
                ]
            ),
            Node(package="demo", executable="listener", namespace="/right"),
        ]
    )
