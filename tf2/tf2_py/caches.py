"""What is known of one frame: its poses in its parent over time, or one pose for all times.

Times are nanoseconds; 0 stands for the latest.
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from typing import NamedTuple, Protocol

from .exceptions import ExtrapolationException
from .geometry import Pose, interpolate


class Sample(NamedTuple):
    """A pose of a frame in `parent`, at `stamp_ns`."""

    stamp_ns: int
    parent: str
    pose: Pose


class Cache(Protocol):
    """What a buffer asks one frame for."""

    def __len__(self) -> int: ...

    def insert(self, sample: Sample) -> bool:
        """Keep it; False if it is too old for that."""
        ...

    def at(self, time_ns: int) -> Sample:
        """Return what is known of that time; `ExtrapolationException` if nothing is."""
        ...

    def latest(self) -> tuple[int, str]:
        """The newest stamp and its parent; (0, "") where nothing is known."""
        ...

    def oldest_ns(self) -> int:
        """The oldest stamp; 0 where nothing is known."""
        ...

    def clear(self) -> None:
        """Forget what is known of single times."""
        ...


class StaticCache:
    """One pose, at all times: the one that was heard last."""

    def __init__(self) -> None:
        self._sample: Sample | None = None

    def __len__(self) -> int:
        return 1

    def insert(self, sample: Sample) -> bool:
        """Replace what was known."""
        self._sample = sample
        return True

    def at(self, time_ns: int) -> Sample:
        """Return the pose, stamped with the time asked for."""
        assert self._sample is not None  # made with its first sample
        return self._sample._replace(stamp_ns=time_ns)

    def latest(self) -> tuple[int, str]:
        """It has no stamp."""
        return 0, self._sample.parent if self._sample else ""

    def oldest_ns(self) -> int:
        """It has no stamp."""
        return 0

    def clear(self) -> None:
        """A static pose stays, whatever the clock does."""


class TimeCache:
    """The poses of the last seconds, by time.

    Args:
        length_ns: how much older than the newest a sample may be.
    """

    def __init__(self, length_ns: int) -> None:
        self._length_ns = length_ns
        self._samples: list[Sample] = []  # the oldest first; of equal stamps, the first heard
        self._stamps: list[int] = []  # theirs

    def __len__(self) -> int:
        return len(self._samples)

    def insert(self, sample: Sample) -> bool:
        """Put it in its place, unless the same is there; what has become too old goes before."""
        stamps, stamp_ns = self._stamps, sample.stamp_ns
        if stamps:
            horizon_ns = stamps[-1] - self._length_ns
            gone = bisect_left(stamps, horizon_ns)
            del self._samples[:gone], stamps[:gone]
            if stamp_ns < horizon_ns:
                return False
        place = bisect_right(stamps, stamp_ns)
        if sample not in self._samples[bisect_left(stamps, stamp_ns) : place]:
            self._samples.insert(place, sample)
            stamps.insert(place, stamp_ns)
        return True

    def at(self, time_ns: int) -> Sample:
        """Return the sample of that time, or one between its neighbours; never outside of them.

        Between neighbours with different parents it is the older one.
        """
        older, newer = self._around(time_ns)
        if newer is None or older.parent != newer.parent:
            return older
        ratio = (time_ns - older.stamp_ns) / (newer.stamp_ns - older.stamp_ns)
        return older._replace(pose=interpolate(older.pose, newer.pose, ratio))

    def _around(self, time_ns: int) -> tuple[Sample, Sample | None]:
        samples, stamps = self._samples, self._stamps
        if not samples:
            raise ExtrapolationException("")  # tf2 has no words for it either
        if time_ns in (0, stamps[-1]):
            return samples[-1], None
        if len(samples) == 1:
            raise ExtrapolationException(
                f"Lookup would require extrapolation at time {seconds(time_ns)}, "
                f"but only time {seconds(stamps[0])} is in the buffer"
            )
        if time_ns == stamps[0]:
            return samples[0], None
        if time_ns > stamps[-1]:
            raise ExtrapolationException(
                "Lookup would require extrapolation into the future.  Requested time "
                f"{seconds(time_ns)} but the latest data is at time {seconds(stamps[-1])}"
            )
        if time_ns < stamps[0]:
            raise ExtrapolationException(
                "Lookup would require extrapolation into the past.  Requested time "
                f"{seconds(time_ns)} but the earliest data is at time {seconds(stamps[0])}"
            )
        place = bisect_right(stamps, time_ns)
        return samples[place - 1], samples[place]

    def latest(self) -> tuple[int, str]:
        """The newest stamp and its parent."""
        return (self._stamps[-1], self._samples[-1].parent) if self._samples else (0, "")

    def oldest_ns(self) -> int:
        """The oldest stamp."""
        return self._stamps[0] if self._stamps else 0

    def clear(self) -> None:
        """Forget them all; the frame stays known."""
        self._samples.clear()
        self._stamps.clear()


def seconds(time_ns: int) -> str:
    """A time as tf2 prints it."""
    whole, rest = divmod(time_ns, 10**9)
    return f"{whole + 1e-9 * rest:.6f}"
