"""Starts and observes a submission's program in its process of a run, by either clock."""
