"""What differs from run to run or from machine to machine, made the same: random numbers etc."""

from __future__ import annotations

import _random
import builtins
import functools
import io
import itertools
import os
import pwd
import random
import uuid
from collections.abc import Callable
from contextlib import suppress
from typing import Any

from grader.run.lockstep.faults import pass_on

#: As many as students' machines have; executors and pools size themselves by it.
PROCESSORS = 4
#: Of whoever grades there may be any; a sandbox has another in each run.
USER = 1000
#: A MAC address that is nobody's: the bit for "locally administered" is set.
NODE = 0x02_00_00_00_00_01
DEVICES = ("/dev/urandom", "/dev/random")
#: So much of a device can be read [bytes]: a program that reads on finds its end.
DEVICE_BYTES = 65_536


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

    class Random(_random.Random):
        """As its base, whose seed is taken from the system in C."""

        def __init__(self, *args: Any) -> None:
            self.seed(*args)

        def seed(self, a: Any = None, /) -> None:
            pass_on(super().seed, next(seeds) if a is None else a)

    Random.__module__, Random.__qualname__ = "_random", "Random"
    _random.Random = Random  # type: ignore[misc]
    os.urandom = urandom
    uuid._generate_time_safe = None  # type: ignore[attr-defined]
    uuid.getnode = lambda: NODE
    with suppress(ImportError):  # a Python without it
        import ssl

        ssl.RAND_bytes = urandom
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


def replace_surroundings() -> None:
    """Replace who the user is, and what devices of random numbers give.

    After `install`, and after the process was confined, which needs both as they are.
    """
    os.getuid = os.geteuid = os.getgid = os.getegid = lambda: USER
    by_number = pwd.getpwuid

    def getpwuid(uid: int, /) -> pwd.struct_passwd:
        home = os.path.expanduser("~")  # noqa: PTH111  as HOME says
        own = ("student", "x", USER, USER, "", home, "/bin/sh")
        return pwd.struct_passwd(own) if uid == USER else pass_on(by_number, uid)

    pwd.getpwuid = getpwuid
    opened, os_opened = builtins.open, os.open

    def is_device(file: object) -> bool:
        return isinstance(file, str | os.PathLike) and os.fspath(file) in DEVICES

    def device() -> int:
        found, end = os.pipe()
        os.write(end, os.urandom(DEVICE_BYTES))
        os.close(end)
        return found

    @functools.wraps(opened)
    def open(file: Any, *args: Any, **kwargs: Any) -> Any:
        return pass_on(opened, device() if is_device(file) else file, *args, **kwargs)

    @functools.wraps(os_opened)
    def os_open(path: Any, *args: Any, **kwargs: Any) -> int:
        found: int = device() if is_device(path) else pass_on(os_opened, path, *args, **kwargs)
        return found

    builtins.open = io.open = open
    os.open = os_open


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
