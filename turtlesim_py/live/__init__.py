"""The turtles in a browser: a page, what it is fed with, and the way from it to the ROS graph."""
