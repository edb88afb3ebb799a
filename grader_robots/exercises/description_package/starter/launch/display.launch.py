from launch import LaunchDescription


def generate_launch_description():
    # TODO: find the description in the package's share folder, and hand it to
    # robot_state_publisher; start joint_state_publisher_gui, and rviz2 with your file
    return LaunchDescription([])
