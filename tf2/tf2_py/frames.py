"""The frames that a buffer knows: which hangs in which, and the way from one to another.

A frame has one parent at a time. What is known of it is kept under its own name, so whoever sends a
frame under another parent moves it there.
"""

from __future__ import annotations

from .caches import Cache, Sample, StaticCache, TimeCache
from .exceptions import ConnectivityException, ExtrapolationException, LookupException
from .geometry import IDENTITY, Pose, compose, inverse

#: More steps to a root than this are a loop.
MOST_STEPS = 1000


class Frames:
    """All frames, in the order in which they were first heard of.

    Args:
        length_ns: for how long poses that change are kept.
    """

    def __init__(self, length_ns: int) -> None:
        self._length_ns = length_ns
        #: None: only heard of as a parent.
        self.caches: dict[str, Cache | None] = {}
        self.authorities: dict[str, str] = {}

    def insert(self, child: str, sample: Sample, authority: str, is_static: bool) -> bool:
        """Keep a pose of `child`; False if it is too old.

        A static pose of a frame that moves replaces all that is known of it, and the other way
        round.
        """
        cache = self.caches.setdefault(child, None)
        self.caches.setdefault(sample.parent, None)
        if cache is None or isinstance(cache, StaticCache) != is_static:
            cache = StaticCache() if is_static else TimeCache(self._length_ns)
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
        """A line for each frame that has a parent."""
        lines = []
        for name, cache in self.caches.items():
            if cache is not None:
                parent = cache.latest()[1] or "NO_PARENT"
                lines.append(f"Frame {name} exists with parent {parent}.\n")
        return "".join(lines)

    def pose(self, target: str, source: str, time_ns: int) -> tuple[Pose, int]:
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
            raise _told(missing_below, target, source)
        if end == source:
            return inverse(_product(down)), time_ns
        if end == top:
            return compose(inverse(_product(down)), _product(up)), time_ns
        if missing is not None:
            raise _told(missing, target, source)
        raise _not_connected(target, source)

    def _climb(
        self, frame: str, time_ns: int, ends: set[str]
    ) -> tuple[list[Pose], str, ExtrapolationException | None]:
        """Go from a frame to its parent and on, to one of `ends` or as far as is known.

        Returns the poses on the way, the frame where it ended, and what was missing there.
        """
        poses: list[Pose] = []
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


def _product(poses: list[Pose]) -> Pose:
    """The pose of the first frame of a way in the last."""
    whole = IDENTITY
    for pose in poses:
        whole = compose(pose, whole)
    return whole


def _earliest(found: list[tuple[int, str]]) -> int:
    """The earliest stamp; a static pose has none."""
    return min((stamp_ns for stamp_ns, _ in found if stamp_ns), default=0)


def _told(missing: ExtrapolationException, target: str, source: str) -> ExtrapolationException:
    return ExtrapolationException(
        f"{missing}, when looking up transform from frame [{source}] to frame [{target}]"
    )


def _not_connected(target: str, source: str) -> ConnectivityException:
    return ConnectivityException(
        f"Could not find a connection between '{target}' and '{source}' because they are not part "
        "of the same tree.Tf has two or more unconnected trees."
    )
