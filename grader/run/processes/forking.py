"""What happens in a zygote: it has imported what runs need, and forks itself for each of them.

The grader's side of this is `.zygote`. A zygote has one thread and two of ROS's that sleep. It is
asked over a socket (SOCK_SEQPACKET) with an `Order` and descriptors, and answers with a process id
and two descriptors: a pidfd, and a pipe that tells how the process has ended. It goes with the
grader, whose end it sees by a pidfd, since the thread that has started it may be gone long before;
and its children go with it. Where its socket is closed while the grader lives, it ends when the
last of its children has.

`become` is what a child does before anything of its own; what only a submission's process is to be
confined by comes after its supervisor has forked, in `.supervisor.confine`.
"""

from __future__ import annotations

import array  # socket.recv_fds imports it where it is first needed, which is too late
import ctypes
import fcntl
import gc
import json
import os
import resource
import select
import signal
import socket
import sys
import warnings
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, NoReturn, Self

from grader.run.processes import linux, supervisor

__all__ = ["MARK", "Order", "array", "become", "limits", "serve"]

#: An environment variable that tells the processes of one run from those of others.
MARK = "TURTLESIM_GRADER_PROCESS"
#: Its value in a zygote: as long as any other, so that a child can write its own over it.
NO_MARK = "0" * 32
#: The longest order [bytes], and the most descriptors that come with one.
LIMIT_BYTES = 1 << 20
MOST_FDS = 64
READY = b"ready"
NAMESPACES = {"user": linux.CLONE_NEWUSER, "net": linux.CLONE_NEWNET}

#: (resource, soft, hard)
Limit = tuple[int, int, int]


@dataclass(frozen=True)
class Order:
    """What a zygote's child is to become.

    With it come, in this order, the descriptors of its output, of its supervisor's report if it is
    supervised, of its namespaces, and those that it is to have under the numbers `fds`.

    Attributes:
        command: what would start it without a zygote.
        env: its environment variables, as they would be given to `command`.
        zygote_env: those that were given to the zygote. What Python's start has made of them there
            (ROS's wheels set a library path, for one) it would have made in the child as well.
        cwd: its current folder.
        fds: the numbers of the descriptors that it inherits, as its command knows them.
        namespaces: the kinds of the namespaces to enter, in order: keys of `NAMESPACES`.
        limits: the grader's limits of resources, which may have changed since the zygote started.
        supervised: whether a supervisor is to stand between the zygote and it.
        confinement: what that orders the process; see `.sandbox.confinement`.
    """

    command: Sequence[str]
    env: Mapping[str, str]
    zygote_env: Mapping[str, str]
    cwd: str
    fds: Sequence[int]
    namespaces: Sequence[str]
    limits: Sequence[Limit]
    supervised: bool
    confinement: dict[str, Any] | None = None

    def to_bytes(self) -> bytes:
        """As a packet."""
        return json.dumps(asdict(self)).encode()

    @classmethod
    def from_bytes(cls, data: bytes) -> Self:
        """The order that `to_bytes` has written."""
        return cls(**json.loads(data))


def limits() -> list[Limit]:
    """What this process may use at most, of every resource."""
    numbers = sorted({getattr(resource, n) for n in dir(resource) if n.startswith("RLIMIT_")})
    return [(number, *resource.getrlimit(number)) for number in numbers]


def serve(words: Sequence[str], preloaded: Iterable[str]) -> list[str]:
    """Fork for each order; returns in each child, with the command that it has become.

    Args:
        words: the number of the socket, and the grader's process id.
        preloaded: modules that a cold start would not have loaded, for `.zygote.shadows`.
    """
    link, grader = socket.socket(fileno=int(words[0])), os.pidfd_open(int(words[1]))
    if os.getppid() != int(words[1]):
        os._exit(0)  # it has died before we asked
    linux.control(linux.PR_SET_DUMPABLE, 0)  # nobody else looks into it
    # what is there stays: no child looks through it, or writes to its pages
    gc.collect()
    gc.freeze()
    children: dict[int, tuple[int, int]] = {}  # pidfd -> process id, pipe
    poll = select.poll()
    poll.register(link, select.POLLIN)
    poll.register(grader, select.POLLIN)
    link.send(json.dumps(sorted(preloaded)).encode())
    while True:
        for ready, _ in poll.poll():
            if ready == grader:
                os._exit(0)
            if ready in children:
                poll.unregister(ready)
                _tell_end(ready, *children.pop(ready))
                if link.fileno() < 0 and not children:
                    os._exit(0)
                continue
            data, fds, _, _ = _hear(link)
            if data:
                order, child = _fork(link, data, fds)
                if order is not None:
                    return list(order.command)
                if child is not None:
                    children[child[0]] = child[1:]
                    poll.register(child[0], select.POLLIN)
                continue
            poll.unregister(ready)
            link.close()
            if not children:
                os._exit(0)


def _hear(link: socket.socket) -> tuple[bytes, list[int], int, object]:
    try:
        return socket.recv_fds(link, LIMIT_BYTES, MOST_FDS)
    except ConnectionError:
        return b"", [], 0, None


