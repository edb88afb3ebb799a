"""Which system calls a submission's process may make: a seccomp filter, as a short BPF program.

All is allowed but what is listed here, with the reason: what changes the machine or the sandbox,
what reaches into other processes, and parts of the kernel that a node never needs and that have
often been a way out. Numbers are Linux's, of `arch/x86/entry/syscalls/syscall_64.tbl` and of
`include/uapi/asm-generic/unistd.h`, which is that of aarch64.

The filter stays for ever, holds for all descendants, and costs nothing where it allows without
looking at arguments: the kernel keeps a table of those.
"""

from __future__ import annotations

import ctypes
import errno
import os
import struct
import sys
from typing import Final

from grader.system import linux

#: A system call's numbers on x86_64 and on aarch64; None where it has none.
Numbers = tuple[int | None, int | None]

#: What is refused whatever its arguments.
REFUSED: Final[dict[str, dict[str, Numbers]]] = {
    "reads, writes or stops another process, or takes its descriptors": {
        "ptrace": (101, 117),
        "process_vm_readv": (310, 270),
        "process_vm_writev": (311, 271),
        "process_madvise": (440, 440),
        "process_mrelease": (448, 448),
        "kcmp": (312, 272),
        "pidfd_getfd": (438, 438),
        "migrate_pages": (256, 238),
        "move_pages": (279, 239),
    },
    "changes what the file system shows: it would uncover what the sandbox hides": {
        "mount": (165, 40),
        "umount2": (166, 39),
        "pivot_root": (155, 41),
        "chroot": (161, 51),
        "open_tree": (428, 428),
        "move_mount": (429, 429),
        "fsopen": (430, 430),
        "fsconfig": (431, 431),
        "fsmount": (432, 432),
        "fspick": (433, 433),
        "mount_setattr": (442, 442),
        "open_tree_attr": (467, 467),
    },
    "gives new namespaces, in which it would have all capabilities, or others' (clone: below)": {
        "unshare": (272, 97),
        "setns": (308, 268),
    },
    "opens files past the folders that lead to them": {
        "name_to_handle_at": (303, 264),
        "open_by_handle_at": (304, 265),
        "fanotify_init": (300, 262),
        "fanotify_mark": (301, 263),
    },
    "reaches keys of the user, which no namespace separates": {
        "add_key": (248, 217),
        "request_key": (249, 218),
        "keyctl": (250, 219),
    },
    "is large, seldom needed, and has often been a way into the kernel; io_uring also makes calls"
    " that no filter sees": {
        "bpf": (321, 280),
        "perf_event_open": (298, 241),
        "userfaultfd": (323, 282),
        "io_uring_setup": (425, 425),
        "io_uring_enter": (426, 426),
        "io_uring_register": (427, 427),
        "modify_ldt": (154, None),
        "lookup_dcookie": (212, 18),
        "nfsservctl": (180, 42),
        "uselib": (134, None),
        "personality": (135, 92),
    },
    "holds memory that no limit of a process counts, or that stays when the process has gone": {
        "memfd_create": (319, 279),
        "memfd_secret": (447, 447),
        "shmget": (29, 194),
        "msgget": (68, 186),
        "semget": (64, 190),
    },
    "is an administrator's: refused without capabilities too, and here in any case": {
        "init_module": (175, 105),
        "finit_module": (313, 273),
        "delete_module": (176, 106),
        "kexec_load": (246, 104),
        "kexec_file_load": (320, 294),
        "reboot": (169, 142),
        "swapon": (167, 224),
        "swapoff": (168, 225),
        "acct": (163, 89),
        "quotactl": (179, 60),
        "quotactl_fd": (443, 443),
        "syslog": (103, 116),
        "vhangup": (153, 58),
        "sethostname": (170, 161),
        "setdomainname": (171, 162),
        "settimeofday": (164, 170),
        "clock_settime": (227, 112),
        "clock_adjtime": (305, 266),
        "iopl": (172, None),
        "ioperm": (173, None),
    },
}
#: Refused where the submission still sees the user's files: Landlock does not check these.
OF_FILES: Final[dict[str, Numbers]] = {
    "chmod": (90, None),
    "fchmod": (91, 52),
    "fchmodat": (268, 53),
    "fchmodat2": (452, 452),
    "chown": (92, None),
    "fchown": (93, 55),
    "lchown": (94, None),
    "fchownat": (260, 54),
    "utime": (132, None),
    "utimes": (235, None),
    "futimesat": (261, None),
    "utimensat": (280, 88),
    "setxattr": (188, 5),
    "lsetxattr": (189, 6),
    "fsetxattr": (190, 7),
    "setxattrat": (463, 463),
    "removexattr": (197, 14),
    "lremovexattr": (198, 15),
    "fremovexattr": (199, 16),
    "removexattrat": (466, 466),
    "file_setattr": (469, 469),
}
#: Calls that seem unknown to the kernel, so that libraries use older ones. The flags of clone3 lie
#: in memory, which a filter cannot read; glibc then uses clone.
#: inotify reports names where nothing may be read (Landlock does not check it), and the user
#: has 128 of them for all programs.
UNKNOWN: Final[dict[str, Numbers]] = {
    "clone3": (435, 435),
    "inotify_init": (253, None),
    "inotify_init1": (294, 26),
    "inotify_add_watch": (254, 27),
}
#: The last system call considered for this list (file_setattr, Linux 6.17): those that came
#: later are as unknown as to an older kernel. Numbers of x32 are larger, too.
NEWEST: Final = 469

