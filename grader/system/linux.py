"""Linux's calls that Python lacks, limits of resources, /proc/PID/stat.

Imports little of the standard library and nothing else: processes that import this start in a few
milliseconds. Elsewhere than on Linux each call is refused as unknown.
"""

from __future__ import annotations

import ctypes
import errno
import itertools
import os
import resource
from collections.abc import Collection, Mapping, Set
from typing import Any, NamedTuple

CLONE_NEWNS, CLONE_NEWIPC, CLONE_NEWUSER = 0x00020000, 0x08000000, 0x10000000
CLONE_NEWPID, CLONE_NEWNET = 0x20000000, 0x40000000
#: As /proc/sys/user calls them.
KINDS = {
    **{CLONE_NEWNS: "mnt", CLONE_NEWIPC: "ipc", CLONE_NEWUSER: "user"},
    **{CLONE_NEWPID: "pid", CLONE_NEWNET: "net"},
}
MS_RDONLY, MS_NOSUID, MS_NODEV, MS_NOEXEC, MS_REMOUNT = 1, 2, 4, 8, 32
MS_BIND, MS_REC, MS_PRIVATE = 0x1000, 0x4000, 0x40000
MNT_DETACH = 2
MOUNT_ATTR_RDONLY, MOUNT_ATTR_NOSUID, MOUNT_ATTR_NODEV = 1, 2, 4
AT_FDCWD, AT_RECURSIVE = -100, 0x8000
PR_SET_PDEATHSIG, PR_SET_DUMPABLE, PR_CAPBSET_DROP, PR_SET_SECUREBITS = 1, 4, 24, 28
PR_SET_CHILD_SUBREAPER, PR_SET_NO_NEW_PRIVS = 36, 38
PR_CAP_AMBIENT, PR_CAP_AMBIENT_CLEAR_ALL = 47, 4
SIOCSIFFLAGS, IFF_UP, IFF_RUNNING = 0x8914, 0x1, 0x40
#: The number of pivot_root, which the C library lacks; that of mount_setattr is the same anywhere.
_PIVOT_ROOT = {"x86_64": 155, "aarch64": 41}
_MOUNT_SETATTR = 442
_CAPABILITY_VERSION = 0x20080522
TICKS_PER_S = os.sysconf("SC_CLK_TCK")
PAGE_BYTES = os.sysconf("SC_PAGE_SIZE")
#: More than any process here may have open.
_MOST_DESCRIPTORS = 1 << 16

_libc: Any = ctypes.CDLL(None, use_errno=True)


# Calls ----------------------------------------------------------------------------------------


def call(function: str, *arguments: object) -> int:
    """Call a function of the C library that returns less than 0 where it fails, with errno set."""
    there = getattr(_libc, function, None)
    if there is None:
        raise OSError(errno.ENOSYS, "there is none here", function)
    answer = int(there(*arguments))
    if answer < 0:
        number = ctypes.get_errno()
        raise OSError(number, os.strerror(number), function)
    return answer


def system_call(number: int, *words: int | bytes | None, of: str = "syscall") -> int:
    """Make a system call that the C library has no function for; `of` names it in errors."""
    passed = [ctypes.c_ulong(word) if isinstance(word, int) else word for word in words]
    try:
        return call("syscall", ctypes.c_long(number), *passed)
    except OSError as error:
        raise OSError(error.errno, error.strerror, of) from None


def unshare(kinds: int) -> None:
    """Leave the namespaces that the calling thread shares with others."""
    try:
        call("unshare", kinds)
    except OSError as error:
        names = ", ".join(name for kind, name in KINDS.items() if kinds & kind)
        raise OSError(error.errno, error.strerror, f"unshare ({names})") from None


