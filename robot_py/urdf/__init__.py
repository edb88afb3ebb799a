"""Reads a URDF as urdfdom 4.0.2 reads it, and says what urdfdom says: `parse`."""

from robot_py.urdf.document import LONGEST, Reading, parse

__all__ = ["LONGEST", "Reading", "parse"]
