"""The frames that a buffer knows: their poses over time, and the way from one to another.

A frame has one parent at a time. What is known of it is kept under its name, so whoever sends a
frame under another parent moves it there. Times are nanoseconds; 0 stands for the latest. What has
no answer ends in one of tf2's six exceptions, by their names in Python.
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from operator import attrgetter
from typing import NamedTuple

from .geometry import IDENTITY, FramePose, compose, interpolate, inverse

#: More steps to a root than this are a loop.
MOST_STEPS = 1000
_STAMP = attrgetter("stamp_ns")


class TransformException(Exception):
    """Any of them."""


class ConnectivityException(TransformException):
    """The two frames hang in different trees."""


class LookupException(TransformException):
    """A frame is not known, or the frames make a loop."""


class ExtrapolationException(TransformException):
    """There is no data at that time."""


class InvalidArgumentException(TransformException):
    """A name that no frame can have."""


class TimeoutException(TransformException):
    """Raised by no lookup: a transform that is late raises one of the others."""


class FrameSample(NamedTuple):
    """A pose of a frame in `parent`, at `stamp_ns`."""

    stamp_ns: int
    parent: str
    pose: FramePose


class TimeCache:
    """The poses of a frame in the last seconds, by time.

    Args:
        length_ns: how much older than the newest a sample may be.
    """

    def __init__(self, length_ns: int) -> None:
        self._length_ns = length_ns
        #: the oldest first; of equal stamps, the first to come
        self._samples: list[FrameSample] = []

    def __len__(self) -> int:
        return len(self._samples)

    def insert(self, sample: FrameSample) -> bool:
        """Put a sample in its place, unless the same is there; False if it is too old.

        What has become too old goes before.
        """
        samples, stamp_ns = self._samples, sample.stamp_ns
        if samples:
            horizon_ns = samples[-1].stamp_ns - self._length_ns
            del samples[: bisect_left(samples, horizon_ns, key=_STAMP)]
            if stamp_ns < horizon_ns:
                return False
        place = bisect_right(samples, stamp_ns, key=_STAMP)
        if sample not in samples[bisect_left(samples, stamp_ns, key=_STAMP) : place]:
            samples.insert(place, sample)
        return True

    def at(self, time_ns: int) -> FrameSample:
        """Return the sample of that time, or one between its neighbours; never outside of them.

        Between neighbours with different parents it is the older one.

        Raises:
            ExtrapolationException: nothing is known of that time.
        """
        samples = self._samples
        if not samples:
            raise ExtrapolationException("")  # tf2 has no words for it either
        oldest, newest = samples[0], samples[-1]
        if time_ns in (0, newest.stamp_ns):
            return newest
        if len(samples) == 1:
            raise ExtrapolationException(
                f"Lookup would require extrapolation at time {seconds(time_ns)}, "
                f"but only time {seconds(oldest.stamp_ns)} is in the buffer"
            )
        if time_ns == oldest.stamp_ns:
            return oldest
        if time_ns > newest.stamp_ns:
            raise ExtrapolationException(
                "Lookup would require extrapolation into the future.  Requested time "
                f"{seconds(time_ns)} but the latest data is at time {seconds(newest.stamp_ns)}"
            )
        if time_ns < oldest.stamp_ns:
            raise ExtrapolationException(
                "Lookup would require extrapolation into the past.  Requested time "
                f"{seconds(time_ns)} but the earliest data is at time {seconds(oldest.stamp_ns)}"
            )
        place = bisect_right(samples, time_ns, key=_STAMP)
        older, newer = samples[place - 1], samples[place]
        if older.parent != newer.parent:
            return older
        ratio = (time_ns - older.stamp_ns) / (newer.stamp_ns - older.stamp_ns)
        return older._replace(pose=interpolate(older.pose, newer.pose, ratio))

    def latest(self) -> tuple[int, str]:
        """Return the newest stamp and its parent; (0, "") where nothing is known."""
        return self._samples[-1][:2] if self._samples else (0, "")

    def oldest_ns(self) -> int:
        """Return the oldest stamp; 0 where nothing is known."""
        return self._samples[0].stamp_ns if self._samples else 0

    def clear(self) -> None:
        """Forget all samples; the frame stays known."""
        self._samples.clear()


class StaticCache(TimeCache):
    """One pose of a frame, at all times: the one that came last. Its stamp is 0."""

    def insert(self, sample: FrameSample) -> bool:
        """Replace what was known; never refused."""
        self._samples = [sample._replace(stamp_ns=0)]
        return True

    def at(self, time_ns: int) -> FrameSample:
        """Return the pose, stamped with the time asked for."""
        return self._samples[0]._replace(stamp_ns=time_ns)

    def clear(self) -> None:
        """Do nothing: a static pose stays, whatever the clock does."""


def seconds(time_ns: int) -> str:
    """Return a time as tf2 prints it."""
    whole, rest = divmod(time_ns, 10**9)
    return f"{whole + 1e-9 * rest:.6f}"


class Frames:
    """All frames, in the order of their first mention.

    Args:
        length_ns: for how long poses that change are kept.
    """

    def __init__(self, length_ns: int) -> None:
        self._length_ns = length_ns
        #: None: only heard of as a parent.
        self.caches: dict[str, TimeCache | None] = {}
        self.authorities: dict[str, str] = {}

    def insert(self, child: str, sample: FrameSample, authority: str, is_static: bool) -> bool:
        """Keep a pose of `child`; False if it is too old.

        A static pose of a frame that moves replaces all that is known of it, and the other way
        round.
        """
        cache = self.caches.setdefault(child, None)
        self.caches.setdefault(sample.parent, None)
        if cache is None or isinstance(cache, StaticCache) != is_static:
            cache = (StaticCache if is_static else TimeCache)(self._length_ns)
            self.caches[child] = cache
        if not cache.insert(sample):
            return False
        self.authorities[child] = authority
        return True

    def clear(self) -> None:
        """Forget all poses of single times; frames and static poses stay."""
        for cache in self.caches.values():
            if cache is not None:
                cache.clear()

    def describe(self) -> str:
        """Return a line for each frame that has a parent."""
        lines = []
        for name, cache in self.caches.items():
            if cache is not None:
                parent = cache.latest()[1] or "NO_PARENT"
                lines.append(f"Frame {name} exists with parent {parent}.\n")
        return "".join(lines)

    def pose(self, target: str, source: str, time_ns: int) -> tuple[FramePose, int]:
        """Return where `source` is in `target`, and the time for which that holds.

        Args:
            target, source: two known frames, not the same.
            time_ns: 0 for the latest time at which the whole way is known.

        Raises:
            ConnectivityException: no way leads from one to the other.
            ExtrapolationException: the way is not known at that time.
            LookupException: the frames make a loop.
        """
        if time_ns == 0:
            time_ns = self.latest_common_ns(target, source)
        up, top, missing = self._climb(source, time_ns, {target})
        if top == target:
            return _product(up), time_ns
        down, end, missing_below = self._climb(target, time_ns, {source, top})
        if missing_below is not None:
            raise _about(missing_below, target, source)
        if end == source:
            return inverse(_product(down)), time_ns
        if end == top:
            return compose(inverse(_product(down)), _product(up)), time_ns
        if missing is not None:
            raise _about(missing, target, source)
        raise _not_connected(target, source)

    def _climb(
        self, frame: str, time_ns: int, ends: set[str]
    ) -> tuple[list[FramePose], str, ExtrapolationException | None]:
        """Go from a frame to its parent and on, to one of `ends` or as far as is known.

        Returns the poses on the way, the frame where it ended, and what was missing there.
        """
        poses: list[FramePose] = []
        while frame not in ends and (cache := self.caches[frame]) is not None:
            try:
                sample = cache.at(time_ns)
            except ExtrapolationException as missing:
                return poses, frame, missing
            poses.append(sample.pose)
            frame = sample.parent
            self._stop_loops(len(poses))
        return poses, frame, None

    def latest_common_ns(self, target: str, source: str) -> int:
        """Return the newest stamp that every frame on the way has; 0 where all are static.

        Raises:
            ConnectivityException, LookupException: as `pose` does.
        """
        above_source = self._newest_above(source, stop=[target])
        if above_source and above_source[-1][1] == target:
            return _earliest(above_source)
        parents = [parent for _, parent in above_source]
        above_target = self._newest_above(target, stop=[source, *parents])
        if above_target and above_target[-1][1] == source and source not in parents:
            return _earliest(above_target)
        if not above_target or above_target[-1][1] not in parents:
            raise _not_connected(target, source)
        to_common = parents.index(above_target[-1][1]) + 1
        return _earliest(above_source[:to_common] + above_target)

    def _newest_above(self, frame: str, stop: list[str]) -> list[tuple[int, str]]:
        """Newest stamp and parent of the frame, of its parent and so on, up to one in `stop`."""
        found: list[tuple[int, str]] = []
        while (cache := self.caches[frame]) is not None:
            stamp_ns, frame = cache.latest()
            if not frame:
                break
            found.append((stamp_ns, frame))
            if frame in stop:
                break
            self._stop_loops(len(found))
        return found

    def _stop_loops(self, steps: int) -> None:
        if steps > MOST_STEPS:
            raise LookupException(
                f"The tf tree is invalid because it contains a loop.\n{self.describe()}\n"
            )


def _product(poses: list[FramePose]) -> FramePose:
    """Return the pose of the first frame of a path in the last."""
    whole = IDENTITY
    for pose in poses:
        whole = compose(pose, whole)
    return whole


def _earliest(found: list[tuple[int, str]]) -> int:
    """Return the earliest stamp; a static pose has none."""
    return min((stamp_ns for stamp_ns, _ in found if stamp_ns), default=0)


def _about(missing: ExtrapolationException, target: str, source: str) -> ExtrapolationException:
    return ExtrapolationException(
        f"{missing}, when looking up transform from frame [{source}] to frame [{target}]"
    )


def _not_connected(target: str, source: str) -> ConnectivityException:
    return ConnectivityException(
        f"Could not find a connection between '{target}' and '{source}' because they are not part "
        "of the same tree.Tf has two or more unconnected trees."
    )
