"""Forget a student: remove what is kept of one from the folder of a class."""
