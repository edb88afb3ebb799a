"""`BufferCore`: transforms go in as messages, and where a frame is in another comes out.

What tf2's C++ library does, with its rules, in its words.
"""

from __future__ import annotations

import math
import sys
import threading
from collections.abc import Iterator
from typing import Any

from geometry_msgs.msg import TransformStamped
from rclpy.time import Time

from .frames import (
    Frames,
    FrameSample,
    InvalidArgumentException,
    LookupException,
    TimeCache,
    TransformException,
    seconds,
)
from .geometry import IDENTITY, FramePose, compose, unit

#: For how long transforms are kept by default [ns].
CACHE_TIME_NS = 10 * 10**9


class BufferCore:
    """The transforms of the last seconds, and lookups in them.

    Args:
        cache_time: for how long transforms are kept, a duration of rclpy or a message; 10 s.
    """

    def __init__(self, cache_time: Any = None, /) -> None:
        length_ns = CACHE_TIME_NS if cache_time is None else _nanoseconds(cache_time, "duration")
        self._frames = Frames(length_ns)
        # a TransformListener may have a separate thread
        self._lock = threading.RLock()

    def set_transform(self, transform: TransformStamped, authority: str) -> None:
        """Keep a transform that holds at its stamp; one that cannot be is refused on stderr."""
        self._set(transform, authority, is_static=False)

    def set_transform_static(self, transform: TransformStamped, authority: str) -> None:
        """Keep a transform that holds at all times."""
        self._set(transform, authority, is_static=True)

    def _set(self, transform: TransformStamped, authority: str, is_static: bool) -> None:
        _check_texts(authority, first=2)
        parent = transform.header.frame_id.removeprefix("/")
        child = transform.child_frame_id.removeprefix("/")
        stamp_ns = _nanoseconds(transform.header.stamp, "time")
        pose = _pose(transform)
        if refused := list(_refusals(parent, child, pose, authority)):
            _print_lines("Error:   ", *refused)
            return
        with self._lock:
            kept = self._frames.insert(
                child, FrameSample(stamp_ns, parent, pose), authority, is_static
            )
        if not kept:
            _print_lines(
                "Warning: ",
                f"TF_OLD_DATA ignoring data from the past for frame {child} at time "
                f"{seconds(stamp_ns)} according to authority {authority}\n"
                "Possible reasons are listed at http://wiki.ros.org/tf/Errors%20explained",
            )

    def clear(self) -> None:
        """Forget all transforms but static ones."""
        with self._lock:
            self._frames.clear()

    def lookup_transform_core(
        self, target_frame: str, source_frame: str, time: Any
    ) -> TransformStamped:
        """Return where `source_frame` is in `target_frame`; time 0 is the latest possible.

        Raises:
            LookupException, ConnectivityException, ExtrapolationException,
            InvalidArgumentException: there is no answer, and why.
        """
        _check_texts(target_frame, source_frame)
        time_ns = _nanoseconds(time, "time")
        with self._lock:
            pose, at_ns = self._lookup(target_frame, source_frame, time_ns)
        return _message(target_frame, source_frame, pose, at_ns)

    def lookup_transform_full_core(
        self, target_frame: str, target_time: Any, source_frame: str, source_time: Any,
        fixed_frame: str,
    ) -> TransformStamped:  # fmt: skip
        """Return where `source_frame` was at one time in what `target_frame` is at another.

        Args:
            fixed_frame: what has not moved in between.
        """
        _check_texts(target_frame, source_frame, fixed_frame)
        target_ns, source_ns = (_nanoseconds(time, "time") for time in (target_time, source_time))
        with self._lock:
            self._check_frame("lookupTransform argument target_frame", target_frame)
            self._check_frame("lookupTransform argument source_frame", source_frame)
            self._check_frame("lookupTransform argument fixed_frame", fixed_frame)
            source_pose, _ = self._lookup(fixed_frame, source_frame, source_ns)
            fixed_pose, at_ns = self._lookup(target_frame, fixed_frame, target_ns)
        return _message(target_frame, source_frame, compose(fixed_pose, source_pose), at_ns)

    def can_transform_core(
        self, target_frame: str, source_frame: str, time: Any
    ) -> tuple[int, str]:
        """Return (1, "") if the lookup would succeed, else 0 and why it would not."""
        _check_texts(target_frame, source_frame)
        time_ns = _nanoseconds(time, "time")
        if target_frame == source_frame:
            return 1, ""
        with self._lock:
            return self._first_problem(
                {"target_frame": target_frame, "source_frame": source_frame},
                [(target_frame, source_frame, time_ns)],
            )

    def can_transform_full_core(
        self, target_frame: str, target_time: Any, source_frame: str, source_time: Any,
        fixed_frame: str,
    ) -> tuple[int, str]:  # fmt: skip
        """Return (1, "") if the lookup with two times would succeed, else 0 and why not."""
        _check_texts(target_frame, source_frame, fixed_frame)
        target_ns, source_ns = (_nanoseconds(time, "time") for time in (target_time, source_time))
        names = {"target_frame": target_frame, "source_frame": source_frame}
        with self._lock:
            return self._first_problem(
                names | {"fixed_frame": fixed_frame},
                [(target_frame, fixed_frame, target_ns), (fixed_frame, source_frame, source_ns)],
            )

    def get_latest_common_time(self, target_frame: str, source_frame: str, /) -> Time:
        """Return the newest time for which the whole way between two frames is known."""
        _check_texts(target_frame, source_frame)
        with self._lock:
            self._check_frame("get_latest_common_time", target_frame)
            self._check_frame("get_latest_common_time", source_frame)
            if target_frame == source_frame:
                return Time(nanoseconds=self._latest_ns(source_frame))
            try:
                time_ns = self._frames.latest_common_ns(target_frame, source_frame)
            except TransformException as problem:
                raise TransformException(str(problem)) from None
        return Time(nanoseconds=time_ns)

    def all_frames_as_string(self) -> str:
        """Return each frame and its parent, as text."""
        with self._lock:
            return self._frames.describe()

    def all_frames_as_yaml(self) -> str:
        """Return each frame, its parent, sender and rate; `ros2 run tf2_tools` reads it."""
        with self._lock:
            frames = self._frames
            if not frames.caches:
                return "[]"
            return "".join(
                _entry(name, cache, frames.authorities[name])
                for name, cache in frames.caches.items()
                if cache is not None and cache.latest()[1]
            )

    def _frameExists(self, frame_id: str, /) -> bool:  # noqa: N802
        _check_texts(frame_id)
        return frame_id in self._frames.caches

    def _getFrameStrings(self) -> list[str]:  # noqa: N802
        with self._lock:
            return list(self._frames.caches)

    def _lookup(self, target: str, source: str, time_ns: int) -> tuple[FramePose, int]:
        if target == source:  # even of an unknown frame
            return IDENTITY, time_ns or self._latest_ns(source)
        self._check_frame("lookupTransform argument target_frame", target)
        self._check_frame("lookupTransform argument source_frame", source)
        return self._frames.pose(target, source, time_ns)

    def _latest_ns(self, frame: str) -> int:
        cache = self._frames.caches.get(frame)
        return cache.latest()[0] if cache is not None else 0

    def _check_frame(self, where: str, frame: str) -> None:
        """Raise the exception of a lookup if there is no frame with this name."""
        if reason := _cannot_be(frame):
            raise InvalidArgumentException(
                f'Invalid argument "{frame}" passed to {where} - {reason}'
            )
        if frame not in self._frames.caches:
            raise LookupException(f'"{frame}" passed to {where} does not exist. ')

    def _first_problem(
        self, names: dict[str, str], ways: list[tuple[str, str, int]]
    ) -> tuple[int, str]:
        """Return why one of several lookups would fail, in other words than the lookup."""
        for argument, frame in names.items():
            unknown = "" if frame in self._frames.caches else "frame does not exist"
            if reason := _cannot_be(frame) or unknown:
                where = f"canTransform argument {argument}"
                return 0, f'Invalid frame ID "{frame}" passed to {where} - {reason}'
        for target, source, time_ns in ways:
            try:
                self._lookup(target, source, time_ns)
            except TransformException as problem:
                return 0, str(problem)
        return 1, ""


