"""A node that logs what it hears."""