def unshare_user(uid: int, proc: int, kinds: int = 0) -> None:
    """Enter a new user namespace as this user and group, and new ones of other kinds.

    There are no rights over what was made in the one before, such as mounts and networks.

    Args:
        proc: a descriptor of this process's folder in a writable /proc.
    """
    user, group = os.getuid(), os.getgid()
    unshare(CLONE_NEWUSER | kinds)
    for name, text in (
        ("setgroups", "deny"),
        ("uid_map", f"{uid} {user} 1"),
        ("gid_map", f"{uid} {group} 1"),
    ):
        file = os.open(name, os.O_WRONLY, dir_fd=proc)
        os.write(file, text.encode())
        os.close(file)


def enter(namespace: int, kind: int) -> None:
    """Move the calling thread into a namespace, given as an open descriptor."""
    call("setns", namespace, kind)


def mount(kind: str, target: str, flags: int, data: str = "", source: str = "none") -> None:
    """Mount a file system that needs no device; or, with MS_BIND, a folder or file again."""
    words = (os.fsencode(source), os.fsencode(target), kind.encode())
    call("mount", *words, ctypes.c_ulong(flags), data.encode())


def change_mount(target: str, added: int, removed: int = 0, *, below: bool = False) -> None:
    """Add attributes to a mount and remove others; `below`: also for the mounts below it."""
    attributes = bytes((ctypes.c_uint64 * 4)(added, removed, 0, 0))
    flags = AT_RECURSIVE if below else 0
    system_call(_MOUNT_SETATTR, AT_FDCWD, os.fsencode(target), flags, attributes, len(attributes))


def change_root() -> None:
    """Make the current folder, a mount, the root; the old root is detached."""
    number = _PIVOT_ROOT.get(os.uname().machine)
    if number is None:
        raise OSError(errno.ENOSYS, f"no pivot_root known for {os.uname().machine}")
    system_call(number, b".", b".")
    call("umount2", b".", ctypes.c_int(MNT_DETACH))
    os.chdir("/")


def control(option: int, *values: int) -> bool:
    """Call prctl; return whether it succeeded."""
    words = [ctypes.c_ulong(value) for value in (*values, 0, 0, 0, 0)[:4]]
    there = getattr(_libc, "prctl", None)
    return there is not None and bool(there(option, *words) == 0)


def signal_at_parents_death(number: int) -> None:
    """Have the kernel send us a signal when our parent dies."""
    control(PR_SET_PDEATHSIG, number)


def go_with_parent(parent: int, number: int) -> None:
    """Have the kernel send us a signal when this parent dies; end where it has died before."""
    signal_at_parents_death(number)
    if os.getppid() != parent:
        os._exit(1)


def forbid_new_privileges() -> None:
    """Keep programs that are started from now on from gaining privileges."""
    if not control(PR_SET_NO_NEW_PRIVS, 1):
        raise OSError(errno.EINVAL, os.strerror(errno.EINVAL), "no_new_privs")


def set_capabilities(permitted: int = 0) -> None:
    """Set the capabilities to exactly these bits; none is inherited."""
    low, high = permitted & 0xFFFFFFFF, permitted >> 32
    header = (ctypes.c_uint32 * 2)(_CAPABILITY_VERSION, 0)
    call("capset", header, (ctypes.c_uint32 * 6)(low, low, 0, high, high, 0))


def raise_loopback() -> None:
    """Bring up the loopback device of the calling thread's network namespace."""
    import fcntl  # here, because a submission's process has no need of them and is to start soon
    import socket
    import struct

    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as any_socket:
        fcntl.ioctl(any_socket, SIOCSIFFLAGS, struct.pack("16sh14x", b"lo", IFF_UP | IFF_RUNNING))


def close_descriptors(kept: Collection[int]) -> None:
    """Close all open files of this process but these descriptors."""
    # not by /proc, which a copy of a process may not list at the level `landlock`
    for before, after in itertools.pairwise((-1, *sorted(kept), _MOST_DESCRIPTORS)):
        if before + 1 < after:  # closerange(0, 0) closes all
            os.closerange(before + 1, after)


