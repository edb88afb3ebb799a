"""The turtles in a browser: a page, its feed, and its connection to the ROS graph."""
