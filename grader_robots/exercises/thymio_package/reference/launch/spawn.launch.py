from ament_index_python.packages import get_package_share_path
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, IncludeLaunchDescription
from launch.substitutions import Command, LaunchConfiguration
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue


def generate_launch_description():
    share = get_package_share_path("thymio_description")
    model_arg = DeclareLaunchArgument("model", default_value=str(share / "urdf/thymio.urdf.xacro"))
    description = ParameterValue(Command(["xacro ", LaunchConfiguration("model")]), value_type=str)
    gazebo = get_package_share_path("ros_gz_sim") / "launch/gz_sim.launch.py"
    return LaunchDescription(
        [
            model_arg,
            IncludeLaunchDescription(str(gazebo), launch_arguments=[("gz_args", "empty.sdf")]),
            Node(
                package="robot_state_publisher",
                executable="robot_state_publisher",
                parameters=[{"robot_description": description}],
            ),
            Node(
                package="ros_gz_sim",
                executable="create",
                arguments=["-topic", "/robot_description", "-name", "thymio", "-z", "0.01"],
            ),
        ]
    )
