"""Exercises that were added by address: pinned to a commit and a hash, and judged confined."""