def _fork(
    link: socket.socket, data: bytes, fds: list[int]
) -> tuple[Order | None, tuple[int, int, int] | None]:
    """In the child its order; in the zygote the child's pidfd, process id and pipe, if it is up."""
    me = os.getpid()
    told, tells = os.pipe()
    try:
        with warnings.catch_warnings():
            # CPython 3.12 warns of forks beside other threads: ROS's two sleep, and hold nothing
            warnings.simplefilter("ignore", DeprecationWarning)
            pid = os.fork()
    except OSError as error:  # no memory, too many processes: the others go on
        pid, why = -1, repr(error)
    if not pid:
        link.close()
        return _be_child(me, data, fds, tells), None
    for fd in (tells, *fds):
        os.close(fd)
    if pid > 0:
        why = os.read(told, 4096).decode("utf-8", "replace")
    os.close(told)
    if why != READY.decode():
        if pid > 0:
            os.waitpid(pid, 0)
        with suppress(OSError):
            link.send(json.dumps({"refused": why}).encode())
        return None, None
    pidfd, (theirs, ours) = os.pidfd_open(pid), os.pipe()
    try:
        socket.send_fds(link, [json.dumps({"pid": pid}).encode()], [pidfd, theirs])
    except OSError as error:  # nobody listens any more, or too many descriptors are on their way
        os.kill(pid, signal.SIGKILL)
        with suppress(OSError):
            link.send(json.dumps({"lost": repr(error)}).encode())
    os.close(theirs)
    return None, (pidfd, pid, ours)


def _tell_end(pidfd: int, pid: int, pipe: int) -> None:
    code = os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1])
    with suppress(BrokenPipeError):
        os.write(pipe, str(code).encode())
    os.close(pipe)
    os.close(pidfd)


def _be_child(zygote: int, data: bytes, fds: list[int], tells: int) -> Order:
    """Become what is ordered, say so, and go on as that."""
    try:
        order = Order.from_bytes(data)
        tells = _out_of_the_way(tells, order)
        report = become(order, fds, zygote, tells)
        os.write(tells, READY)
        os.close(tells)
    except BaseException as error:
        _give_up(tells, error)
    if order.supervised:
        try:
            supervisor.Supervisor(zygote, report, order.confinement).run(None)
        except BaseException:
            os._exit(1)
    sys.orig_argv[:] = order.command
    return order


def _give_up(tells: int, error: BaseException) -> NoReturn:
    os.write(tells, repr(error).encode()[:4000])
    os._exit(1)


def become(order: Order, fds: Sequence[int], zygote: int, tells: int) -> int:
    """Turn a forked child into the process that was ordered, as a start of its command would.

    The one place for all that is done to a run's process as a whole, its supervisor included:
    session, descriptors, namespaces, limits, environment, current folder. Nothing of the zygote's
    stays within reach: whatever is not passed is closed.

    Args:
        fds: what came with the order.
        tells: a descriptor that is kept beside those.

    Returns:
        the supervisor's report under its new number; -1 if there is none.

    Raises:
        OSError, ValueError, KeyError: something of it is refused.
    """
    os.setsid()
    output, *rest = fds
    report = rest.pop(0) if order.supervised else -1
    spaces, passed = rest[: len(order.namespaces)], rest[len(order.namespaces) :]
    output, report = _out_of_the_way(output, order), _out_of_the_way(report, order)
    spaces = [_out_of_the_way(fd, order) for fd in spaces]
    passed = [_out_of_the_way(fd, order) for fd in passed]
    _close_others({0, output, report, tells, *spaces, *passed})
    for number in (1, 2):
        os.dup2(output, number)
    for fd, number in zip(passed, order.fds, strict=True):
        os.dup2(fd, number)
    for kind, fd in zip(order.namespaces, spaces, strict=True):
        linux.enter(fd, NAMESPACES[kind])
    for fd in (output, *spaces, *passed):
        os.close(fd)
    _go_with(zygote)
    for number, *both in order.limits:
        if resource.getrlimit(number) != tuple(both):
            resource.setrlimit(number, (both[0], both[1]))
    _replace_environment(order)
    os.chdir(order.cwd)
    return report


def _out_of_the_way(fd: int, order: Order) -> int:
    """Another number for a descriptor: none that is wanted for what is passed."""
    return fd if fd < 0 else fcntl.fcntl(fd, fcntl.F_DUPFD, max([2, *order.fds]) + 1)


def _close_others(kept: set[int]) -> None:
    for name in os.listdir("/proc/self/fd"):  # noqa: PTH208
        if int(name) not in kept:
            with suppress(OSError):  # the folder's own
                os.close(int(name))


def _go_with(zygote: int) -> None:
    """Die with the zygote, as a process that it had started would; entering namespaces undid it."""
    # a process that has entered a user namespace is as closed as one with secrets: open it again
    linux.control(linux.PR_SET_DUMPABLE, 1)
    linux.signal_at_parents_death(signal.SIGKILL)
    if os.getppid() != zygote:
        os._exit(1)  # it has died before we asked


def _replace_environment(order: Order) -> None:
    env, before = dict(order.env), order.zygote_env
    if MARK in env and len(env[MARK]) == len(NO_MARK):
        with suppress(OSError, ValueError):
            _show_mark(env[MARK])
    now = {name: value for name, value in os.environ.items() if name != MARK}
    env.update((name, value) for name, value in now.items() if before.get(name) != value)
    for name in before.keys() - now.keys():
        env.pop(name, None)
    os.environ.clear()
    os.environ.update(env)


def _show_mark(mark: str) -> None:
    """Have /proc/PID/environ, which shows what a program was started with, show the mark."""
    stat = Path("/proc/self/stat").read_bytes().rpartition(b")")[2].split()
    start, end = int(stat[47]), int(stat[48])  # env_start, env_end: fields 50 and 51
    at = ctypes.string_at(start, end - start).index(f"{MARK}={NO_MARK}".encode())
    ctypes.memmove(start + at, f"{MARK}={mark}".encode(), len(MARK) + 1 + len(mark))
