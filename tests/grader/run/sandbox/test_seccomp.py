"""The system call filter: its program, interpreted here for both machines, and at work."""

import ctypes
import errno
import os
import re
import resource
import signal
import socket
import subprocess
import sys
import threading
from pathlib import Path
from typing import Any

import pytest
import yaml

from grader.run.sandbox import seccomp
from tests.children import NOBODYS_UID, error_of, in_child
from tests.programs import ran
from tests.tiers import that_apply

TEXTS = yaml.safe_load(Path(__file__).with_suffix(".yaml").read_text())

needs_seccomp = pytest.mark.applies(seccomp.is_there(), reason="there are filters of system calls")
ROOT = Path(__file__).parents[4]
EPERM, ENOSYS, EAFNOSUPPORT = errno.EPERM, errno.ENOSYS, errno.EAFNOSUPPORT
HEADERS = {
    "x86_64": Path("/usr/include/x86_64-linux-gnu/asm/unistd_64.h"),
    "aarch64": Path("/usr/include/asm-generic/unistd.h"),
}
CLONE_THREAD_OF_GLIBC = 0x3D0F00
CLONE_NEWUSER = 0x10000000
#: Linux's own numbers: what Python's socket module has depends on where it was built.
AF_VSOCK, AF_PACKET, AF_ALG, AF_BLUETOOTH = 40, 17, 38, 31
NETLINK_AUDIT, IPPROTO_SCTP, IPPROTO_MPTCP = 9, 132, 262
DGRAM, STREAM, SEQPACKET, RAW = 2, 1, 5, 3
CLOEXEC = 0o2000000
LOW = (1 << 32) - 1


@pytest.fixture(params=sorted(seccomp.MACHINES))
def machine(request):
    return str(request.param)


@pytest.fixture(params=[True, False])
def apart(request):
    """Whether a process has a network of its own."""
    return bool(request.param)


def interpret(program: list[seccomp.Instruction], words: dict[int, int]) -> int:
    """What a filter answers to a call, given as the kernel's `struct seccomp_data` by offsets."""
    word, at = 0, 0
    while True:
        code, if_true, if_false, constant = program[at]
        at += 1
        if code == seccomp.RETURN:
            return constant
        if code == seccomp.LOAD:
            word = words.get(constant, 0)
        elif code == seccomp.AND:
            word &= constant
        else:
            holds = {
                seccomp.JUMP_EQ: word == constant,
                seccomp.JUMP_GT: word > constant,
                seccomp.JUMP_SET: bool(word & constant),
            }[code]
            at += if_true if holds else if_false


def answer(
    machine: str, number: int | None, *arguments: int, apart: bool = True, arch: int = 0
) -> int:
    """The error that a call ends with; 0 where it is allowed."""
    words = {seccomp.NUMBER_AT: number, seccomp.ARCH_AT: arch or seccomp.MACHINES[machine][1]}
    for place, argument in enumerate(arguments):
        words[seccomp.ARGUMENTS_AT + 8 * place] = argument & LOW
        words[seccomp.ARGUMENTS_AT + 8 * place + 4] = argument >> 32
    found = interpret(seccomp.program(machine, is_apart=apart), words)
    if found == seccomp.ALLOW:
        return 0
    assert found & ~0xFFFF == seccomp.ERRNO
    return found & 0xFFFF


def every_number(machine: str) -> dict[str, int]:
    place = seccomp.MACHINES[machine][0]
    groups = [*seccomp.REFUSED.values(), seccomp.UNKNOWN, seccomp.OF_A_PROCESS]
    groups.append(seccomp.OF_FILES)
    names = "clone ioctl fcntl socket socketpair setsockopt prlimit64 sched_setscheduler"
    names += " setpriority ioprio_set"
    single = {name: getattr(seccomp, name.upper()) for name in [*names.split(), "seccomp"]}
    found = {name: numbers[place] for group in [*groups, single] for name, numbers in group.items()}
    return {name: number for name, number in found.items() if number is not None}


@pytest.mark.more("the headers of the kernel are not everywhere; every call is made below")
@pytest.mark.parametrize(
    "machine", that_apply("there are headers", {name: HEADERS[name].exists() for name in HEADERS})
)
def test_numbers_are_those_of_the_kernels_headers(machine):
    found = re.findall(r"^#define __NR(?:3264)?_(\w+) (\d+)$", HEADERS[machine].read_text(), re.M)
    there, ours = {name: int(number) for name, number in found}, every_number(machine)
    both = ours.keys() & there.keys()
    assert {name: there[name] for name in both} == {name: ours[name] for name in both}
    assert len(both) > 50


def test_no_number_stands_for_two_calls(machine):
    numbers = list(every_number(machine).values())
    assert len(numbers) == len(set(numbers))


def test_a_listed_call_is_refused_whatever_its_arguments(machine):
    place = seccomp.MACHINES[machine][0]
    for numbers in (each for group in seccomp.REFUSED.values() for each in group.values()):
        if numbers[place] is not None:
            assert answer(machine, numbers[place], 1, 2, 3) == EPERM


