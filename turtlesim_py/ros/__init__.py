"""The ROS face of the world: node, topics, services, action, and who says "tick"."""
