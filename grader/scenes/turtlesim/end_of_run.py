"""When a run is over: the turtle came to rest, never moved, lost its node, or time is up."""

from __future__ import annotations

from grader.scenes.scene import Limits, Reason
from turtlesim_py.world.turtle import TICK_S, Pose

#: How long after its exit a submission's last messages may still arrive [ticks].
GRACE_TICKS = 31


class EndOfRun:
    """Decides when there is nothing more to see.

    The turtle has moved and rested; or nothing has moved for too long; or the submission is gone
    and nothing moved; or time is up.
    """

    def __init__(self, limits: Limits) -> None:
        self._limits = limits
        self._last_pose: Pose | None = None
        self._moved = False
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
            return "rest" if self._still_ticks * TICK_S >= self._limits.rest_s else ""
        if self._gone_ticks is not None and self._gone_ticks >= GRACE_TICKS:
            return "gone"
        return "no_motion" if tick * TICK_S >= self._limits.first_motion_s else ""

    def _watch(self, pose: Pose | None) -> None:
        still = pose is None or self._last_pose is None or pose[:3] == self._last_pose[:3]
        self._moved = self._moved or not still
        self._still_ticks = self._still_ticks + 1 if still else 0
        self._last_pose = pose
