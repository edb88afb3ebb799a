"""A node with a parameter."""
