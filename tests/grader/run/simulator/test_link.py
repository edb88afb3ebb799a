"""What a submission's process may say, and for how long it may say nothing."""

import os
import socket
import subprocess
import sys
from collections.abc import Iterator

import pytest

from grader.run.lockstep.protocol import Advance, Kind, Note, Table, encode
from grader.run.simulator import link
from grader.run.simulator.link import Patience, Refused, StudentLink


@pytest.fixture
def ends() -> Iterator[tuple[socket.socket, socket.socket]]:
    ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    with ours, theirs:
        yield ours, theirs


@pytest.mark.parametrize("data", [b"?", b"A", b"T{}", encode(Table(())), b"\xff" * 1000])
def test_nonsense_ends_the_conversation(
    ends: tuple[socket.socket, socket.socket], data: bytes
) -> None:
    heard = StudentLink(ends[0], os.getpid(), Patience())
    ends[1].send(data)
    assert heard.receive() is None
    assert heard.silence == "broken"
    assert len(heard.flags) == 1


def test_requests_come_through_and_notes_are_kept(
    ends: tuple[socket.socket, socket.socket],
) -> None:
    heard = StudentLink(ends[0], os.getpid(), Patience())
    for packet in (Note(Kind.WARNING, "late\x1b[31m\n"), Note(Kind.STUCK), Advance(5, 1, [])):
        ends[1].send(encode(packet))
    assert heard.receive() == Advance(5, 1, [])
    assert heard.flags == ["late?[31m?"]
    assert heard.waits == "stuck"


def test_a_million_warnings_are_few_flags(ends: tuple[socket.socket, socket.socket]) -> None:
    heard = StudentLink(ends[0], os.getpid(), Patience())
    for number in range(100):
        ends[1].send(encode(Note(Kind.WARNING, f"warning {number}")))
    ends[1].close()
    assert heard.receive() is None
    assert (heard.silence, len(heard.flags)) == ("gone", link.MOST_FLAGS)


def test_what_is_not_supported_is_refused(ends: tuple[socket.socket, socket.socket]) -> None:
    ends[1].send(encode(Note(Kind.UNSUPPORTED, "forks")))
    with pytest.raises(Refused, match=r"^the submission forks$"):
        StudentLink(ends[0], os.getpid(), Patience()).receive()


def test_where_virtual_time_fails_the_submission_is_not_named(
    ends: tuple[socket.socket, socket.socket],
) -> None:
    ends[1].send(encode(Note(Kind.FAILED, "virtual time itself failed")))
    with pytest.raises(Refused, match=r"^virtual time itself failed$"):
        StudentLink(ends[0], os.getpid(), Patience()).receive()


def test_computing_without_end_is_a_stall(
    ends: tuple[socket.socket, socket.socket],
) -> None:
    with subprocess.Popen([sys.executable, "-c", "while True: pass"]) as process:
        heard = StudentLink(ends[0], process.pid, Patience(start_cpu_s=0.3))
        assert heard.receive() is None
        process.kill()
    assert heard.silence == "stalled"


def test_sleeping_outside_of_virtual_time_is_refused(
    ends: tuple[socket.socket, socket.socket],
) -> None:
    with subprocess.Popen(["sleep", "60"]) as process:
        with pytest.raises(Refused):
            StudentLink(ends[0], process.pid, Patience(asleep_s=0.5)).receive()
        process.kill()
