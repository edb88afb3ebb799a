"""The server of calls: forks itself for each call, with fork servers of that call's own.

    python -P .../grader/cli/serving.py IDLE_S

It has one thread, and never grades. A line of JSON on its standard output says that it is ready, or
why it is not. It ends when nobody has called for so many seconds, when it is asked to, when what it
has loaded has changed, or when one of its fork servers is lost; calls that go on end first.

A request is a packet with a file in memory, which holds JSON, and for a call the three standard
descriptors and the current folder. It is answered at once, and a call's end is answered, too. Who
closes the connection before ends the call.
"""

from __future__ import annotations

import gc
import importlib
import json
import os
import secrets
import select
import signal
import socket
import stat
import sys
import threading
import time
import traceback
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from importlib.util import find_spec
from typing import Any, NoReturn, get_args

if __name__ == "__main__":
    # where our packages are, if nothing else says so
    if (root := os.path.realpath(f"{__file__}/../../..")) not in sys.path:
        sys.path.insert(0, root)

from grader import cli, extensions, linux, scratch
from grader.errors import GraderError, GraderFailure, UsageError
from grader.exercise import DEFAULT
from grader.exercise.loading import load_exercise
from grader.message import NOTHING, Message, msg
from grader.run import fork_servers
from grader.run.processes import levels, network
from grader.run.processes.fork_server import Branch, ServerLost
from grader.run.sandbox.confinement import LANDLOCK
from grader.servers import place, started_with

#: Imported beforehand: what a call needs.
MODULES = (
    *("grader.cli.run", "grader.cli.check", "grader.cli.grade_one", "grader.cli.watch"),
    *("grader.recording.bag", "grader.reports.page.html", "grader.reports.terminal"),
)
GROUPS: tuple[extensions.Group, ...] = get_args(extensions.Group)
#: So many may have connected without a request, and no request is longer [bytes].
MOST_SILENT, LONGEST = 16, 1_000_000
#: How often they look whether they can be reached [s].
LOOK_S = 5.0
ANOTHER = msg(
    "they were started with another {what}; `grader servers stop` and `start` in this shell "
    "mend that"
)
AT_LIMITS = msg(
    "submissions can be confined at the level {level} only here, where one reaches what its user "
    "does; no server may outlive a call then, and each call starts anew"
)