#: What depends on arguments: see `_by_arguments`.
CLONE: Final[Numbers] = (56, 220)
IOCTL: Final[Numbers] = (16, 29)
FCNTL: Final[Numbers] = (72, 25)
SOCKET: Final[Numbers] = (41, 198)
SOCKETPAIR: Final[Numbers] = (53, 199)
SETSOCKOPT: Final[Numbers] = (54, 208)
PRLIMIT64: Final[Numbers] = (302, 261)
SCHED_SETSCHEDULER: Final[Numbers] = (144, 119)
#: Their first argument is a process, and 0 the caller.
OF_A_PROCESS: Final[dict[str, Numbers]] = {
    "sched_setaffinity": (203, 122),
    "sched_setattr": (314, 274),
    "sched_setparam": (142, 118),
}
#: Their first argument is the kind of the second: a process (PRIO_PROCESS, IOPRIO_WHO_PROCESS), a
#: group, or all of a user, who is the grader's too.
SETPRIORITY: Final[Numbers] = (141, 140)
IOPRIO_SET: Final[Numbers] = (251, 30)
PRIO_PROCESS, IOPRIO_WHO_PROCESS = 0, 1
SECCOMP: Final[Numbers] = (317, 277)

#: CLONE_NEWNS, -CGROUP, -UTS, -IPC, -USER, -PID and -NET.
NEW_NAMESPACES: Final = 0x7E020000
#: Types into a terminal as if its user did; pastes there; loads a line discipline.
TIOCSTI, TIOCLINUX, TIOCSETD = 0x5412, 0x541C, 0x5423
#: Make others wait before they open a file (F_SETDELEG: from Linux 6.19 on), or report them.
F_SETLEASE, F_NOTIFY, F_SETDELEG = 1024, 1026, 1040
AF_UNIX, AF_INET, AF_INET6, AF_NETLINK = 1, 2, 10, 16
SOCK_STREAM, SOCK_DGRAM, SOCK_SEQPACKET, SOCK_KIND = 1, 2, 5, 0xF
SOL_SOCKET, SO_SNDBUF, SO_RCVBUF = 1, 7, 8
IPPROTO_TCP, IPPROTO_UDP, NETLINK_ROUTE = 6, 17, 0

#: os.uname().machine -> place in `Numbers`, and AUDIT_ARCH_* for the filter.
MACHINES: Final = {"x86_64": (0, 0xC000003E), "aarch64": (1, 0xC00000B7)}

