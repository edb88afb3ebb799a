"""`BufferInterface`: transforms messages between the frames of any buffer.

Other packages register the function for each type, tf2_geometry_msgs first of all.
"""

from __future__ import annotations

from collections.abc import Callable
from copy import deepcopy
from typing import Any, ClassVar

from geometry_msgs.msg import TransformStamped
from rclpy.duration import Duration
from rclpy.time import Time
from std_msgs.msg import Header

NO_WAIT = Duration()


class TypeException(Exception):
    """No function is registered that transforms or converts a type."""

    def __init__(self, errstr: str) -> None:
        self.errstr = errstr


class NotImplementedException(Exception):
    """A method that a derived class leaves out."""

    def __init__(self) -> None:
        self.errstr = "CanTransform or LookupTransform not implemented"


class BufferInterface:
    """Transforms messages by looking up transforms."""

    def __init__(self) -> None:
        self.registration = TransformRegistration()

    def transform(
        self, object_stamped: Any, target_frame: str, timeout: Duration = NO_WAIT,
        new_type: Any = None,
    ) -> Any:  # fmt: skip
        """Return the message in another frame, at its stamp; as another type if one is given.

        Raises:
            TypeException: its type is not known; import tf2_geometry_msgs or its like.
            TransformException: as `lookup_transform` does.
        """
        do_transform = self.registration.get(type(object_stamped))
        header = object_stamped.header
        found = self.lookup_transform(target_frame, header.frame_id, header.stamp, timeout)
        moved = do_transform(object_stamped, found)
        return moved if new_type is None else convert(moved, new_type)

    def transform_full(
        self, object_stamped: Any, target_frame: str, target_time: Time, fixed_frame: str,
        timeout: Duration = NO_WAIT, new_type: Any = None,
    ) -> Any:  # fmt: skip
        """Return the message in another frame at another time; `fixed_frame` has not moved."""
        do_transform = self.registration.get(type(object_stamped))
        header = object_stamped.header
        found = self.lookup_transform_full(
            target_frame, target_time, header.frame_id, header.stamp, fixed_frame, timeout
        )
        moved = do_transform(object_stamped, found)
        return moved if new_type is None else convert(moved, new_type)

    def lookup_transform(
        self, target_frame: str, source_frame: str, time: Time, timeout: Duration = NO_WAIT
    ) -> TransformStamped:
        """Return where `source_frame` is in `target_frame`."""
        raise NotImplementedException()

    def lookup_transform_full(
        self, target_frame: str, target_time: Time, source_frame: str, source_time: Time,
        fixed_frame: str, timeout: Duration = NO_WAIT,
    ) -> TransformStamped:  # fmt: skip
        """Return where `source_frame` was at one time in what `target_frame` is at another."""
        raise NotImplementedException()

    def can_transform(
        self, target_frame: str, source_frame: str, time: Time, timeout: Duration = NO_WAIT
    ) -> Any:
        """Whether that lookup would succeed."""
        raise NotImplementedException()

    def can_transform_full(
        self, target_frame: str, target_time: Time, source_frame: str, source_time: Time,
        fixed_frame: str, timeout: Duration = NO_WAIT,
    ) -> Any:  # fmt: skip
        """Whether the lookup with two times would succeed."""
        raise NotImplementedException()


def Stamped(obj: Any, stamp: Any, frame_id: str) -> Any:  # noqa: N802
    """Give an object a header."""
    obj.header = Header(frame_id=frame_id, stamp=stamp)
    return obj


class TransformRegistration:
    """Type -> the function (object, transform) -> the object, transformed."""

    _functions: ClassVar[dict[Any, Callable[..., Any]]] = {}

    def print_me(self) -> None:
        """Print the registered types."""
        print(self._functions)

    def add(self, key: Any, callback: Callable[..., Any]) -> None:
        """Register how a type is transformed."""
        self._functions[key] = callback

    def get(self, key: Any) -> Callable[..., Any]:
        """Return how; `TypeException` if that is not registered."""
        return _registered(self._functions, key)


class ConvertRegistration:
    """How types become messages, messages types, and types one another."""

    _to_msg: ClassVar[dict[Any, Callable[..., Any]]] = {}
    _from_msg: ClassVar[dict[Any, Callable[..., Any]]] = {}
    _convert: ClassVar[dict[Any, Callable[..., Any]]] = {}

    def add_from_msg(self, key: Any, callback: Callable[..., Any]) -> None:
        """Register how a type is made of a message."""
        self._from_msg[key] = callback

    def add_to_msg(self, key: Any, callback: Callable[..., Any]) -> None:
        """Register how a type becomes a message."""
        self._to_msg[key] = callback

    def add_convert(self, key: Any, callback: Callable[..., Any]) -> None:
        """Register how one type becomes another; `key` is the two."""
        self._convert[key] = callback

    def get_from_msg(self, key: Any) -> Callable[..., Any]:
        """Return how a type is made of a message."""
        return _registered(self._from_msg, key)

    def get_to_msg(self, key: Any) -> Callable[..., Any]:
        """Return how a type becomes a message."""
        return _registered(self._to_msg, key)

    def get_convert(self, key: Any) -> Callable[..., Any]:
        """Return how one type becomes another."""
        return _registered(self._convert, key)


def _registered(functions: dict[Any, Callable[..., Any]], key: Any) -> Callable[..., Any]:
    if key not in functions:
        raise TypeException(f"Type {key} is not loaded or supported")
    return functions[key]


def convert(a: Any, b_type: Any) -> Any:
    """Return the object as another type: directly, as a copy, or by way of a message."""
    known = ConvertRegistration()
    try:
        directly = known.get_convert((type(a), b_type))
    except TypeException:
        if type(a) is b_type:
            return deepcopy(a)
        return known.get_from_msg(b_type)(known.get_to_msg(type(a))(a))
    return directly(a)
