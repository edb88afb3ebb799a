"""A tf2_py for a Python without ROS: the buffer of transforms, and its exceptions.

That of ROS is made of C++. Installed only where no ROS is sourced.
"""

from .buffer_core import BufferCore
from .frames import (
    ConnectivityException,
    ExtrapolationException,
    InvalidArgumentException,
    LookupException,
    TimeoutException,
    TransformException,
)

__all__ = [
    "BufferCore",
    "ConnectivityException",
    "ExtrapolationException",
    "InvalidArgumentException",
    "LookupException",
    "TimeoutException",
    "TransformException",
]
