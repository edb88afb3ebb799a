"""Robots as ROS describes them: URDF, where their links are, and the two nodes that publish it."""
