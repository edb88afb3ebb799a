import os

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import IncludeLaunchDescription, SetEnvironmentVariable
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch_ros.actions import Node


def generate_launch_description():
    share = get_package_share_directory('arm_description')
    gazebo = get_package_share_directory('gazebo_ros')
    with open(os.path.join(share, 'urdf', 'arm.urdf'), 'r') as infp:
        robot_desc = infp.read()

    return LaunchDescription([
        SetEnvironmentVariable('GAZEBO_MODEL_PATH', os.path.join(share, '..')),
        IncludeLaunchDescription(
            PythonLaunchDescriptionSource(os.path.join(gazebo, 'launch', 'gazebo.launch.py')),
            launch_arguments={'pause': 'true'}.items()),
        Node(
            package='robot_state_publisher',
            executable='robot_state_publisher',
            parameters=[{'use_sim_time': True, 'robot_description': robot_desc}]),
        Node(
            package='gazebo_ros',
            executable='spawn_entity.py',
            arguments=['-entity', 'arm', '-topic', 'robot_description', '-x', '0', '-z', '0.5'],
            output='screen'),
    ])
