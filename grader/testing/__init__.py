"""For authors of exercises: recordings without a robot, and a check of a whole exercise."""

from __future__ import annotations

from grader.scenes.turtlesim.driving import Controller, pen, twist
from grader.testing.checking import check_exercise
from grader.testing.driving import drive
from grader.testing.examination import Examination

__all__ = ["Controller", "Examination", "check_exercise", "drive", "pen", "twist"]
