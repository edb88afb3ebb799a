"""What the grader does not start: composed and lifecycle nodes; and what it does beside them."""

from launch import LaunchDescription
from launch.actions import SetEnvironmentVariable
from launch_ros.actions import ComposableNodeContainer, LifecycleNode, Node
from launch_ros.descriptions import ComposableNode


def generate_launch_description():
    return LaunchDescription(
        [
            SetEnvironmentVariable("RCUTILS_COLORIZED_OUTPUT", "1"),
            ComposableNodeContainer(
                name="container",
                namespace="",
                package="rclcpp_components",
                executable="component_container",
                composable_node_descriptions=[
                    ComposableNode(package="composition", plugin="composition::Talker", name="t")
                ],
            ),
            LifecycleNode(package="demo", executable="talker", name="managed", namespace=""),
            Node(package="demo", executable="listener", additional_env={"LEVEL": "2"}),
            Node(package="demo", executable="worker", prefix="nice"),
        ]
    )
