"""A service that adds two numbers."""
