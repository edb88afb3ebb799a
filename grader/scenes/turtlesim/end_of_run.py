"""When a run is over: the turtle came to rest, never moved, lost its node, or time is up."""

from __future__ import annotations

from grader.scenes.scene import Limits, Reason
from turtlesim_py.world.turtle import TICK_S, Pose

#: How long after its exit a submission's last messages may still arrive [ticks].
GRACE_TICKS = 31


class EndOfRun:
    """Decides when there is nothing more to see.

    The turtle has driven and rested; or nothing has moved for too long; or the submission is gone
    and nothing moved; or time is up. Who has only turned on the spot has not begun to drive, and
    may pause for as long as anybody may before the first motion.
    """

    def __init__(self, limits: Limits) -> None:
        self._limits = limits
        self._last_pose: Pose | None = None
        self._moved = False
        self._driven = False
        self._still_ticks = 0
        self._gone_ticks: int | None = None

    @property
    def is_at_rest(self) -> bool:
        """Whether the turtle has moved, and does not now."""
        return self._moved and self._still_ticks > 0

    def submission_gone(self) -> None:
        """The submission's process has ended."""
        self._gone_ticks = 0

    def after(self, tick: int, pose: Pose | None) -> Reason:
        """Why to stop after this tick, or ''."""
        self._watch(pose)
        if self._gone_ticks is not None:
            self._gone_ticks += 1
        if tick * TICK_S >= self._limits.total_s:
            return "time_limit"
        if self._moved:
            return "rest" if self._still_ticks * TICK_S >= self._patience_s() else ""
        if self._gone_ticks is not None and self._gone_ticks >= GRACE_TICKS:
            return "gone"
        return "no_motion" if tick * TICK_S >= self._limits.first_motion_s else ""

    def _patience_s(self) -> float:
        """How long a rest ends the run [s]."""
        has_begun = self._driven or self._gone_ticks is not None
        rest_s = self._limits.rest_s
        return rest_s if has_begun else max(rest_s, self._limits.first_motion_s)

    def _watch(self, pose: Pose | None) -> None:
        before = self._last_pose
        still = pose is None or before is None or pose[:3] == before[:3]
        self._moved = self._moved or not still
        if pose is not None and before is not None:
            self._driven = self._driven or pose[:2] != before[:2]
        self._still_ticks = self._still_ticks + 1 if still else 0
        self._last_pose = pose
