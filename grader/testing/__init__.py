"""For authors of exercises: recordings without a robot, and a check of a whole exercise."""

from __future__ import annotations

from grader.scenes.turtlesim.driving import Controller, pen, twist
from grader.testing.driving import drive

__all__ = ["Controller", "drive", "pen", "twist"]
