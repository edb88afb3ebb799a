from launch import LaunchDescription
from launch.actions import IncludeLaunchDescription, TimerAction
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch.substitutions import PathJoinSubstitution
from launch_ros.substitutions import FindPackageShare


def include(name):
    path = PathJoinSubstitution([FindPackageShare('talk_demo'), 'launch', name])
    return IncludeLaunchDescription(PythonLaunchDescriptionSource(path))


def generate_launch_description():
    return LaunchDescription([
        include('subscriber.launch.py'),
        TimerAction(period=1.0, actions=[include('publisher.launch.py')]),
    ])