class Servers:
    """Those of a user, with who has connected to them.

    Args:
        listener: where calls come in.
        token: what each request has to know.
        level: at which submissions are confined.
        idle_s: the time without a call after which they end [s].
    """

    def __init__(self, listener: socket.socket, token: str, level: str, idle_s: float) -> None:
        self._listener, self._token, self._level = listener, token, level
        self._idle_s, self._began = idle_s, time.monotonic()
        self._last = self._began
        self._calls = 0
        self._is_ending = False
        self._there = place.who_is_there()
        self._silent: list[socket.socket] = []
        #: process id of a call -> who waits for its end, if somebody does
        self._running: dict[int, socket.socket | None] = {}
        self._folders = list(_packages())
        self._files = started_with.files(self._folders)
        self._other = started_with.environment(), started_with.process()

    def serve(self) -> None:
        """Answer requests until there is a reason to end."""
        woken, writing = os.pipe()
        os.set_blocking(writing, False)
        signal.set_wakeup_fd(writing, warn_on_full_buffer=False)
        signal.signal(signal.SIGCHLD, lambda *_: None)
        signal.signal(signal.SIGTERM, self._end)
        while self._running or not self._is_ending:
            waiting = [each for each in self._running.values() if each is not None]
            watched: list[Any] = [woken, self._listener, *self._silent, *waiting]
            rest_s = max(0.0, self._last + self._idle_s - time.monotonic())
            ready, _, _ = select.select(watched, [], [], min(rest_s, LOOK_S) or LOOK_S)
            is_idle = not self._running and time.monotonic() >= self._last + self._idle_s
            if not ready and (is_idle or place.who_is_there() != self._there):
                self._is_ending = True
            for each in ready:
                if each == woken:
                    os.read(woken, 4096)
                    self._report_ends()
                elif each is self._listener:
                    self._accept()
                elif each in self._silent:
                    self._silent.remove(each)
                    self._hear(each)
                else:
                    self._cancel(each)

    def _end(self, *_: object) -> None:
        self._is_ending = True

    def _accept(self) -> None:
        with suppress(OSError):
            peer, _ = self._listener.accept()
            peer.setblocking(False)
            if place.user_of(peer) != os.geteuid():
                peer.close()
                return
            self._silent.append(peer)
            if len(self._silent) > MOST_SILENT:
                self._silent.pop(0).close()

    def _hear(self, peer: socket.socket) -> None:
        fds: list[int] = []
        try:
            _, fds, _, _ = socket.recv_fds(peer, 16, 8)
            keeps = self._answer(peer, _read(fds[0]), fds[1:])
        except UsageError as refusal:
            keeps = False
            _tell(peer, refused=refusal.message.serialise())
        except Exception:  # nobody who belongs to us asks so
            keeps = False
        for fd in fds:
            os.close(fd)
        if not keeps:
            peer.close()

    def _answer(self, peer: socket.socket, request: Mapping[str, Any], fds: list[int]) -> bool:
        """Answer a request; return whether more is to be said.

        Raises:
            UsageError: it is refused.
        """
        if not secrets.compare_digest(str(request["token"]), self._token):
            raise UsageError(msg("the token is wrong"))
        if request["ask"] == "call":
            self._begin(peer, request, fds)
            return True
        if request["ask"] == "stop":
            self._is_ending = True
        known = {"pid": os.getpid(), "calls": self._calls, "running": len(self._running)}
        times = {"up_s": time.monotonic() - self._began, "idle_s": self._idle_s}
        _tell(peer, **known, **times, level=self._level, changed=self._change().serialise())
        return False

    def _change(self) -> Message:
        """Return what of all that they have loaded has changed."""
        name = started_with.differing(self._files, started_with.files(self._folders))
        return msg("{what} has changed since they were started", what=name) if name else NOTHING

    def _begin(self, peer: socket.socket, request: Mapping[str, Any], fds: list[int]) -> None:
        """Fork for a call."""
        if self._is_ending:
            raise UsageError(msg("they are ending"))
        for before, now in zip(self._other, request["started_with"], strict=True):
            if name := started_with.differing(before, now):
                raise UsageError(ANOTHER.given(what=name))
        if change := self._change():
            self._is_ending = True
            raise UsageError(change)
        try:
            branches = fork_servers.branches()
        except (ServerLost, GraderFailure):
            self._is_ending = True
            raise UsageError(msg("one of their processes was lost")) from None
        server = os.getpid()
        pid = os.fork()
        if pid == 0:
            try:
                _be_call(server, request, fds, branches)
            finally:  # whatever happens, this process never goes on as the server
                os._exit(cli.GRADER_FAILED)
        self._calls, self._last = self._calls + 1, time.monotonic()
        self._running[pid] = peer
        for each in branches.values():
            each.close()
        try:
            pidfd = os.pidfd_open(pid)
            try:
                socket.send_fds(peer, [b"{}"], [pidfd])
            finally:
                os.close(pidfd)
        except OSError:
            self._cancel(peer)

    def _cancel(self, peer: socket.socket) -> None:
        """End the call of who has gone, or says more than a call."""
        for pid, waiting in self._running.items():
            if waiting is peer:
                os.kill(pid, signal.SIGTERM)
                self._running[pid] = None
        peer.close()

    def _report_ends(self) -> None:
        with suppress(ChildProcessError):
            while (ended := os.waitpid(-1, os.WNOHANG))[0]:  # also of orphans that were adopted
                self._last = time.monotonic()
                if peer := self._running.pop(ended[0], None):
                    _tell(peer, exit=os.waitstatus_to_exitcode(ended[1]))
                    peer.close()


def _packages() -> Iterator[str]:
    """Yield the folders of all packages that extend the grader, its own among them."""
    points = (
        point for group in GROUPS for each in extensions.points(group).values() for point in each
    )
    for name in {"grader", *(point.module.partition(".")[0] for point in points)}:
        if (spec := find_spec(name)) is not None:
            yield from spec.submodule_search_locations or ()


