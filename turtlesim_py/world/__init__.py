"""The world of the turtles: no ROS, no clock, no files, no threads."""
