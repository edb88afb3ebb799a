"""The processor time that all processes of one grading may take together.

Processor time, since a busy machine must decide nothing. Each run has limits of its own as well
(`grader.run.simulator.link.Patience`); a course that sets a budget bounds their sum.
"""

from __future__ import annotations

import math
from threading import Lock


class Budget:
    """What is left for a grading; its runs spend of it from several threads.

    Args:
        cpu_s: so much processor time [s].

    Attributes:
        spent_s: so much of it was taken [s].
    """

    def __init__(self, cpu_s: float = math.inf) -> None:
        self._cpu_s = cpu_s
        self.spent_s = 0.0
        self._lock = Lock()

    def spend(self, cpu_s: float) -> None:
        """So much more was taken [s]."""
        with self._lock:
            self.spent_s += cpu_s

    @property
    def is_spent(self) -> bool:
        """Whether more was taken than there was: what still runs is to be ended."""
        return self.spent_s > self._cpu_s

    @property
    def remark(self) -> str:
        """For the result of a run that was ended, or not begun."""
        return f"the whole grading used more than {self._cpu_s:g} s of processor time"