def _read(file: int) -> Mapping[str, Any]:
    """Read a request.

    Raises:
        ValueError: it is none.
    """
    found = os.fstat(file)
    if not stat.S_ISREG(found.st_mode) or found.st_size > LONGEST:
        raise ValueError
    request = json.loads(os.pread(file, LONGEST, 0))
    if not isinstance(request, dict):
        raise ValueError
    return request


def _tell(peer: socket.socket, **what: object) -> None:
    with suppress(OSError):  # it has gone
        peer.send(json.dumps(what).encode())


# In a call ------------------------------------------------------------------------------------


def _be_call(
    server: int, request: Mapping[str, Any], fds: list[int], branches: Mapping[str, Branch]
) -> NoReturn:
    """Be the process that a call would have been."""
    code = cli.GRADER_FAILED
    try:
        signal.set_wakeup_fd(-1)
        for number in (signal.SIGCHLD, signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT):
            signal.signal(number, signal.SIG_DFL)
        signal.signal(signal.SIGINT, signal.default_int_handler)
        for number in request["ignored"]:
            signal.signal(number, signal.SIG_IGN)
        linux.go_with_parent(server, signal.SIGTERM)
        *standard, here = fds
        for stream, fd in enumerate(standard):
            os.dup2(fd, stream)
        os.fchdir(here)
        linux.close_descriptors(
            {0, 1, 2, *(fd for each in branches.values() for fd in each.descriptors())}
        )
        _take_over_streams()
        os.umask(request["umask"])
        with suppress(OSError):  # where fewer are left
            os.sched_setaffinity(0, request["cores"])
        own = started_with.environment()
        os.environ.clear()
        os.environ.update({**request["environment"], **own})
        fork_servers.take(branches)
        sys.argv[:] = ["grader", *request["words"]]
        code = cli.main(request["words"])
    except SystemExit as end:  # of --help
        code = int(end.code or 0)
    except BaseException:
        traceback.print_exc()
    finally:
        cli.leave(code)


def _take_over_streams() -> None:
    """Open the standard streams as Python does at its start."""
    for number, name in enumerate(("stdin", "stdout", "stderr")):
        before = getattr(sys, f"__{name}__")
        stream = open(  # noqa: SIM115
            number,
            before.mode,
            encoding=before.encoding,
            errors=before.errors,
            closefd=False,
        )
        stream.reconfigure(line_buffering=number == 2 or os.isatty(number))
        setattr(sys, name, stream)


# The start ------------------------------------------------------------------------------------


def main(argv: list[str]) -> int:
    """Serve until there is a reason to end; the exit code."""
    os.chdir("/")
    linux.control(linux.PR_SET_CHILD_SUBREAPER, 1)  # as a call by itself does
    said = os.dup(1)
    os.dup2(0, 1)  # /dev/null
    try:
        with _ready() as level, place.listening() as (listener, token):
            servers = Servers(listener, token, level, float(argv[0]))
            gc.collect()
            gc.freeze()
            os.write(said, b"{}\n")
            os.close(said)
            servers.serve()
    except GraderError as error:
        os.write(said, json.dumps({"refused": error.message.serialise()}).encode() + b"\n")
        return error.exit_code
    return 0


@contextmanager
def _ready() -> Iterator[str]:
    """Load what calls need; yield the level at which submissions are confined.

    Raises:
        UsageError: no server may outlive a call here.
    """
    fork_servers.warm()
    for name in MODULES:
        importlib.import_module(name)
    load_exercise(DEFAULT)
    with scratch.make_folder() as folder, network.obtain_isolation(folder) as isolated:
        found = levels.best(isolated)
    if not found.is_at_least(LANDLOCK):
        raise UsageError(AT_LIMITS.given(level=found.level))
    try:
        os.close(os.pidfd_open(os.getpid()))
    except OSError:
        raise UsageError(msg("this system gives no descriptors of processes")) from None
    # as long as one of the trial's runs, a fork could inherit what it holds
    for thread in threading.enumerate():
        if thread is not threading.current_thread():
            thread.join()
    try:
        yield found.name()
    finally:
        fork_servers.close()


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
