"""The ROS face of the world: node, topics, services, action, and what makes it tick."""