LOAD, JUMP_EQ, JUMP_GT, JUMP_SET, AND, RETURN = 0x20, 0x15, 0x25, 0x45, 0x54, 0x06
ALLOW, ERRNO = 0x7FFF0000, 0x00050000
#: Where in the kernel's `struct seccomp_data` these are [bytes].
NUMBER_AT, ARCH_AT, ARGUMENTS_AT = 0, 4, 16
SECCOMP_SET_MODE_FILTER, SECCOMP_GET_ACTION_AVAIL = 1, 2
#: All threads at once; and no slower for guarding against what threads of one process could learn.
TSYNC, SPEC_ALLOW = 1, 4

#: An instruction of BPF: code, how many to skip if true, if false, and a constant.
Instruction = tuple[int, int, int, int]


def is_there() -> bool:
    """Whether `install` works here."""
    found = MACHINES.get(os.uname().machine)
    if found is None or sys.maxsize < 1 << 32 or sys.byteorder != "little":
        return False
    try:
        _seccomp(found[0], SECCOMP_GET_ACTION_AVAIL, 0, struct.pack("=I", ERRNO))
    except OSError:
        return False
    return True


def install(*, is_apart: bool = True) -> None:
    """Install the filter in the calling process, all its threads, and all that it starts.

    With it comes `no_new_privs`: no program that it starts has more rights than it has.

    Args:
        is_apart: it has a network and a file system of its own, so that sockets lead nowhere
            else. If not, it gets none by which it could reach other programs' (TCP, or Unix's by
            path) beside the UDP that DDS needs.
    """
    if not is_there():
        raise OSError(errno.ENOSYS, f"no system call filters on this {os.uname().machine}")
    place, _ = MACHINES[os.uname().machine]
    instructions = program(os.uname().machine, is_apart=is_apart)
    code = b"".join(struct.pack("=HBBI", *each) for each in instructions)
    memory = ctypes.create_string_buffer(code, len(code))
    pointer = struct.pack("@HP", len(instructions), ctypes.addressof(memory))
    linux.forbid_new_privileges()
    try:
        other = _seccomp(place, SECCOMP_SET_MODE_FILTER, TSYNC | SPEC_ALLOW, pointer)
    except OSError as error:
        if error.errno != errno.EINVAL:
            raise
        other = _seccomp(place, SECCOMP_SET_MODE_FILTER, TSYNC, pointer)  # before Linux 4.17
    if other:
        raise OSError(errno.EPERM, f"no system call filter: thread {other} has another")


def _seccomp(place: int, *words: int | bytes) -> int:
    number = SECCOMP[place]
    assert number is not None
    return linux.system_call(number, *words, of="system call filter")


def program(machine: str, *, is_apart: bool = True) -> list[Instruction]:
    """The filter for a machine of `MACHINES`."""
    place, arch = MACHINES[machine]
    lines = [
        (LOAD, 0, 0, ARCH_AT),
        (JUMP_EQ, 1, 0, arch),
        _refuse(errno.ENOSYS),  # those of 32 bits have numbers of their own
        (LOAD, 0, 0, NUMBER_AT),
        (JUMP_GT, 0, 1, NEWEST),
        _refuse(errno.ENOSYS),
    ]
    for group in REFUSED.values():
        lines += _each(group, place, [_refuse(errno.EPERM)])
    if not is_apart:
        lines += _each(OF_FILES, place, [_refuse(errno.EPERM)])
    lines += _each(UNKNOWN, place, [_refuse(errno.ENOSYS)])
    return [*lines, *_by_arguments(place, is_apart=is_apart), (RETURN, 0, 0, ALLOW)]


