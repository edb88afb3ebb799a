"""What is true about the turtles: no ROS, no clock, no files, no threads."""
