"""The two nodes: robot_state_publisher and joint_state_publisher."""
