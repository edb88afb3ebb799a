"""Packages of ROS that a description's launch files ask for, with what of them is known.

`PROGRAMS`: package -> its programs, of those where a wrong name can be told. `FILES`: files in
their share folders that are looked for. `DESKTOP`: what every desktop installation of ROS 2 has;
nobody notices where it is not declared. `SIMULATORS`: packages that put a model into a world.
"""

from __future__ import annotations

from typing import Final

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
