"""A fork server: a process that forks itself for each process that a run consists of.

    python -I -S fork_server_main.py --fork-server SOCKET

The grader's side of this is `.fork_server`. Started as above it has imported nothing beforehand,
and its children execute their command; one of `grader.run.fork_servers` has imported what runs
need, and its children go on by themselves, as if the command had been executed. It has one thread
and two of ROS's that sleep. A request comes over a socket (SOCK_SEQPACKET): what the command needs,
with descriptors, the first of which holds a `ForkOrder`; the answer is a process id and, where the
system has such, a pidfd. It ends with the grader, whose end closes the socket, and its children end
with it. If the grader only stops asking, it ends when the last of its children has.

Each process has a report, a pipe to the grader with lines of JSON. Each line is an object of one
key: `refused`, why it did not become what was ordered (`refusal`); `over`, its exit code, negative
for a signal. Below a supervisor, whose exit code `over` is then, come first `pid`, the process id
of the command itself, and `exit`, its exit code. A report that closes without an `over` is that of
a process whose server has died.

`become` is what every child does first; a submission's process is confined after its supervisor has
forked, in `.supervisor.confine`.
"""

from __future__ import annotations

import array  # noqa: F401  socket.recv_fds imports it where it is first needed, which is too late
import ctypes
import fcntl
import gc
import json
import os
import select
import signal
import socket
import sys
import warnings
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from typing import Any, NamedTuple

if __name__ == "__main__":
    # on the import path, which is empty but for Python's own: where our packages are
    sys.path.append(os.path.realpath(f"{__file__}/../../../.."))

from grader.run.processes import supervisor
from grader.run.processes.refusal import Refusal
from grader.system import linux

#: An environment variable by which the processes of one run are known among all others.
MARK = "TURTLESIM_GRADER_PROCESS"
#: Its value in a server: as long as any other, so that a child can write its own over it.
NO_MARK = "0" * 32
#: The longest packet [bytes], and the most descriptors that come with one.
LIMIT_BYTES = 1 << 16
MOST_FDS = 64
NAMESPACES = {"user": linux.CLONE_NEWUSER, "net": linux.CLONE_NEWNET}


class ProcessCommand(NamedTuple):
    """A program, as it is to be started.

    Attributes:
        words: its name and its arguments.
        env: its environment variables.
        cwd: its current folder; None for the grader's.
        fds: descriptors that it inherits, under the same numbers.
        namespaces: its namespaces: kind, a key of `NAMESPACES`, -> descriptor, in the order in
            which they are entered.
        confinement: how it is confined; see `grader.run.sandbox.confinement`.
        needs: what a fork server may load before it forks for the first such command.
    """

    words: Sequence[str]
    env: Mapping[str, str]
    cwd: str | os.PathLike[str] | None = None
    fds: Sequence[int] = ()
    namespaces: Mapping[str, int] = {}
    confinement: Mapping[str, Any] | None = None
    needs: str = ""


class ForkOrder(NamedTuple):
    """An order for a child.

    The descriptor of the order is followed, in this order, by those of its output, of its report,
    of its command's namespaces, and those that it inherits.

    Attributes:
        command: what it executes, or goes on as.
        server_env: the environment variables that were given to the server. What Python's start has
            changed in them there (ROS's wheels set a library path, for one) it would have changed
            in the child as well.
        limits: the grader's limits of resources, which may have changed since the server started:
            resource, soft and hard limit.
        executes: whether it executes its command; if not, it goes on in what the server has loaded.
        supervised: whether a supervisor is to stand between the server and it.
    """

    command: ProcessCommand
    server_env: Mapping[str, str]
    limits: Sequence[tuple[int, int, int]]
    executes: bool
    supervised: bool


# In the server --------------------------------------------------------------------------------


def serve(number: str, preloaded: Iterable[str], load: Callable[[str], object] = bool) -> list[str]:
    """Fork for each order. The server itself never returns from here.

    Args:
        number: of the socket.
        preloaded: modules that a cold start would not have loaded, for
            `grader.run.fork_servers.shadows`.
        load: called with what a command needs, if it needs something.

    Returns:
        The command; in each child that goes on with what the server has loaded.
    """
    grader = socket.socket(fileno=int(number))
    linux.control(linux.PR_SET_DUMPABLE, 0)  # nobody else reads its memory
    # what is loaded stays: no child searches it for garbage, which would write to its pages
    gc.collect()
    gc.freeze()
    ended = _wake_at_ends()
    reports: dict[int, int] = {}  # of each child: process id -> descriptor
    poll = select.poll()
    poll.register(ended, select.POLLIN)
    poll.register(grader, select.POLLIN)
    grader.send(json.dumps(sorted(preloaded)).encode())
    server, is_retired = os.getpid(), False
    while reports or not is_retired:
        for ready, events in poll.poll():
            if ready == ended:
                os.read(ended, 4096)
                _report_ends(reports)
            elif events & select.POLLHUP:
                os._exit(0)  # the grader is gone
            elif (request := _receive(grader))[1]:
                needs, fds = json.loads(request[0]), request[1]
                if needs:
                    load(needs)
                report = fds.pop(2)
                child = _fork(grader)
                if child == 0:
                    grader.close()
                    return _be_child(server, report, *fds)
                for fd in fds:
                    os.close(fd)
                if child is None:
                    os.close(report)
                else:
                    reports[child] = report
                    _answer_with_child(grader, child)
            else:
                is_retired = True
                poll.modify(grader, 0)
    os._exit(0)


