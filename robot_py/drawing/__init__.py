"""A robot as a picture, without a graphics card: numpy and Pillow, the same bytes each time."""

from robot_py.drawing.body import NOBODY, Body, body
from robot_py.drawing.picture import Labels, Pixels, picture
from robot_py.drawing.triangles import Triangles

__all__ = ["NOBODY", "Body", "Labels", "Pixels", "Triangles", "body", "picture"]
