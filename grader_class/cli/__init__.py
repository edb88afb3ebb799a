"""The verbs of a class, and what they print."""
