"""Packages of others that launch files make use of, with what of them is known.

`PROGRAMS`: package -> its programs, of those where a wrong name can be told. `FILES`: files in
their share folders that are looked for. `DESKTOP`: what every desktop installation of ROS 2 has;
nobody notices where it is not declared. `SIMULATORS`: packages that put a model into a world.

Of two packages it is known what their launch files start. A module that nobody has here, such as
`ros_gz_sim.actions`, stands for itself: what is made with it is an action of which only the package
is known. Whatever else it is used for ends in `NotKnown`.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from importlib.abc import Loader
from importlib.machinery import ModuleSpec
from types import ModuleType
from typing import Any, Final

from ros_doubles import OfAnother

PROGRAMS: Final[dict[str, tuple[str, ...]]] = {
    "robot_state_publisher": ("robot_state_publisher",),
    "joint_state_publisher": ("joint_state_publisher",),
    "joint_state_publisher_gui": ("joint_state_publisher_gui",),
    "rviz2": ("rviz2",),
    "tf2_ros": (
        *("static_transform_publisher", "tf2_echo", "tf2_monitor", "buffer_server"),
        *("tf2_echo_main", "buffer_server_main"),
    ),
    "gazebo_ros": ("spawn_entity.py",),
    "ros_gz_sim": ("create", "remove", "gzserver"),
    "ros_gz_bridge": ("parameter_bridge", "static_bridge", "bridge_node"),
    "controller_manager": ("ros2_control_node", "spawner", "unspawner", "hardware_spawner"),
    "xacro": ("xacro",),
}
FILES: Final[dict[str, tuple[str, ...]]] = {
    "gazebo_ros": (
        "launch/gazebo.launch.py",
        "launch/gzserver.launch.py",
        "launch/gzclient.launch.py",
        "launch/spawn_entity_demo.launch.py",
    ),
    "ros_gz_sim": (
        "launch/gz_sim.launch.py",
        "launch/gz_server.launch.py",
        "launch/gz_spawn_model.launch.py",
        "launch/ros_gz_sim.launch.py",
    ),
    "ros_gz_bridge": ("launch/ros_gz_bridge.launch.py",),
    "urdf_launch": ("launch/display.launch.py", "launch/description.launch.py"),
    "urdf_tutorial": ("launch/display.launch.py",),
}
#: ros-jazzy-desktop and what it brings along.
DESKTOP: Final = frozenset(
    (
        *("robot_state_publisher", "rviz2", "rviz_common", "rviz_default_plugins", "urdf"),
        *("tf2", "tf2_ros", "tf2_py", "tf2_msgs", "tf2_tools", "tf2_geometry_msgs", "kdl_parser"),
        *("launch", "launch_ros", "launch_xml", "launch_yaml", "ros2launch", "ros2run"),
        *("ament_index_python", "ament_cmake", "ament_python", "rclpy", "rclcpp", "rcl_interfaces"),
        *("std_msgs", "sensor_msgs", "geometry_msgs", "nav_msgs", "visualization_msgs"),
        *("std_srvs", "builtin_interfaces", "rosgraph_msgs", "trajectory_msgs", "turtlesim"),
        *("action_msgs", "rosbag2_py", "rosidl_runtime_py", "composition_interfaces"),
        *("example_interfaces", "action_tutorials_interfaces", "lifecycle_msgs"),
        *("common_interfaces", "rclcpp_components", "teleop_twist_keyboard"),
        *("teleop_twist_joy", "joy", "demo_nodes_cpp", "demo_nodes_py", "rqt_graph", "rqt_gui"),
    )
)
SIMULATORS: Final = ("gazebo_ros", "ros_gz_sim", "ros_ign_gazebo", "ros_ign", "webots_ros2_driver")
KNOWN: Final = frozenset(
    (
        *PROGRAMS,
        *FILES,
        *DESKTOP,
        *SIMULATORS,
        *("gazebo_ros2_control", "gz_ros2_control", "ign_ros2_control", "gazebo_plugins"),
        *("gazebo_msgs", "gazebo_ros_pkgs", "ros_gz", "ros_gz_image", "ros_ign_bridge"),
        *("ros2_control", "ros2_controllers", "joint_state_broadcaster", "diff_drive_controller"),
        *("joint_trajectory_controller", "forward_command_controller", "robot_localization"),
        *("nav2_bringup", "nav2_common", "nav2_map_server", "nav2_amcl", "nav2_lifecycle_manager"),
        *("slam_toolbox", "twist_mux", "rqt_robot_steering", "rqt_joint_trajectory_controller"),
        *("urdf_tutorial", "turtlebot3_description", "turtlebot3_gazebo", "realsense2_description"),
        *("realsense2_camera", "ur_description", "moveit_ros_move_group", "moveit_configs_utils"),
        *("image_transport", "image_proc", "depth_image_proc", "v4l2_camera", "rplidar_ros"),
        *("foxglove_bridge", "rosbridge_server", "webots_ros2_description", "imu_tools"),
        *("velodyne_description", "husky_description", "tf2_kdl", "interactive_markers"),
    )
)
PUBLISHER: Final = "robot_state_publisher"
_NODE: Final = {"name": "", "namespace": "", "arguments": [], "remappings": []}


def nodes_of(
    package: str,
    file: str,
    arguments: dict[str, str],
    share: Callable[[str], str],
    expand: Callable[[str], str],
) -> list[dict[str, Any]]:
    """The nodes that a launch file of another package starts, as far as that is known.

    Args:
        arguments: that it gets.
        share: the share folder of a package.
        expand: what xacro makes of a file.
    """
    if package == "urdf_launch":
        model = (arguments.get("urdf_package", ""), arguments.get("urdf_package_path", ""))
        config = arguments.get("rviz_config", "")
        gui = arguments.get("jsp_gui", "true")
    elif (package, file) == ("urdf_tutorial", "launch/display.launch.py"):
        model = (package, arguments.get("model", ""))
        config, gui = arguments.get("rvizconfig", ""), arguments.get("gui", "true")
    else:
        return []
    text = expand(os.path.join(share(model[0]), model[1]))
    description = {"name": "robot_description", "value": text, "wrapped": True}
    found = [_node(PUBLISHER, parameters=[description])]
    if file.endswith("display.launch.py"):
        suffix = "_gui" if gui.lower() in ("true", "1") else ""
        found.append(_node(f"joint_state_publisher{suffix}"))
        config = config or f"{share(package)}/rviz/urdf.rviz"
        found.append(_node("rviz2", arguments=["-d", config]))
    return found


def _node(package: str, **more: Any) -> dict[str, Any]:
    return {**_NODE, "package": package, "executable": package, "parameters": [], **more}


def module(name: str) -> ModuleSpec:
    """A module of another package, which nobody has here."""
    return spec_of(_Module(name))


def spec_of(made: ModuleType) -> ModuleSpec:
    """By which a module is imported that is made already."""
    return ModuleSpec(made.__name__, _Loader(made), is_package=True)


class _Loader(Loader):
    def __init__(self, made: ModuleType) -> None:
        self._made = made

    def create_module(self, spec: ModuleSpec) -> ModuleType:
        return self._made

    def exec_module(self, module: ModuleType) -> None:
        pass


class _Module(ModuleType):
    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        return _Name(f"{self.__name__}.{name}")


class _Name:
    """Something in such a module; calling it makes an action."""

    def __init__(self, name: str) -> None:
        self._name = name

    def __call__(self, *args: Any, **kwargs: Any) -> Any:
        return _action(self._name, kwargs.get("condition"))

    def __getattr__(self, name: str) -> Any:
        raise OfAnother(self._name)


def _action(of: str, condition: Any) -> Any:
    from launch import Action  # the double: this is in the copy that evaluates

    class Foreign(Action):  # type: ignore[misc, unused-ignore]
        def execute(self, context: Any) -> None:
            package, _, name = of.partition(".")
            context.record.add_external(package, name)

        def __getattr__(self, name: str) -> Any:
            raise OfAnother(of)

    return Foreign(condition=condition)
