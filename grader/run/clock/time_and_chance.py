"""Makes the surroundings of a program the same in each run: time, chance, its user.

Time is virtual in `time`, `datetime` and the kernel's usage of a process; rclpy's clocks are in
`lockstep.waitsets`. Processor time is virtual, too: a program has computed for as long as it
has run. So a loop that waits for it ends, and prints the same in every run.
"""

from __future__ import annotations

import _random
import builtins
import datetime as _datetime
import functools
import importlib
import io
import itertools
import os
import pwd
import queue
import random
import resource
import sched
import threading
import time
import uuid
from collections.abc import Callable
from contextlib import suppress
from typing import Any

from grader.run.clock.scheduler import Scheduler
from grader.run.lockstep import real
from grader.run.lockstep.faults import as_python_does, pass_on
from grader.run.lockstep.protocol import BOOT_NS, EPOCH_NS

SCHEDULER: Scheduler
_REAL_GETRUSAGE = resource.getrusage
#: The peak of memory is rounded to this [KB]: it mostly differs by less between two runs.
_STEP_KB = 65_536
#: As many as students' machines have; executors and pools choose their size by it.
PROCESSORS = 4
#: The user and group that a program sees; the real ones differ between graders and runs.
USER = 1000
#: A MAC address that is nobody's: the bit for "locally administered" is set.
NODE = 0x02_00_00_00_00_01
DEVICES = ("/dev/urandom", "/dev/random")
#: So much of a device can be read [bytes]: a program that reads more finds its end.
DEVICE_BYTES = 65_536

# Time -----------------------------------------------------------------------------------------


def replace_clocks(scheduler: Scheduler) -> None:
    """Replace the clocks of the standard library in this interpreter."""
    global SCHEDULER
    SCHEDULER = scheduler
    time.sleep = _sleep
    time.time, time.time_ns = _seconds(EPOCH_NS), _nanoseconds(EPOCH_NS)
    time.monotonic, time.monotonic_ns = _seconds(BOOT_NS), _nanoseconds(BOOT_NS)
    time.perf_counter, time.perf_counter_ns = time.monotonic, time.monotonic_ns
    time.process_time, time.process_time_ns = _seconds(0), _nanoseconds(0)
    time.thread_time, time.thread_time_ns = time.process_time, time.process_time_ns
    os.times = lambda: os.times_result((time.process_time(), 0.0, 0.0, 0.0, time.monotonic()))
    resource.getrusage = _getrusage
    time.clock_gettime_ns = _clock_gettime_ns
    time.clock_gettime = lambda clk_id: _clock_gettime_ns(clk_id) / 1e9
    time.localtime = lambda seconds=None: pass_on(real.localtime, _or_now(seconds))
    time.gmtime = lambda seconds=None: pass_on(real.gmtime, _or_now(seconds))
    time.ctime = lambda seconds=None: pass_on(real.ctime, _or_now(seconds))
    time.asctime = lambda when=None: pass_on(real.asctime, when or time.localtime())
    time.strftime = lambda form, when=None: pass_on(real.strftime, form, when or time.localtime())
    # these modules have imported the names
    threading._time = queue.time = sched._time = time.monotonic  # type: ignore[attr-defined]
    _datetime.datetime = _VirtualDatetime  # type: ignore[misc]
    _datetime.date = _VirtualDate  # type: ignore[misc]
    in_c: Any = importlib.import_module("_datetime")
    in_c.datetime, in_c.date = _VirtualDatetime, _VirtualDate


def _sleep(seconds: Any) -> None:
    try:
        duration_ns = int(seconds * 1e9)
    except (TypeError, ValueError, OverflowError):
        pass_on(real.sleep, seconds)  # raises Python's error for what is no number
        raise
    if seconds < 0:
        as_python_does(ValueError("sleep length must be non-negative"))
    SCHEDULER.sleep(duration_ns)


def _seconds(offset_ns: int) -> Callable[[], float]:
    now_ns = _nanoseconds(offset_ns)
    return lambda: now_ns() / 1e9


def _nanoseconds(offset_ns: int) -> Callable[[], int]:
    def now_ns() -> int:
        SCHEDULER.charge()
        return offset_ns + SCHEDULER.now_ns

    return now_ns


