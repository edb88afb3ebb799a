"""A turtlesim without a screen: the world, its ROS 2 node, and a scripted replay."""
