"""A transform that is sent once."""