def _clock_gettime_ns(clk_id: int) -> int:
    if clk_id in (time.CLOCK_REALTIME, time.CLOCK_TAI):
        return time.time_ns()
    if clk_id in (time.CLOCK_MONOTONIC, time.CLOCK_MONOTONIC_RAW, time.CLOCK_BOOTTIME):
        return time.monotonic_ns()
    if clk_id in (time.CLOCK_PROCESS_CPUTIME_ID, time.CLOCK_THREAD_CPUTIME_ID):
        return time.process_time_ns()
    return int(pass_on(real.clock_gettime_ns, clk_id))


def _getrusage(who: int, /) -> resource.struct_rusage:
    """Return the virtual processor time and the rounded peak of memory; the rest is 0."""
    found = pass_on(_REAL_GETRUSAGE, who)
    used_s = 0.0 if who == resource.RUSAGE_CHILDREN else time.process_time()
    return resource.struct_rusage((used_s, 0.0, found.ru_maxrss // _STEP_KB * _STEP_KB, *[0] * 13))


def _or_now(seconds: Any) -> Any:
    return time.time() if seconds is None else seconds


class _LikeOriginal(type):
    """Objects of the C class count as instances: arithmetic on ours makes those."""

    def __instancecheck__(cls, instance: object) -> bool:
        return cls.__subclasscheck__(type(instance))

    def __subclasscheck__(cls, subclass: type) -> bool:
        original = cls.__dict__.get("ORIGINAL")  # not that of a base: a student may derive too
        return issubclass(subclass, original) if original else super().__subclasscheck__(subclass)


class _VirtualDatetime(_datetime.datetime, metaclass=_LikeOriginal):
    """As `datetime.datetime`, which asks the real clock in C."""

    ORIGINAL = _datetime.datetime

    @classmethod
    def now(cls, tz: Any = None) -> _datetime.datetime:  # type: ignore[override]
        now: _datetime.datetime = pass_on(cls.fromtimestamp, time.time(), tz)
        return now

    today = now  # type: ignore[assignment]

    @classmethod
    def utcnow(cls) -> _datetime.datetime:  # type: ignore[override]
        """Return the time now in UTC."""
        utc = cls.fromtimestamp(time.time(), _datetime.UTC)
        return utc.replace(tzinfo=None)


class _VirtualDate(_datetime.date, metaclass=_LikeOriginal):
    """As `datetime.date`."""

    ORIGINAL = _datetime.date

    @classmethod
    def today(cls) -> _datetime.date:  # type: ignore[override]
        return cls.fromtimestamp(time.time())


_VirtualDatetime.__name__ = _VirtualDatetime.__qualname__ = "datetime"
_VirtualDate.__name__ = _VirtualDate.__qualname__ = "date"
for _class in (_VirtualDatetime, _VirtualDate):
    _class.__module__ = "datetime"

# Chance ---------------------------------------------------------------------------------------

#: Where all random bytes come from, and the seeds of generators that are given none.
_source, _seeds = random.Random(0), [itertools.count(1)]


def seed_chance() -> Callable[[], object]:
    """Seed every source of random numbers, and fix the number of processors.

    Returns:
        A function that returns their state: equal states mean that nothing was drawn between.
    """
    real_seed = random.Random.seed

    def urandom(size: int, /) -> bytes:
        drawn: bytes = pass_on(_source.randbytes, size)
        return drawn

    def getrandom(size: int, flags: int = 0) -> bytes:
        return urandom(size)

    def seed(self: random.Random, a: Any = None, version: int = 2) -> None:
        pass_on(real_seed, self, next(_seeds[0]) if a is None else a, version)

    class Random(_random.Random):
        """As its base, which seeds itself from the system in C."""

        def __init__(self, *args: Any) -> None:
            self.seed(*args)

        def seed(self, a: Any = None, /) -> None:
            pass_on(super().seed, next(_seeds[0]) if a is None else a)

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
    return lambda: (_source.getstate(), repr(_seeds), random.getstate())


def vary_chance(number: int) -> None:
    """Have a program, the second or a later one, draw others than the first."""
    _source.seed(number)
    _seeds[0] = itertools.count(number << 32)
    random.seed(number)


def replace_user_and_devices() -> None:
    """Replace the user, and the devices of random numbers.

    After `seed_chance`, and after the process was confined, which needs the real ones.
    """
    os.getuid = os.geteuid = os.getgid = os.getegid = lambda: USER
    by_number = pwd.getpwuid

    def getpwuid(uid: int, /) -> pwd.struct_passwd:
        home = os.path.expanduser("~")  # noqa: PTH111  as HOME says
        student = ("student", "x", USER, USER, "", home, "/bin/sh")
        return pwd.struct_passwd(student) if uid == USER else pass_on(by_number, uid)

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