def test_whose_files_are_in_sight_are_not_opened_to_others(machine, apart):
    place = seccomp.MACHINES[machine][0]
    for numbers in seccomp.OF_FILES.values():
        if numbers[place] is not None:
            assert answer(machine, numbers[place], apart=apart) == (0 if apart else EPERM)


def test_calls_of_other_machines_and_later_kernels_are_unknown(machine):
    i386, x32_bit = 0x40000003, 0x40000000
    assert answer(machine, 1, arch=i386) == ENOSYS
    assert answer(machine, x32_bit | 101) == ENOSYS
    assert answer(machine, seccomp.NEWEST + 1) == ENOSYS
    assert answer(machine, LOW) == ENOSYS
    place = seccomp.MACHINES[machine][0]
    for numbers in seccomp.UNKNOWN.values():
        if numbers[place] is not None:
            assert answer(machine, numbers[place], 1, 2) == ENOSYS
    assert answer(machine, x32_bit | seccomp.FCNTL[place], 3, seccomp.F_SETLEASE) == ENOSYS


def test_threads_and_processes_are_made_but_no_namespaces(machine):
    number = seccomp.CLONE[seccomp.MACHINES[machine][0]]
    assert answer(machine, number, CLONE_THREAD_OF_GLIBC) == 0
    assert answer(machine, number, signal.SIGCHLD) == 0
    for bit in (17, 25, 26, 27, 28, 29, 30):
        assert answer(machine, number, 1 << bit | signal.SIGCHLD) == EPERM


def test_nothing_is_typed_into_a_terminal(machine):
    number = seccomp.IOCTL[seccomp.MACHINES[machine][0]]
    fionread, tiocgwinsz = 0x541B, 0x5413
    assert [answer(machine, number, 0, request) for request in (fionread, tiocgwinsz)] == [0, 0]
    for request in (seccomp.TIOCSTI, seccomp.TIOCLINUX, seccomp.TIOCSETD):
        assert answer(machine, number, 0, request) == EPERM
        assert answer(machine, number, 0, 1 << 32 | request) == EPERM  # the kernel sees 32 bits


def test_nobody_waits_for_a_file_or_is_told_of_it(machine, apart):
    number = seccomp.FCNTL[seccomp.MACHINES[machine][0]]
    f_setfl, f_setlk, f_getlease, f_dupfd_cloexec = 4, 6, 1025, 1030
    for command in (f_setfl, f_setlk, f_getlease, f_dupfd_cloexec):
        assert answer(machine, number, 3, command, apart=apart) == 0
    for command in (seccomp.F_SETLEASE, seccomp.F_NOTIFY, seccomp.F_SETDELEG):
        assert answer(machine, number, 3, command, apart=apart) == EPERM
        assert answer(machine, number, 3, 1 << 32 | command, apart=apart) == EPERM


def test_limits_and_priorities_are_the_callers_own(machine):
    place = seccomp.MACHINES[machine][0]
    for numbers in (seccomp.PRLIMIT64, *seccomp.OF_A_PROCESS.values()):
        assert answer(machine, numbers[place], 0, 7) == 0
        assert answer(machine, numbers[place], 4711, 7) == EPERM
    process, user = 0, 2
    for numbers, own in ((seccomp.SETPRIORITY, process), (seccomp.IOPRIO_SET, 1)):
        assert answer(machine, numbers[place], own, 0) == 0
        assert answer(machine, numbers[place], own, 4711) == EPERM
        assert answer(machine, numbers[place], user + own, 0) == EPERM
    ordinary, idle = 0, 5
    number = seccomp.SCHED_SETSCHEDULER[place]
    assert answer(machine, number, 4711, ordinary) == 0
    assert answer(machine, number, 4711, idle) == EPERM
    assert answer(machine, number, 0, idle) == 0


def test_sockets_are_those_of_dds(machine, apart):
    def ask(*words: int) -> int:
        number = seccomp.SOCKET[seccomp.MACHINES[machine][0]]
        return answer(machine, number, *words, apart=apart)

    elsewhere = 0 if apart else EAFNOSUPPORT
    for family in (seccomp.AF_INET, seccomp.AF_INET6):
        assert ask(family, DGRAM, 0) == 0
        assert ask(family, DGRAM | CLOEXEC, seccomp.IPPROTO_UDP) == 0
        assert ask(family, STREAM, 0) == elsewhere
        assert ask(family, STREAM, seccomp.IPPROTO_TCP) == elsewhere
        assert ask(family, RAW, 1) == EAFNOSUPPORT
        assert ask(family, SEQPACKET, IPPROTO_SCTP) == EAFNOSUPPORT
        assert ask(family, STREAM, IPPROTO_MPTCP) == EAFNOSUPPORT
    assert ask(seccomp.AF_UNIX, STREAM, 0) == elsewhere
    assert ask(seccomp.AF_NETLINK, RAW, seccomp.NETLINK_ROUTE) == 0
    assert ask(seccomp.AF_NETLINK, RAW, NETLINK_AUDIT) == EAFNOSUPPORT
    for family in (0, AF_VSOCK, AF_PACKET, AF_ALG, AF_BLUETOOTH):
        assert ask(family, STREAM, 0) == EAFNOSUPPORT


