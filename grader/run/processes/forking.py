"""What happens in a fork server: it forks itself for each process that a run consists of.

    python -I -S forking.py --zygote SOCKET

The grader's side of this is `.zygote`. Started as above it has imported nothing beforehand, and its
children execute their command; a zygote has imported what runs need (`grader.run.zygotes`), and its
children go on by themselves, as if the command had been executed. It has one thread and two of
ROS's that sleep. It is asked over a socket
(SOCK_SEQPACKET) with descriptors, the first of which holds an `Order`, and answers with a process
id and, where the system has such, a pidfd. It goes with the grader, whose end closes the socket,
and its children go with it. Where the grader only orders no more, it ends when the last of its
children has.

What becomes of a process stands in its report, a pipe to the grader, as lines of JSON, each an
object of one of these: `refused`, why it did not become what was ordered (`refusal`); `over`, its
exit code, negative for a signal; of one that a supervisor stands above, whose `over` that is,
before that `pid`, the process id of the command itself, and `exit`, how that has ended. A report
that closes without an `over` is that of a process whose server has died.

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
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from typing import Any, NamedTuple

if __name__ == "__main__":
    # on the import path, which is empty but for Python's own: where our packages are
    sys.path.append(os.path.realpath(f"{__file__}/../../../.."))

from grader import linux, usage
from grader.run.processes import supervisor
from grader.run.processes.refusal import Refusal

__all__ = ["MARK", "Order", "array", "become", "limits", "serve"]

#: An environment variable that tells the processes of one run from those of others.
MARK = "TURTLESIM_GRADER_PROCESS"
#: Its value in a server: as long as any other, so that a child can write its own over it.
NO_MARK = "0" * 32
#: The longest packet [bytes], and the most descriptors that come with one.
LIMIT_BYTES = 1 << 16
MOST_FDS = 64
NAMESPACES = {"user": linux.CLONE_NEWUSER, "net": linux.CLONE_NEWNET}

#: (resource, soft, hard)
Limit = tuple[int, int, int]


class Order(NamedTuple):
    """What a child is to become.

    After the order's own come, in this order, the descriptors of its output, of its report, of its
    namespaces, and those that it is to have under the numbers `fds`.

    Attributes:
        command: what it executes, or goes on as.
        env: its environment variables, as they would be given to `command`.
        server_env: those that were given to the server. What Python's start has made of them there
            (ROS's wheels set a library path, for one) it would have made in the child as well.
        cwd: its current folder.
        fds: the numbers of the descriptors that it inherits, as its command knows them.
        namespaces: the kinds of the namespaces to enter, in order: keys of `NAMESPACES`.
        limits: the grader's limits of resources, which may have changed since the server started.
        executes: whether it executes its command; if not, it goes on in what the server has loaded.
        supervised: whether a supervisor is to stand between the server and it.
        confinement: what that orders the process; see `.sandbox.confinement`.
    """

    command: Sequence[str]
    env: Mapping[str, str]
    server_env: Mapping[str, str]
    cwd: str
    fds: Sequence[int]
    namespaces: Sequence[str]
    limits: Sequence[Limit]
    executes: bool
    supervised: bool
    confinement: dict[str, Any] | None = None


def limits() -> list[Limit]:
    """What this process may use at most, of every resource."""
    numbers = sorted({getattr(resource, n) for n in dir(resource) if n.startswith("RLIMIT_")})
    return [(number, *resource.getrlimit(number)) for number in numbers]


def serve(number: str, preloaded: Iterable[str]) -> list[str]:
    """Fork for each order; returns in each child that goes on, with the command that it has become.

    Args:
        number: of the socket.
        preloaded: modules that a cold start would not have loaded, for `.zygote.shadows`.
    """
    link = socket.socket(fileno=int(number))
    linux.control(linux.PR_SET_DUMPABLE, 0)  # nobody else looks into it
    # what is there stays: no child looks through it, or writes to its pages
    gc.collect()
    gc.freeze()
    ended = _wake_at_ends()
    reports: dict[int, int] = {}  # of each child: process id -> descriptor
    poll = select.poll()
    poll.register(ended, select.POLLIN)
    poll.register(link, select.POLLIN)
    link.send(json.dumps(sorted(preloaded)).encode())
    is_retired = False
    while not (is_retired and not reports):
        for ready, events in poll.poll():
            if ready == ended:
                os.read(ended, 4096)
                _tell_ends(reports)
            elif events & select.POLLHUP:
                os._exit(0)  # the grader is gone
            elif fds := _hear(link):
                order, child, report = _fork(link, fds)
                if order is not None:
                    return list(order.command)
                if child:
                    reports[child] = report
            else:
                is_retired = True
                poll.modify(link, 0)
    os._exit(0)


def _wake_at_ends() -> int:
    """What can be read when a child has ended."""
    reading, writing = os.pipe()
    os.set_blocking(writing, False)
    signal.set_wakeup_fd(writing, warn_on_full_buffer=False)
    signal.signal(signal.SIGCHLD, lambda *_: None)
    return reading


def _tell_ends(reports: dict[int, int]) -> None:
    with suppress(ChildProcessError):
        while (ended := os.waitpid(-1, os.WNOHANG))[0]:
            report = reports.pop(ended[0])
            supervisor.tell(report, over=os.waitstatus_to_exitcode(ended[1]))
            os.close(report)


def _hear(link: socket.socket) -> list[int]:
    """The descriptors of an order; none where nobody orders any more."""
    try:
        return socket.recv_fds(link, LIMIT_BYTES, MOST_FDS)[1]
    except ConnectionError:
        return []


def _fork(link: socket.socket, fds: list[int]) -> tuple[Order | None, int, int]:
    """In the child its order; in the server the child's process id, 0 for none, and report."""
    me, report = os.getpid(), fds.pop(2)
    try:
        with warnings.catch_warnings():
            # CPython 3.12 warns of forks beside other threads: ROS's two sleep, and hold nothing
            warnings.simplefilter("ignore", DeprecationWarning)
            pid = os.fork()
    except OSError as error:  # no memory, too many processes: the others go on
        pid, why = -1, Refusal.of(error).to_line()
    if not pid:
        link.close()
        return _be_child(me, report, *fds), 0, -1
    for fd in fds:
        os.close(fd)
    if pid < 0:
        os.close(report)
        with suppress(OSError):
            link.send(json.dumps({"refused": why}).encode())
        return None, 0, -1
    try:
        with _pidfd(pid) as pidfd:
            socket.send_fds(link, [json.dumps({"pid": pid}).encode()], pidfd)
    except OSError as error:  # nobody listens any more, or too many descriptors are on their way
        os.kill(pid, signal.SIGKILL)
        with suppress(OSError):
            link.send(json.dumps({"lost": repr(error)}).encode())
    return None, pid, report


@contextmanager
def _pidfd(pid: int) -> Iterator[list[int]]:
    """A descriptor of a child, if this system has such; some containers refuse them."""
    try:
        pidfd = os.pidfd_open(pid)
    except OSError:
        yield []
        return
    try:
        yield [pidfd]
    finally:
        os.close(pidfd)


def _be_child(server: int, report: int, ordered: int, *fds: int) -> Order:
    """Become what is ordered, and go on as that; whatever keeps it from that is reported."""
    signal.set_wakeup_fd(-1)
    try:
        with open(ordered, "rb") as file:
            order = Order(**json.loads(file.read()))
        report = _out_of_the_way(report, order)
        become(order, fds, server, report)
        if order.supervised:
            lacking = supervisor.Supervisor(server, report).run()
            supervisor.confine(order.confinement, lacking)
        _reset_signals()
        if order.executes:
            os.set_inheritable(report, False)
            os.execvpe(order.command[0], list(order.command), order.env)
        # as Python does where it starts
        signal.signal(signal.SIGINT, signal.default_int_handler)
        signal.signal(signal.SIGPIPE, signal.SIG_IGN)
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        os.close(report)
    except BaseException as error:
        supervisor.tell(report, refused=Refusal.of(error).to_line())
        os._exit(127)
    sys.orig_argv[:] = order.command
    return order


def become(order: Order, fds: Sequence[int], server: int, report: int) -> None:
    """Turn a forked child into the process that was ordered, as a start of its command would.

    The one place for all that is done to a run's process as a whole, its supervisor included:
    session, descriptors, namespaces, limits, environment, current folder. Nothing of the server's
    stays within reach: whatever is not passed is closed.

    Args:
        fds: what came with the order: its output, its namespaces, and what is passed.
        report: a descriptor that is kept beside those.

    Raises:
        OSError, ValueError, KeyError: something of it is refused.
    """
    os.setsid()
    output, *rest = (_out_of_the_way(fd, order) for fd in fds)
    spaces, passed = rest[: len(order.namespaces)], rest[len(order.namespaces) :]
    _close_others({0, report, output, *rest})
    for number in (1, 2):
        os.dup2(output, number)
    for fd, number in zip(passed, order.fds, strict=True):
        os.dup2(fd, number)
    for kind, fd in zip(order.namespaces, spaces, strict=True):
        linux.enter(fd, NAMESPACES[kind])
    for fd in (output, *rest):
        os.close(fd)
    _go_with(server)
    for number, *both in order.limits:
        if resource.getrlimit(number) != tuple(both):
            resource.setrlimit(number, (both[0], both[1]))
    _replace_environment(order)
    os.chdir(order.cwd)


def _out_of_the_way(fd: int, order: Order) -> int:
    """Another number for a descriptor: none that is wanted for what is passed."""
    return fcntl.fcntl(fd, fcntl.F_DUPFD, max([2, *order.fds]) + 1)


def _close_others(kept: set[int]) -> None:
    for name in os.listdir("/proc/self/fd"):  # noqa: PTH208
        if int(name) not in kept:
            with suppress(OSError):  # the folder's own
                os.close(int(name))


def _go_with(server: int) -> None:
    """Die with the server, as a process that it had started would; entering namespaces undid it."""
    # a process that has entered a user namespace is as closed as one with secrets: open it again
    linux.control(linux.PR_SET_DUMPABLE, 1)
    linux.signal_at_parents_death(signal.SIGKILL)
    if os.getppid() != server:
        os._exit(1)  # it has died before we asked


def _reset_signals() -> None:
    for number in signal.valid_signals() - {signal.SIGKILL, signal.SIGSTOP}:
        with suppress(OSError):  # the C library's own
            signal.signal(number, signal.SIG_DFL)
    signal.pthread_sigmask(signal.SIG_SETMASK, [])


def _replace_environment(order: Order) -> None:
    env, before = dict(order.env), order.server_env
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
    start, end = usage.look(os.getpid()).env
    at = ctypes.string_at(start, end - start).index(f"{MARK}={NO_MARK}".encode())
    ctypes.memmove(start + at, f"{MARK}={mark}".encode(), len(MARK) + 1 + len(mark))


if __name__ == "__main__":
    serve(sys.argv[2], ())