def _wake_at_ends() -> int:
    """Return a descriptor that becomes readable when a child has ended."""
    reading, writing = os.pipe()
    os.set_blocking(writing, False)
    signal.set_wakeup_fd(writing, warn_on_full_buffer=False)
    signal.signal(signal.SIGCHLD, lambda *_: None)
    return reading


def _report_ends(reports: dict[int, int]) -> None:
    with suppress(ChildProcessError):
        while (ended := os.waitpid(-1, os.WNOHANG))[0]:
            report = reports.pop(ended[0])
            supervisor.report_fact(report, over=os.waitstatus_to_exitcode(ended[1]))
            os.close(report)


def _receive(grader: socket.socket) -> tuple[bytes, list[int]]:
    """Receive what a command needs, and descriptors; none where the grader asks no more."""
    try:
        return socket.recv_fds(grader, LIMIT_BYTES, MOST_FDS)[:2]
    except ConnectionError:
        return b"", []


def _fork(grader: socket.socket) -> int | None:
    """Fork this process; where the system refuses that, answer so and return None."""
    try:
        with warnings.catch_warnings():
            # CPython 3.12 warns of forks beside other threads: ROS's two sleep, and hold nothing
            warnings.simplefilter("ignore", DeprecationWarning)
            return os.fork()
    except OSError as error:  # no memory, too many processes: the others go on
        _answer(grader, refused=Refusal.of(error).to_line())
        return None


def _answer_with_child(grader: socket.socket, child: int) -> None:
    """Answer an order with a child; end that where the answer does not arrive."""
    try:
        pidfd = [os.pidfd_open(child)]
    except OSError:  # some containers refuse them
        pidfd = []
    try:
        socket.send_fds(grader, [json.dumps({"pid": child}).encode()], pidfd)
    except OSError as error:  # nobody listens any more, or too many descriptors are on their way
        os.kill(child, signal.SIGKILL)
        _answer(grader, lost=repr(error))
    for fd in pidfd:
        os.close(fd)


def _answer(grader: socket.socket, **fact: object) -> None:
    with suppress(OSError):
        grader.send(json.dumps(fact).encode())


# In a child -----------------------------------------------------------------------------------


def _be_child(server: int, report: int, ordered: int, *fds: int) -> list[str]:
    """Become what was ordered, or report why that failed.

    Returns:
        The command, where it is not executed.
    """
    signal.set_wakeup_fd(-1)
    try:
        with open(ordered, "rb") as file:
            made, *rest = json.loads(file.read())
        command = ProcessCommand(*made)
        order = ForkOrder(command, *rest)
        report = _out_of_the_way(report, order)
        become(order, fds, server, report)
        if order.supervised:
            refused = supervisor.fork_below(server, report)
            supervisor.confine(order.command.confinement, refused)
        _reset_signals()
        if order.executes:
            os.set_inheritable(report, False)
            os.execvpe(command.words[0], list(command.words), command.env)
        # as Python does where it starts
        signal.signal(signal.SIGINT, signal.default_int_handler)
        signal.signal(signal.SIGPIPE, signal.SIG_IGN)
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        os.close(report)
    except BaseException as error:
        supervisor.report_fact(report, refused=Refusal.of(error).to_line())
        os._exit(127)
    sys.orig_argv[:] = command.words
    return list(command.words)


def become(order: ForkOrder, fds: Sequence[int], server: int, report: int) -> None:
    """Turn a forked child into the process that was ordered, as a start of its command would.

    Sets up a run's process as a whole, its supervisor included: session, descriptors, namespaces,
    limits, environment, current folder. All other descriptors of the server are closed.

    Args:
        fds: the descriptors of the order: its output, its namespaces, and those that it inherits.
        report: a descriptor that is kept beside those.
    """
    os.setsid()
    output, *rest = (_out_of_the_way(fd, order) for fd in fds)
    spaces, passed = rest[: len(order.command.namespaces)], rest[len(order.command.namespaces) :]
    linux.close_descriptors({0, report, output, *rest})
    for number in (1, 2):
        os.dup2(output, number)
    for fd, number in zip(passed, order.command.fds, strict=True):
        os.dup2(fd, number)
    for kind, fd in zip(order.command.namespaces, spaces, strict=True):
        linux.enter(fd, NAMESPACES[kind])
    for fd in (output, *rest):
        os.close(fd)
    # a process that has entered a user namespace is as closed as one with secrets: open it again
    linux.control(linux.PR_SET_DUMPABLE, 1)
    linux.go_with_parent(server, signal.SIGKILL)  # entering namespaces has undone it
    for limit in order.limits:
        linux.set_limit(*limit)
    _replace_environment(order)
    os.chdir(order.command.cwd or "/")


def _out_of_the_way(fd: int, order: ForkOrder) -> int:
    """Move a descriptor to a number that no inherited one is to have."""
    return fcntl.fcntl(fd, fcntl.F_DUPFD, max([2, *order.command.fds]) + 1)


def _reset_signals() -> None:
    for number in signal.valid_signals() - {signal.SIGKILL, signal.SIGSTOP}:
        with suppress(OSError):  # the C library's own
            signal.signal(number, signal.SIG_DFL)
    signal.pthread_sigmask(signal.SIG_SETMASK, [])


def _replace_environment(order: ForkOrder) -> None:
    env, before = dict(order.command.env), order.server_env
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
    """Write the mark into /proc/PID/environ, which shows the variables at a program's start."""
    start, end = linux.process_stat(os.getpid()).env
    at = ctypes.string_at(start, end - start).index(f"{MARK}={NO_MARK}".encode())
    ctypes.memmove(start + at, f"{MARK}={mark}".encode(), len(MARK) + 1 + len(mark))


if __name__ == "__main__":
    serve(sys.argv[2], ())
