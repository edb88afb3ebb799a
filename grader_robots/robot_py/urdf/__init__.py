"""Parses a URDF as urdfdom 4.0.2 does, with the findings that urdfdom prints: `parse`."""

from grader_robots.robot_py.urdf.document import ParsedUrdf, parse
from grader_robots.robot_py.urdf.tinyxml import Consequence

__all__ = ["Consequence", "ParsedUrdf", "parse"]
