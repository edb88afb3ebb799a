"""Start robot_state_publisher with the robot's description, and the node that moves it."""

from launch import LaunchDescription


def generate_launch_description():
    # TODO 3: two nodes. robot_state_publisher wants the text of urdf/walker.urdf as its parameter
    #         robot_description; get_package_share_directory("my_walker") tells where that lies.
    return LaunchDescription([])
