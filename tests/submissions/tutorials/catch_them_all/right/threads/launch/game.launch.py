from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, TimerAction
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node


def generate_launch_description():
    spawner = Node(
        package="turtle_game",
        executable="spawner",
        namespace="game",
        parameters=[{"pause": LaunchConfiguration("pause")}],
    )
    player = Node(package="turtle_game", executable="player", namespace="game")
    return LaunchDescription(
        [
            DeclareLaunchArgument("pause", default_value="2.0"),
            spawner,
            TimerAction(period=1.0, actions=[player]),
        ]
    )
