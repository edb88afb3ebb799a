"""The world of the turtles: no ROS, no clock, no threads, no files but their pictures."""
