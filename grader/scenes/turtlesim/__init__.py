"""The scene of turtlesim: one node, turtles, a canvas."""