def _cannot_be(frame: str) -> str:
    """Return why no frame can have this name; '' where one can."""
    if not frame:
        return "in tf2 frame_ids cannot be empty"
    return "in tf2 frame_ids cannot start with a '/'" if frame.startswith("/") else ""


def _check_texts(*texts: Any, first: int = 1) -> None:
    """Raise TypeError for what is no text, as a function written in C does."""
    for number, text in enumerate(texts, first):
        if not isinstance(text, str):
            raise TypeError(f"argument {number} must be str, not {type(text).__name__}")


def _nanoseconds(time: Any, what: str) -> int:
    """Return a time or duration of rclpy or of a message in nanoseconds."""
    if hasattr(time, "sec") and hasattr(time, "nanosec"):
        return int(time.sec) * 10**9 + int(time.nanosec)
    if hasattr(time, "nanoseconds"):
        return int(time.nanoseconds)
    raise TypeError(f"{what} must have sec and nanosec, or nanoseconds.")


def _pose(transform: TransformStamped) -> FramePose:
    t, q = transform.transform.translation, transform.transform.rotation
    rotation = unit((float(q.x), float(q.y), float(q.z), float(q.w)))
    return FramePose(rotation, (float(t.x), float(t.y), float(t.z)))


def _message(target: str, source: str, pose: FramePose, time_ns: int) -> TransformStamped:
    message = TransformStamped()
    message.header.frame_id, message.child_frame_id = target, source
    message.header.stamp.sec, message.header.stamp.nanosec = divmod(time_ns, 10**9)
    t, q = message.transform.translation, message.transform.rotation
    t.x, t.y, t.z = pose.translation
    q.x, q.y, q.z, q.w = unit(pose.rotation)
    return message


