"""The ROS side of the simulator: node, topics, services, action, and its clock."""
