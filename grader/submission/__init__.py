"""Reads a submission and finds what of it to start; nothing of it is run for that."""
