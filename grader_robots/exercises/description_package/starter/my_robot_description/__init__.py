"""The robot has no nodes of its own, so far."""
