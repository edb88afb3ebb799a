"""Put the walker into an empty world of Gazebo."""

import os

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import IncludeLaunchDescription
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch.substitutions import Command
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue


def generate_launch_description():
    share = get_package_share_directory("walker_description")
    gazebo = get_package_share_directory("ros_gz_sim")
    model = os.path.join(share, "urdf", "walker.urdf.xacro")
    return LaunchDescription(
        [
            IncludeLaunchDescription(
                PythonLaunchDescriptionSource(os.path.join(gazebo, "launch", "gz_sim.launch.py")),
                launch_arguments={"gz_args": "-r empty.sdf"}.items(),
            ),
            Node(
                package="robot_state_publisher",
                executable="robot_state_publisher",
                parameters=[
                    {
                        "robot_description": ParameterValue(
                            Command(["xacro ", model]), value_type=str
                        ),
                        "use_sim_time": True,
                    }
                ],
            ),
            Node(
                package="ros_gz_sim",
                executable="create",
                arguments=["-topic", "robot_description", "-name", "walker", "-z", "0.3"],
            ),
        ]
    )
