"""The third exercise: a node that moves a robot: its joint states, and where it is in odom."""
