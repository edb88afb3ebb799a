import os

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch_ros.actions import Node


def generate_launch_description():
    urdf_file = os.path.join(get_package_share_directory('arm_description'), 'urdf', 'arm.urdf')
    rviz_config = os.path.join(get_package_share_directory('arm_description'), 'rviz', 'arm.rviz')
    with open(urdf_file, 'r') as infp:
        robot_desc = infp.read()

    return LaunchDescription([
        Node(
            package='robot_state_publisher',
            executable='robot_state_publisher',
            output='screen',
            parameters=[{'robot_description': robot_desc}],
            arguments=[urdf_file]),
        Node(
            package='joint_state_publisher_gui',
            executable='joint_state_publisher_gui',
            arguments=[urdf_file]),
        Node(
            package='rviz2',
            executable='rviz2',
            arguments=['-d', rviz_config]),
    ])
