"""A client that asks for a sum."""
