from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, GroupAction, LogInfo
from launch.conditions import IfCondition, UnlessCondition
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node


def generate_launch_description():
    one_process = LaunchConfiguration("one_process")

    def node(executable, condition=None):
        return Node(package="pubsub", executable=executable, condition=condition, emulate_tty=True)

    return LaunchDescription(
        [
            DeclareLaunchArgument(
                "one_process", default_value="false", description="Both nodes in one process?"
            ),
            LogInfo(msg="Starting publisher and subscriber"),
            node("both", IfCondition(one_process)),
            GroupAction(
                [node("minimal_publisher"), node("minimal_subscriber")],
                condition=UnlessCondition(one_process),
            ),
        ]
    )
