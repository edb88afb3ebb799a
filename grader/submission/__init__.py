"""Reads a submission, and finds what of it to start: its packages are evaluated, nothing is run."""
