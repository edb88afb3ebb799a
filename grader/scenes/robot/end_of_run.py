"""When a run is over: it was watched for long enough, nothing came, or the submission is gone."""

from __future__ import annotations

from grader.scenes.robot.trace import TICK_S
from grader.scenes.scene import Limits, Reason

#: How long after its exit a submission's last messages may still arrive [ticks].
GRACE_TICKS = 31


class EndOfRun:
    """Decides when there is nothing more to see. A robot that moves does so for ever."""

    def __init__(self, limits: Limits) -> None:
        self._limits = limits
        self._gone_ticks: int | None = None

    def submission_gone(self) -> None:
        """The submission's process has ended."""
        self._gone_ticks = 0

    def after(self, tick: int, heard: int) -> Reason:
        """Why to stop after this tick, when so many messages have come; or ''."""
        if self._gone_ticks is not None:
            self._gone_ticks += 1
            if self._gone_ticks >= GRACE_TICKS:
                return "gone"
        if not heard and tick * TICK_S >= self._limits.first_motion_s:
            return "no_motion"
        if tick * TICK_S >= self._limits.total_s:
            return "seen" if heard else "no_motion"
        return ""