# What a buffer prints, in tf2's words -------------------------------------------------------------


def _refusals(parent: str, child: str, pose: FramePose, authority: str) -> Iterator[str]:
    """Yield everything for which a transform is refused."""
    ignoring = "Ignoring transform for child_frame_id"
    no_rotation = any(math.isnan(number) for number in pose.rotation)
    if child == parent:
        yield (
            f'TF_SELF_TRANSFORM: Ignoring transform from authority "{authority}" with frame_id and '
            f' child_frame_id "{child}" because they are the same'
        )
    if not child:
        yield (
            f'TF_NO_CHILD_FRAME_ID: Ignoring transform from authority "{authority}" because '
            "child_frame_id not set "
        )
    if not parent:
        yield (
            f'TF_NO_FRAME_ID: Ignoring transform with child_frame_id "{child}"  from authority '
            f'"{authority}" because frame_id not set'
        )
    if no_rotation or any(math.isnan(number) for number in pose.translation):
        yield (
            f'TF_NAN_INPUT: {ignoring} "{child}" from authority "{authority}" because of a nan '
            f"value in the transform ({_printed(pose.translation)}) ({_printed(pose.rotation)})"
        )
    if no_rotation:
        yield (
            f'TF_DENORMALIZED_QUATERNION: {ignoring} "{child}" from authority "{authority}" '
            f"because of an invalid quaternion in the transform ({_printed(pose.rotation)})"
        )


def _printed(numbers: tuple[float, ...]) -> str:
    """Return numbers as C prints them by %f, the sign of NaN included."""
    texts = (f"{number:f}" for number in numbers)
    return " ".join(
        "-nan" if math.isnan(number) and math.copysign(1.0, number) < 0 else text
        for number, text in zip(numbers, texts, strict=True)
    )


def _print_lines(level: str, *texts: str) -> None:
    """Print as console_bridge does, but for the line that names a line of C++."""
    print(*(f"{level}{text}" for text in texts), sep="\n", file=sys.stderr, flush=True)


def _entry(name: str, cache: TimeCache, authority: str) -> str:
    """Return the entry of one frame in `all_frames_as_yaml`."""
    newest_ns, parent = cache.latest()
    oldest_ns = cache.oldest_ns()
    length_ns = newest_ns - oldest_ns
    return (
        f"{name}: \n"
        f"  parent: '{parent}'\n"
        f"  broadcaster: '{authority}'\n"
        f"  rate: {len(cache) * 1e9 / max(length_ns, 100_000):.3f}\n"
        f"  most_recent_transform: {seconds(newest_ns)}\n"
        f"  oldest_transform: {seconds(oldest_ns)}\n"
        f"  buffer_length: {length_ns * 1e-9:.3f}\n"
    )
