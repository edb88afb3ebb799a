"""What is started again when it ends, and a script that is started by its path."""

import os

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import ExecuteProcess, RegisterEventHandler
from launch.event_handlers import OnProcessExit
from launch_ros.actions import Node


def generate_launch_description():
    script = os.path.join(get_package_share_directory("demo"), "scripts", "prepare.py")
    prepare = ExecuteProcess(cmd=["python3", script, "--map", "house"], output="screen")
    return LaunchDescription(
        [
            prepare,
            Node(
                package="demo",
                executable="worker",
                respawn=True,
                respawn_delay=0.5,
                respawn_max_retries=2,
            ),
            RegisterEventHandler(
                OnProcessExit(
                    target_action=prepare,
                    on_exit=Node(package="demo", executable="listener", on_exit=[]),
                )
            ),
            ExecuteProcess(
                cmd=["ros2", "run", "demo", "talker", "--ros-args", "-r", "__node:=by_run"]
            ),
        ]
    )
