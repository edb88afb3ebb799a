"""What differs from run to run or from machine to machine, made the same: random numbers etc."""

from __future__ import annotations

import functools
import itertools
import os
import random
from collections.abc import Callable
from typing import Any

from grader.run.lockstep.faults import pass_on

#: As many as students' machines have; executors and pools size themselves by it.
PROCESSORS = 4


def install() -> Callable[[], object]:
    """Seed every source of random numbers, fix the number of processors.

    Returns what tells their state: equal ones mean that nothing was drawn between.
    """
    source = random.Random(0)
    seeds = itertools.count(1)
    real_seed = random.Random.seed

    def urandom(size: int, /) -> bytes:
        drawn: bytes = pass_on(source.randbytes, size)
        return drawn

    def getrandom(size: int, flags: int = 0) -> bytes:
        return urandom(size)

    def seed(self: random.Random, a: Any = None, version: int = 2) -> None:
        pass_on(real_seed, self, next(seeds) if a is None else a, version)

    os.urandom = urandom
    random._urandom = urandom  # type: ignore[attr-defined]
    if hasattr(os, "getrandom"):
        os.getrandom = getrandom
    random.Random.seed = seed  # type: ignore[method-assign]
    # the module's own is a method that was bound at import
    random.seed = random._inst.seed
    random.seed(0)
    os.cpu_count = lambda: PROCESSORS
    os.sched_getaffinity = lambda _: set(range(PROCESSORS))
    if hasattr(os, "process_cpu_count"):  # CPython 3.13
        os.process_cpu_count = lambda: PROCESSORS
    return lambda: (source.getstate(), repr(seeds), random.getstate())


def order_nodes(node_class: Any) -> None:
    """Have sets of nodes, as in executors, in the order of their making, not of their addresses."""
    serials = itertools.count()
    original = node_class.__init__

    @functools.wraps(original)
    def init(self: Any, *args: Any, **kwargs: Any) -> None:
        self._serial_in_virtual_time = next(serials)
        pass_on(original, self, *args, **kwargs)

    node_class.__init__ = init
    node_class.__hash__ = lambda self: self._serial_in_virtual_time
