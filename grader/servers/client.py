"""The call's side of the servers: has them do a call, as if this process did it.

Cheap to import: every call of the command line looks here first, and most find no servers.
"""

from __future__ import annotations

import json
import os
import select
import signal
import socket
from collections.abc import Sequence
from contextlib import ExitStack, suppress
from typing import Any

from grader import system
from grader.errors import GraderFailure
from grader.message import Message, Text, msg
from grader.servers import place, started_with

#: The verbs that servers do; the others run for hours, or hardly at all.
VERBS = ("run", "check")
#: How long servers may take to answer [s]; only an overloaded machine does.
PATIENCE_S = 10.0
#: No packet is longer [bytes].
LONGEST = 4096
#: What is passed on to the call.
SIGNALS = [
    getattr(signal, name)
    for name in ("SIGINT", "SIGTERM", "SIGHUP", "SIGQUIT")
    if hasattr(signal, name)  # Windows lacks some
]


class CallRefused(Exception):
    """The servers do not do something, for the reason `why`."""

    def __init__(self, why: Text) -> None:
        super().__init__(why)
        self.why = why


class CallLost(Exception):
    """A call that had begun came to no end of its own."""


def called(words: Sequence[str]) -> int | None:
    """Have the servers do a call, and return its exit code; None where there are no servers.

    Raises:
        CallRefused: there are, but they do not do this one.
        CallLost: they have ended during it, or its process was killed.
    """
    is_theirs = system.runs_submissions() and not place.is_off()
    if not is_theirs or next(iter(words), "") not in VERBS or not _has_streams():
        return None
    try:
        with place.opened() as folder, place.connected(folder) as servers, ExitStack() as held:
            here = os.open(".", os.O_RDONLY | os.O_DIRECTORY)
            held.callback(os.close, here)
            _ask(servers, folder, "call", _call(words), [0, 1, 2, here])
            return _followed(servers)
    except (FileNotFoundError, ConnectionRefusedError, GraderFailure):
        return None  # nobody is there, or there is no place for anybody
    except place.Occupied as occupied:
        raise CallRefused(occupied.message) from None
    except (OSError, ValueError) as error:
        raise CallRefused(str(error)) from None


def asked(what: str) -> dict[str, Any]:
    """Ask the servers for something else than a call, and return their answer.

    Where they end, and nothing goes on, this waits until they have ended.

    Raises:
        OSError: there are none, or they do not answer.
        CallRefused, place.Occupied: they refuse; another has their place.
    """
    with place.opened() as folder, place.connected(folder) as servers:
        _ask(servers, folder, what, {}, [])
        known = _answer(servers)[0]
        if what == "stop" and not known["running"]:
            with suppress(ProcessLookupError):
                process = os.pidfd_open(known["pid"])
                select.select([process], [], [], PATIENCE_S)
                os.close(process)
        return known


def _ask(
    servers: socket.socket, folder: int, what: str, more: dict[str, Any], fds: Sequence[int]
) -> None:
    """Send a request, a file in memory, with the token in it, and descriptors."""
    servers.settimeout(PATIENCE_S)
    request = os.memfd_create("request")
    try:
        os.write(
            request, json.dumps({"token": place.read_token(folder), "ask": what, **more}).encode()
        )
        socket.send_fds(servers, [b"request"], [request, *fds])
    finally:
        os.close(request)


def _answer(servers: socket.socket) -> tuple[dict[str, Any], list[int]]:
    """Receive an answer, and the descriptors that come with it."""
    data, fds, _, _ = socket.recv_fds(servers, LONGEST, 1)
    if not data:
        raise CallRefused(msg("they have ended"))
    said: dict[str, Any] = json.loads(data)
    if "refused" in said:
        raise CallRefused(Message.parse(said["refused"]))
    return said, fds


def _call(words: Sequence[str]) -> dict[str, Any]:
    """Return what a call has besides its descriptors."""
    os.umask(mask := os.umask(0o077))
    return {
        "words": list(words),
        "environment": dict(os.environ),
        "started_with": [started_with.environment(), started_with.process()],
        "umask": mask,
        "cores": sorted(os.sched_getaffinity(0)),
        "ignored": [each for each in SIGNALS if signal.getsignal(each) == signal.SIG_IGN],
    }


def _followed(servers: socket.socket) -> int:
    """Wait for the end of a call that has begun, and pass on to it what this process is told."""
    _, (process,) = _answer(servers)

    def pass_on(number: int, _: object) -> None:
        with suppress(ProcessLookupError):
            signal.pidfd_send_signal(process, number)

    for number in SIGNALS:
        if signal.getsignal(number) != signal.SIG_IGN:
            signal.signal(number, pass_on)
    servers.settimeout(None)
    try:
        select.select([servers], [], [])
        code = int(_answer(servers)[0]["exit"])
    except (CallRefused, OSError):
        raise CallLost from None
    if code < 0 and -code not in SIGNALS:
        raise CallLost
    return code if code >= 0 else 128 - code


def _has_streams() -> bool:
    """Whether the three standard ones are open: else another file gets their number."""
    try:
        return all(os.fstat(fd) for fd in range(3))
    except OSError:
        return False