# Limits of resources --------------------------------------------------------------------------


def resource_limits() -> list[tuple[int, int, int]]:
    """Return this process's limit of every resource: its number, the soft and the hard limit."""
    numbers = sorted({getattr(resource, n) for n in dir(resource) if n.startswith("RLIMIT_")})
    return [(number, *resource.getrlimit(number)) for number in numbers]


def set_limit(number: int, soft: int, hard: int) -> None:
    """Set a limit of the calling process, if it is not this already."""
    if resource.getrlimit(number) != (soft, hard):
        resource.setrlimit(number, (soft, hard))


def lower_limit(number: int, soft: int, hard: int) -> None:
    """Lower a limit of the calling process; a lower one stays."""
    now_soft, now_hard = resource.getrlimit(number)
    hard = _lesser(hard, now_hard)
    resource.setrlimit(number, (_lesser(_lesser(soft, now_soft), hard), hard))


def _lesser(one: int, other: int) -> int:
    if resource.RLIM_INFINITY in (one, other):
        return other if one == resource.RLIM_INFINITY else one
    return min(one, other)


# Processes ------------------------------------------------------------------------------------


class ProcessStat(NamedTuple):
    """The state and usage of a process; all zero where there is none.

    Attributes:
        state: the kernel's letter for its state; '' if there is no such process.
        parent: the process id of its parent.
        ticks: the processor time that it has used [ticks].
        waited_ticks: that of the children that it has waited for [ticks].
        tasks: the number of its threads.
        memory_bytes: its pages, with those of files and those that it shares.
        env: where its environment at its start begins and ends [addresses].
    """

    state: str = ""
    parent: int = 0
    ticks: int = 0
    waited_ticks: int = 0
    tasks: int = 0
    memory_bytes: int = 0
    env: tuple[int, int] = (0, 0)

    @property
    def cpu_s(self) -> float:
        """The processor time that it has used [s]."""
        return self.ticks / TICKS_PER_S

    @property
    def is_stopped(self) -> bool:
        """Whether it was stopped, by SIGSTOP or by a debugger."""
        return self.state in ("T", "t")

    @property
    def has_ended(self) -> bool:
        """Whether there is no such process, or only its exit code."""
        return self.state in ("", "Z", "X")


def process_stat(pid: int) -> ProcessStat:
    """Read /proc/PID/stat of a process; see proc_pid_stat(5)."""
    try:
        with open(f"/proc/{pid}/stat", "rb", buffering=0) as file:  # noqa: PTH123  pathlib is slow
            state, *words = file.readall().rpartition(b")")[2].split()
    except OSError:
        return ProcessStat()
    # the number of a word is that of the manual's field less four
    parent, (user, system, *waited) = int(words[0]), map(int, words[10:14])
    tasks, pages, env = int(words[16]), int(words[20]), (int(words[46]), int(words[47]))
    letter = state.decode("ascii")
    return ProcessStat(letter, parent, user + system, sum(waited), tasks, pages * PAGE_BYTES, env)


def process_ids() -> set[int]:
    """Return the ids of all processes that /proc shows."""
    return {int(name) for name in os.listdir("/proc") if name.isdigit()}  # noqa: PTH208


def descendants(ancestor: int) -> dict[int, ProcessStat]:
    """Return all processes below one, as /proc shows them: its children, theirs, and so on.

    A zombie counts: its threads may still run.
    """
    stats = {pid: process_stat(pid) for pid in process_ids()}
    return {pid: stats[pid] for pid in below({ancestor}, stats)}


def below(ancestors: Set[int], stats: Mapping[int, ProcessStat]) -> set[int]:
    """Return the processes that descend from one of these ancestors."""
    found = set(ancestors)
    while more := {pid for pid, stat in stats.items() if stat.parent in found} - found:
        found |= more
    return found - ancestors
