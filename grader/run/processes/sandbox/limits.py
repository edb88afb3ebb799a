"""How much of the machine a submission may use: the kernel's limits for each of its processes.

The kernel counts these itself, everywhere and without rights. It counts memory and processor time
for each process alone, so `Limits.family_bytes`, which is for all of them together, is watched from
outside instead: `grader.run.processes.appetite`.
"""

from __future__ import annotations

import os
import resource
from typing import NamedTuple

KIB, MIB, GIB = 1 << 10, 1 << 20, 1 << 30


class Limits(NamedTuple):
    """What a submission may use; no dataclass, since importing those takes longer than the rest.

    A node of rclpy has 13 to 20 threads, 20 open files, 0.25 GiB of data, mostly stacks that nobody
    touches, 1 GiB of addresses, and really uses 65 MiB.

    Attributes:
        cpu_s: processor time of one process [s]; the kernel then ends it with SIGXCPU. Far more
            than a run in virtual time is given (`Patience.run_cpu_s`), or one in real time uses.
        family_bytes: memory that all its processes really use at once [bytes].
        family_files: descriptors of all its processes together. What lies in a socket, some hundred
            KiB at most, counts as nobody's memory.
        output_bytes: what all its processes print together [bytes].
        data_bytes: private memory that one process may ask for, used or not [bytes].
        address_bytes: all addresses of one process [bytes]: what it shares counts here, and the
            tables of pages that it only reads, which nothing else limits. malloc reserves 64 MiB
            of these for each thread.
        tasks: processes and threads at once, of the user in this user namespace.
        open_files: descriptors of one process. Linux counts those that lie in sockets for each
            user, and refuses more than who sends them may have open: far fewer than the grader's.
        file_bytes: the length of one file [bytes]; a write past it fails, with SIGXFSZ for who does
            not ignore that, as Python does.
        stack_bytes: of the first thread, and of each other that asks for no size [bytes].
        most_stack_bytes: to which a process may raise that [bytes].
        locked_bytes: memory that may not be swapped out [bytes].
        queue_bytes: POSIX message queues [bytes], which would outlive the run.
        signals: queued signals and timers, of the user.
    """

    cpu_s: int = 600
    family_bytes: int = 1 * GIB
    family_files: int = 4096
    output_bytes: int = 32 * MIB
    data_bytes: int = 2 * GIB
    address_bytes: int = 16 * GIB
    tasks: int = 256
    open_files: int = 256
    file_bytes: int = 64 * MIB
    stack_bytes: int = 8 * MIB
    most_stack_bytes: int = 64 * MIB
    locked_bytes: int = 1 * MIB
    queue_bytes: int = 0
    signals: int = 1024


LIMITS = Limits()


def size(number_bytes: int) -> str:
    """As people say it: "1 GiB", "64 MiB"."""
    if number_bytes >= GIB and number_bytes % GIB == 0:
        return f"{number_bytes // GIB} GiB"
    return f"{number_bytes // MIB} MiB"


def apply(limits: Limits = LIMITS, *, is_alone: bool = True) -> None:
    """Limit the calling process and all that it starts; nothing that is lower already is raised.

    Nobody without the capability CAP_SYS_RESOURCE can undo it.

    Args:
        is_alone: the process's user has nothing else running in its user namespace. If not, the
            limit of processes, which is the user's, leaves room for all that run on the machine.
            It does not hold for the machine's root.
    """
    tasks = limits.tasks + (0 if is_alone else _tasks_of_all())
    for name, soft, hard in (
        # SIGXCPU at the one, which can be ignored, and SIGKILL at the other
        ("CPU", limits.cpu_s, limits.cpu_s + 5),
        ("DATA", limits.data_bytes, limits.data_bytes),
        ("AS", limits.address_bytes, limits.address_bytes),
        ("NPROC", tasks, tasks),
        ("NOFILE", limits.open_files, limits.open_files),
        ("FSIZE", limits.file_bytes, limits.file_bytes),
        ("CORE", 0, 0),  # a core dump of 1 GiB, in whatever folder it is in
        ("STACK", limits.stack_bytes, limits.most_stack_bytes),
        ("MEMLOCK", limits.locked_bytes, limits.locked_bytes),
        ("MSGQUEUE", limits.queue_bytes, limits.queue_bytes),
        ("SIGPENDING", limits.signals, limits.signals),
        ("RTPRIO", 0, 0),  # no priority over others, where the user's limits would give it one
        ("NICE", 0, 0),
    ):
        number = getattr(resource, f"RLIMIT_{name}", None)
        if number is not None:
            lower(number, soft, hard)


def lower(number: int, soft: int, hard: int) -> None:
    """Limit a resource of the calling process, unless it is limited to less already."""
    now_soft, now_hard = resource.getrlimit(number)
    hard = _lesser(hard, now_hard)
    resource.setrlimit(number, (_lesser(_lesser(soft, now_soft), hard), hard))


def _lesser(one: int, other: int) -> int:
    if resource.RLIM_INFINITY in (one, other):
        return other if one == resource.RLIM_INFINITY else one
    return min(one, other)


def _tasks_of_all() -> int:
    """All processes and threads of the machine: "0.42 0.17 0.07 2/345 6789"."""
    try:
        fd = os.open("/proc/loadavg", os.O_RDONLY)
        try:
            return int(os.read(fd, 200).split()[3].partition(b"/")[2])
        finally:
            os.close(fd)
    except (OSError, IndexError, ValueError):
        return 1 << 16
