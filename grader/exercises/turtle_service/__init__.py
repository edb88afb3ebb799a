"""A service that has a turtle draw a polygon."""