def _by_arguments(place: int, *, is_apart: bool) -> list[Instruction]:
    """The rules for calls that may be harmless. Of arguments the kernel uses the lower 32 bits."""
    refused, allowed = _refuse(errno.EPERM), (RETURN, 0, 0, ALLOW)
    no_family = _refuse(errno.EAFNOSUPPORT)
    spaces = [_load(0), (JUMP_SET, 0, 1, NEW_NAMESPACES), refused, allowed]
    terminal = [_load(1), *_if(refused, TIOCSTI, TIOCLINUX, TIOCSETD), allowed]
    others = [_load(1), *_if(refused, F_SETLEASE, F_NOTIFY, F_SETDELEG), allowed]
    # What lies in sockets counts as nobody's memory. A request for more room is ignored.
    room = [_load(1), *_unless(SOL_SOCKET, allowed), _load(2)]
    room += [*_if(_refuse(0), SO_SNDBUF, SO_RCVBUF), allowed]
    # Limits and priorities of the user's other processes: it could make the simulator starve.
    itself = [_load(0), *_if(allowed, 0), refused]
    itself_second = [_load(1), *_if(allowed, 0), refused]
    # Fast DDS sets each of its threads, by number, to ordinary scheduling.
    ordinary = [*itself[:-1], *itself_second]
    kind = [_load(1), (AND, 0, 0, SOCK_KIND)]
    udp = [*kind, *_unless(SOCK_DGRAM, no_family)]
    protocols = [_load(2), *_if(allowed, 0, IPPROTO_TCP, IPPROTO_UDP), no_family]
    if is_apart:
        udp = [*kind, (JUMP_EQ, 2, 0, SOCK_DGRAM), (JUMP_EQ, 1, 0, SOCK_STREAM), no_family]
    internet = [*udp, *protocols]
    # Which interfaces there are, for DDS; nothing else of netlink.
    route = [_load(2), *_if(allowed, NETLINK_ROUTE), no_family]
    by_path = [allowed] if is_apart else [no_family]
    sockets = [
        _load(0),
        *_case(AF_UNIX, by_path),
        *_case(AF_NETLINK, route),
        (JUMP_EQ, 2, 0, AF_INET),
        (JUMP_EQ, 1, 0, AF_INET6),
        no_family,
        *internet,
    ]
    # A pair is no way out; but one of datagrams can be sent from to any path.
    connected = [] if is_apart else [*kind, *_if(allowed, SOCK_STREAM, SOCK_SEQPACKET), no_family]
    pairs = [_load(0), *_unless(AF_UNIX, no_family), *connected, allowed]
    return [
        *_call(CLONE[place], spaces),
        *_call(IOCTL[place], terminal),
        *_call(FCNTL[place], others),
        *_call(SETSOCKOPT[place], room),
        *_call(PRLIMIT64[place], itself),
        *_call(SCHED_SETSCHEDULER[place], ordinary),
        *_each(OF_A_PROCESS, place, itself),
        *_call(SETPRIORITY[place], [_load(0), *_case(PRIO_PROCESS, itself_second), refused]),
        *_call(IOPRIO_SET[place], [_load(0), *_case(IOPRIO_WHO_PROCESS, itself_second), refused]),
        *_call(SOCKET[place], sockets),
        *_call(SOCKETPAIR[place], pairs),
    ]


def _refuse(number: int) -> Instruction:
    return (RETURN, 0, 0, ERRNO | number)


def _load(argument: int) -> Instruction:
    """The lower half of an argument; on both machines it comes first."""
    return (LOAD, 0, 0, ARGUMENTS_AT + 8 * argument)


def _case(value: int, then: list[Instruction]) -> list[Instruction]:
    """What is done, to its end, if the loaded word is this one."""
    return [(JUMP_EQ, 0, len(then), value), *then]


def _call(number: int | None, then: list[Instruction]) -> list[Instruction]:
    return [] if number is None else _case(number, then)


def _each(calls: dict[str, Numbers], place: int, then: list[Instruction]) -> list[Instruction]:
    return [line for numbers in calls.values() for line in _call(numbers[place], then)]


def _if(then: Instruction, *values: int) -> list[Instruction]:
    return [line for value in values for line in _case(value, [then])]


def _unless(value: int, otherwise: Instruction) -> list[Instruction]:
    return [(JUMP_EQ, 1, 0, value), otherwise]
