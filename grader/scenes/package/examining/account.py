"""What the steps of a look at a package may take together, and how long one may wait in vain.

Counted are processor time and idleness: time in which nothing of a step runs or wants to, so that a
busy machine decides nothing.
"""

from __future__ import annotations

import os
import time
from typing import Final

from grader.scenes.package.examining import leftovers

#: All steps of a look may take so much processor time, and be idle for so long [s].
CPU_S, IDLE_S = 120.0, 20.0
#: One step may be idle for so long [s]: it waits for what does not come.
STEP_IDLE_S: Final = 4.0
_SPENT: Final = (
    "it was not tried: the package had taken {:.0f} s of processor time, or {:.0f} s of waiting"
)


class Account:
    """The account of one look; what was taken before it was opened does not count.

    Args:
        cpu_s: so much processor time may be taken [s].
    """

    def __init__(self, cpu_s: float = CPU_S) -> None:
        self._cpu_s = cpu_s
        self._before_s = _children_cpu_s()
        self.idle_s = 0.0

    @property
    def why_closed(self) -> str:
        """Why there is to be no further step; '' where there may be one."""
        used_s = _children_cpu_s() - self._before_s
        is_spent = used_s > self._cpu_s or self.idle_s > IDLE_S
        return _SPENT.format(self._cpu_s, IDLE_S) if is_spent else ""


class Watch:
    """Looks at a step now and then, and tells whether it waits in vain."""

    def __init__(self, account: Account) -> None:
        self._account = account
        self._idle_s = self._used_s = 0.0
        self._looked_s = time.monotonic()

    def is_stalled(self) -> bool:
        """Whether the step has been idle for too long; ask about twice a second."""
        ticks, wants_more = leftovers.used()
        used_s, now_s = ticks / os.sysconf("SC_CLK_TCK"), time.monotonic()
        if not wants_more:
            idle_s = max(0.0, now_s - self._looked_s - max(0.0, used_s - self._used_s))
            self._idle_s += idle_s
            self._account.idle_s += idle_s
        self._used_s, self._looked_s = used_s, now_s
        return self._idle_s > STEP_IDLE_S


def _children_cpu_s() -> float:
    import resource  # here: Windows has none

    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime
