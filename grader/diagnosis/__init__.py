"""Finds the one cause that comes first in a run; it never changes points."""