def test_a_pair_of_sockets_leads_nowhere_else(machine, apart):
    def ask(*words: int) -> int:
        number = seccomp.SOCKETPAIR[seccomp.MACHINES[machine][0]]
        return answer(machine, number, *words, apart=apart)

    assert ask(seccomp.AF_UNIX, STREAM | CLOEXEC) == 0
    assert ask(seccomp.AF_UNIX, SEQPACKET) == 0
    assert ask(seccomp.AF_UNIX, DGRAM) == (0 if apart else EAFNOSUPPORT)
    assert ask(AF_VSOCK, STREAM) == EAFNOSUPPORT


def _call_each(numbers: dict[str, int]) -> dict[str, int]:
    if os.getuid() == 0:  # what a call does that the filter has missed is then not the machine's
        os.setresgid(*[NOBODYS_UID] * 3)
        os.setresuid(*[NOBODYS_UID] * 3)
    seccomp.install()
    libc = ctypes.CDLL(None, use_errno=True)
    found = {}
    for name, number in numbers.items():
        answered = libc.syscall(number, *[ctypes.c_ulong(0)] * 6)
        found[name] = ctypes.get_errno() if answered == -1 else 0
    return found


@needs_seccomp
def test_the_kernel_refuses_every_listed_call():
    place = seccomp.MACHINES[os.uname().machine][0]
    numbers = {
        name: number
        for group in seccomp.REFUSED.values()
        for name, each in group.items()
        if (number := each[place]) is not None
    }
    assert in_child(_call_each, numbers) == dict.fromkeys(numbers, EPERM)


def _room_changes() -> bool:
    option = socket.SOL_SOCKET, socket.SO_SNDBUF
    with socket.socketpair()[0] as one:
        before = one.getsockopt(*option)
        one.setsockopt(*option, before // 4)
        return one.getsockopt(*option) != before


def _at_work(apart: bool) -> dict[str, Any]:
    parent = os.getppid()
    seccomp.install(is_apart=apart)
    libc = ctypes.CDLL(None, use_errno=True)
    heard: list[int] = []
    thread = threading.Thread(target=lambda: heard.append(1))
    thread.start()
    thread.join()
    words = [sys.executable, "-I", "-S", "-c", "print(7)"]
    return {
        "unshare": [libc.unshare(CLONE_NEWUSER), ctypes.get_errno()],
        "thread": heard,
        "program": subprocess.check_output(words, text=True),
        "unix": error_of(socket.socket, socket.AF_UNIX),
        "tcp": error_of(socket.socket, socket.AF_INET),
        "udp": error_of(socket.socket, socket.AF_INET, socket.SOCK_DGRAM),
        "packet": error_of(socket.socket, AF_PACKET, socket.SOCK_DGRAM),
        "pair": error_of(socket.socketpair),
        "limits of another": error_of(resource.prlimit, parent, resource.RLIMIT_CORE, (0, 0)),
        "room in a socket": _room_changes(),
        "own limits": error_of(resource.prlimit, 0, resource.RLIMIT_CORE, (0, 0)),
        "no new rights": "NoNewPrivs:\t1" in Path("/proc/self/status").read_text(),
        "once more": error_of(seccomp.install),
    }


@needs_seccomp
def test_a_process_goes_on_without_what_is_refused(apart):
    elsewhere = 0 if apart else EAFNOSUPPORT
    assert in_child(_at_work, apart) == {
        "unshare": [-1, EPERM],
        "thread": [1],
        "program": "7\n",
        "unix": elsewhere,
        "tcp": elsewhere,
        "udp": 0,
        "packet": EAFNOSUPPORT,
        "pair": 0,
        "limits of another": EPERM,
        "room in a socket": False,
        "own limits": 0,
        "no new rights": True,
        "once more": 0,
    }


def _threads_before() -> list[int]:
    asked, found = threading.Event(), []

    def ask() -> None:
        asked.wait()
        found.append(error_of(socket.socket, AF_PACKET, socket.SOCK_DGRAM))

    thread = threading.Thread(target=ask)
    thread.start()
    seccomp.install()
    asked.set()
    thread.join()
    return found


@needs_seccomp
def test_threads_that_were_there_have_it_too():
    assert in_child(_threads_before) == [EAFNOSUPPORT]


def test_a_machine_that_is_not_known_is_told(monkeypatch):
    known = os.uname()
    other = os.uname_result((*known[:4], "riscv64"))
    monkeypatch.setattr(os, "uname", lambda: other)
    assert not seccomp.is_there()
    with pytest.raises(OSError, match="riscv64") as raised:
        seccomp.install()
    assert raised.value.errno == ENOSYS


@needs_seccomp
def test_a_node_publishes_to_itself(apart):
    code = TEXTS["node"].format(root=str(ROOT), apart=apart)
    env = {**os.environ, "FASTDDS_BUILTIN_TRANSPORTS": "UDPv4"}
    words = [sys.executable, "-c", code]
    ended = ran(words, env=env)
    assert (ended.returncode, ended.stdout, ended.stderr) == (0, "heard\n", "")
