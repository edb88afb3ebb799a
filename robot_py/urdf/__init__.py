"""Reads a URDF as urdfdom 4.0.2 reads it, and finds what urdfdom prints: `parse`."""

from robot_py.urdf.document import ParsedUrdf, parse
from robot_py.urdf.tinyxml import Consequence

__all__ = ["Consequence", "ParsedUrdf", "parse"]
