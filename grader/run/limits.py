"""The table of limits: how much a run may use of the machine, and why so much.

Four mechanisms enforce them, each where the others cannot. The kernel limits every process by
itself (`rlimits`; `grader.run.sandbox.confinement` sets them). A thread of the grader adds up what
all processes of a submission use (`grader.run.processes.limits_guard`). The simulator notices when
nothing comes from a submission in virtual time (`Patience`). A supervisor ends what is left when a
run is over (`grader.run.processes.supervisor`). A course may bound the processor time of a grading
as a whole (`CpuBudget`).

A step of an inspection (`grader.submission.examining.steps`), the link of virtual time
(`grader.run.lockstep.protocol`) and the reading of a submission (`grader.submission.reader`)
have limits of their own.
"""

from __future__ import annotations

import math
import resource
from dataclasses import dataclass
from pathlib import Path
from threading import Lock
from typing import Final, NamedTuple

from grader.text.message import Message, msg

MIB, GIB = 1 << 20, 1 << 30


class RunLimits(NamedTuple):
    """What a submission may use in a run.

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
            user, and refuses more than their sender may have open: far fewer than the grader's.
        file_bytes: the length of one file [bytes]; a write past it fails, with SIGXFSZ unless that
            is ignored, as Python does.
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


LIMITS: Final = RunLimits()
#: Folders of a submission's own root that are made of memory: how much, how many files. As much as
#: the longest file may have; what is in them counts as memory of all its processes as well.
SCRATCH: Final = {"/tmp": (64, 8192), "/dev/shm": (64, 1024)}  # [MiB]
#: What a submission may add to the copy of it that lies in memory [MiB], [files].
ROOM: Final = (24, 8192)
#: Of what a process prints, so much of its start and of its end is kept [bytes]: a recording holds
#: it, and people read it.
KEPT_OUTPUT_BYTES: Final = 32_768

#: Memory of a simulator's process [bytes]; a run uses 0.2 GB, and what may come from a submission
#: at most as much again.
SIMULATOR_BYTES: Final = 3_000_000_000
#: How long a simulator may take to come up, to do anything at all, and to save what it has recorded
#: [s]: it is ours, and only an overloaded machine takes so long.
SIMULATOR_S: Final = 60.0
#: How long a scene may take for a tick [s]; it is then named, before its simulator is given up.
SCENE_S: Final = 30.0
#: What it records [bytes]: more than any run leaves; the grader's process holds it a few times.
RECORDING_BYTES: Final = 256_000_000
#: How long a submission's process may take to come up, its own code not counted [s].
START_S: Final = 30.0
#: How long one may take to end after it closed its link or was killed [s]; a busy machine is slow.
END_S: Final = 20.0
#: How long a run in real time waits for the submission's first node before its clock starts [s].
FIRST_NODE_S: Final = 8.0

#: Whatever a package does has come to an end by then [s]: its steps have an account of processor
#: time and waiting. More is the machine's doing, and no verdict.
INSPECTION_S: Final = 900.0
#: What an inspection leaves [bytes].
INSPECTION_BYTES: Final = 32_000_000


@dataclass(frozen=True)
class Patience:
    """How long a submission's process is waited for in virtual time, in real seconds.

    Processor time is that of the process alone: other load on the machine decides nothing.

    Attributes:
        stall_cpu_s: it has stalled when it sends nothing for so much of its own processor time,
        start_cpu_s: or for so much while it still imports.
        asleep_s: it waits for something outside of virtual time when it sleeps for so long,
        all_asleep_s: or for so long in a whole run, not counting naps.
        run_cpu_s: so much of its own processor time a whole run may take.
        simulator_cpu_s: so much the simulator may use for what the submission sends; beside one
            that only drives it uses about one second.
    """

    stall_cpu_s: float = 6.0
    start_cpu_s: float = 20.0
    asleep_s: float = 6.0
    all_asleep_s: float = 60.0
    run_cpu_s: float = 120.0
    simulator_cpu_s: float = 60.0


class CpuBudget:
    """The processor time that all processes of one grading may use together.

    Processor time, since a busy machine must decide nothing. Its runs spend it from several
    threads.

    Args:
        cpu_s: so much processor time [s].

    Attributes:
        spent_s: so much of it was used [s].
    """

    def __init__(self, cpu_s: float = math.inf) -> None:
        self._cpu_s = cpu_s
        self.spent_s = 0.0
        self._lock = Lock()

    def spend(self, cpu_s: float) -> None:
        """Count so much more as used [s]."""
        with self._lock:
            self.spent_s += cpu_s

    @property
    def is_spent(self) -> bool:
        """Whether more was used than there was: what still runs is to be ended."""
        return self.spent_s > self._cpu_s

    @property
    def remark(self) -> Message:
        """The remark for the result of a run that was ended, or not started."""
        return msg(
            "the whole grading used more than {seconds} s of processor time",
            seconds=f"{self._cpu_s:g}",
        )


def rlimits(limits: RunLimits = LIMITS, *, is_alone: bool) -> list[tuple[int, int, int]]:
    """Return the kernel's limits of each process of a submission: resource, soft and hard limit.

    Args:
        is_alone: the process's user has nothing else running in its user namespace. If not, the
            limit of processes, which is the user's, leaves room for all that run on the machine.
            It does not hold for the machine's root.
    """
    tasks = limits.tasks + (0 if is_alone else _tasks_of_all())
    return [
        # SIGXCPU at the one, which can be ignored, and SIGKILL at the other
        (resource.RLIMIT_CPU, limits.cpu_s, limits.cpu_s + 5),
        (resource.RLIMIT_DATA, limits.data_bytes, limits.data_bytes),
        (resource.RLIMIT_AS, limits.address_bytes, limits.address_bytes),
        (resource.RLIMIT_NPROC, tasks, tasks),
        (resource.RLIMIT_NOFILE, limits.open_files, limits.open_files),
        (resource.RLIMIT_FSIZE, limits.file_bytes, limits.file_bytes),
        (resource.RLIMIT_CORE, 0, 0),  # a core dump of 1 GiB, in whatever folder it is in
        (resource.RLIMIT_STACK, limits.stack_bytes, limits.most_stack_bytes),
        (resource.RLIMIT_MEMLOCK, limits.locked_bytes, limits.locked_bytes),
        (resource.RLIMIT_MSGQUEUE, limits.queue_bytes, limits.queue_bytes),
        (resource.RLIMIT_SIGPENDING, limits.signals, limits.signals),
        # no priority over others, where the user's limits would give it one
        (resource.RLIMIT_RTPRIO, 0, 0),
        (resource.RLIMIT_NICE, 0, 0),
    ]


def _tasks_of_all() -> int:
    """Count the processes and threads of the machine, from "0.42 0.17 0.07 2/345 6789"."""
    try:
        return int(Path("/proc/loadavg").read_text().split()[3].partition("/")[2])
    except (OSError, IndexError, ValueError):
        return 1 << 16


def size(number_bytes: int) -> str:
    """Format a size for people: "1 GiB", "64 MiB"."""
    if number_bytes >= GIB and number_bytes % GIB == 0:
        return f"{number_bytes // GIB} GiB"
    return f"{number_bytes // MIB} MiB"
