"""A robot as a picture, without a graphics card: numpy and Pillow, the same bytes each time."""

from robot_py.drawing.body import NOBODY, body
from robot_py.drawing.picture import picture

__all__ = ["NOBODY", "body", "picture"]
