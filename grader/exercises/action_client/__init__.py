"""A client of that action."""
