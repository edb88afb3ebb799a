"""What a submission's process may say, and for how long it may say nothing."""

import math
import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from itertools import chain

import pytest

from grader.message import plain_text
from grader.run.limits import Patience
from grader.run.lockstep.protocol import (
    PROGRESS,
    Advance,
    Kind,
    Mail,
    Note,
    Parcel,
    Reply,
    State,
    Table,
    encode,
)
from grader.run.observe import account
from grader.run.simulator import link
from grader.run.simulator.link import Refused, StudentLink

#: Where nobody asks how far a process has got.
NO_PAGE = -1


@pytest.fixture
def ends() -> Iterator[tuple[socket.socket, socket.socket]]:
    ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    with ours, theirs:
        yield ours, theirs


@pytest.mark.parametrize(
    "data", [b"?", b"A", b"T{}", encode(Reply(0, State.OVER, 0)), b"\xff" * 1000]
)
def test_nonsense_ends_the_conversation(
    ends: tuple[socket.socket, socket.socket], data: bytes
) -> None:
    heard = StudentLink(ends[0], NO_PAGE, os.getpid(), Patience())
    ends[1].send(data)
    assert heard.receive() is None
    assert heard.silence == "broken"
    assert len(heard.flags) == 1


def test_requests_come_through_and_notes_are_kept(
    ends: tuple[socket.socket, socket.socket],
) -> None:
    heard = StudentLink(ends[0], NO_PAGE, os.getpid(), Patience())
    for packet in (Note(Kind.STUCK), Advance(5, True, 0, 0)):
        ends[1].send(encode(packet))
    assert heard.receive() == Advance(5, True, 0, 0)
    assert heard.waits == "stuck"


def test_a_million_remarks_are_few_flags(ends: tuple[socket.socket, socket.socket]) -> None:
    heard = StudentLink(ends[0], NO_PAGE, os.getpid(), Patience())
    for number in range(100):
        heard.flag(f"remark {number}")
    assert len(heard.flags) == link.MOST_FLAGS


def test_what_a_dead_process_has_mailed_and_reached_is_known(
    ends: tuple[socket.socket, socket.socket],
) -> None:
    page = account.make()
    heard = StudentLink(ends[0], page, os.getpid(), Patience())
    heard.introduce(Table(()))
    _, (mailbox,), _, _ = socket.recv_fds(ends[1], 1000, 1)
    parcels = [Parcel(3, 0, number, 7, b"command") for number in range(5)]
    with socket.socket(fileno=mailbox) as mail:
        for parcel in parcels:
            mail.send(encode(Mail([parcel])))
    os.pwrite(page, PROGRESS.pack(41), 0)
    ends[1].close()
    assert heard.receive() is None
    assert (list(chain(*heard.mail())), heard.reached()) == (parcels, 41)
    heard.mailbox.close()
    os.close(page)


def test_nonsense_in_the_mail_ends_the_conversation(
    ends: tuple[socket.socket, socket.socket],
) -> None:
    heard = StudentLink(ends[0], NO_PAGE, os.getpid(), Patience())
    heard.introduce(Table(()))
    _, (mailbox,), _, _ = socket.recv_fds(ends[1], 1000, 1)
    with socket.socket(fileno=mailbox) as mail:
        mail.send(b"?")
        mail.send(encode(Advance(5, True, 0, 0)))
        assert list(heard.mail()) == []
    assert heard.silence == "broken"
    heard.mailbox.close()


def test_a_run_that_uses_up_its_processor_time_is_slow(
    ends: tuple[socket.socket, socket.socket], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(link, "CPU_CHECK_S", 0.0)
    heard = StudentLink(ends[0], NO_PAGE, os.getpid(), Patience(run_cpu_s=0.0))
    ends[1].send(encode(Advance(5, True, 0, 0)))
    assert heard.receive() is None
    assert heard.silence == "slow"


@pytest.mark.parametrize(("excused_cpu_s", "silence"), [(0.0, "flooding"), (60.0, "")])
def test_what_the_simulator_spends_on_showing_a_run_is_not_the_submissions_doing(
    ends: tuple[socket.socket, socket.socket],
    monkeypatch: pytest.MonkeyPatch,
    excused_cpu_s: float,
    silence: str,
) -> None:
    monkeypatch.setattr(link, "CPU_CHECK_S", 0.0)
    # of this process, whose pid stands for the submission's, nothing is limited
    heard = StudentLink(
        ends[0], NO_PAGE, os.getpid(), Patience(run_cpu_s=math.inf, simulator_cpu_s=30.0)
    )
    heard.excused_cpu_s = excused_cpu_s
    before_s = time.process_time()
    monkeypatch.setattr(time, "process_time", lambda: before_s + 50.0)
    ends[1].send(encode(Advance(5, True, 0, 0)))
    heard.receive()
    assert heard.silence == silence


def test_what_is_not_supported_is_refused(ends: tuple[socket.socket, socket.socket]) -> None:
    ends[1].send(encode(Note(Kind.UNSUPPORTED, plain_text("forks\x1b[31m\n"))))
    with pytest.raises(Refused, match=r"^the submission forks\?\[31m\?$"):
        StudentLink(ends[0], NO_PAGE, os.getpid(), Patience()).receive()


def test_where_virtual_time_fails_the_submission_is_not_named(
    ends: tuple[socket.socket, socket.socket],
) -> None:
    ends[1].send(encode(Note(Kind.FAILED, plain_text("virtual time itself failed"))))
    with pytest.raises(Refused, match=r"^virtual time itself failed$"):
        StudentLink(ends[0], NO_PAGE, os.getpid(), Patience()).receive()


def test_computing_without_end_is_a_stall(
    ends: tuple[socket.socket, socket.socket],
) -> None:
    with subprocess.Popen([sys.executable, "-c", "while True: pass"]) as process:
        heard = StudentLink(ends[0], NO_PAGE, process.pid, Patience(start_cpu_s=0.1))
        assert heard.receive() is None
        process.kill()
    assert heard.silence == "stalled"


def test_a_process_that_somebody_has_stopped_is_not_waited_for(
    ends: tuple[socket.socket, socket.socket],
) -> None:
    with subprocess.Popen(["sleep", "60"]) as process:
        process.send_signal(signal.SIGSTOP)
        heard = StudentLink(ends[0], NO_PAGE, process.pid, Patience(asleep_s=0.1))
        assert heard.receive() is None
        process.kill()
    assert heard.silence == "stopped"


NAPS = "import time\nwhile True:\n time.sleep(0.1)\n for _ in range(10_000): pass"


def test_a_process_that_has_ended_is_gone_although_a_descendant_holds_the_link(
    ends: tuple[socket.socket, socket.socket],
) -> None:
    with subprocess.Popen([sys.executable, "-c", ""]) as process:
        os.waitid(os.P_PID, process.pid, os.WEXITED | os.WNOWAIT)
        heard = StudentLink(ends[0], NO_PAGE, process.pid, Patience(asleep_s=1000.0))
        assert heard.receive() is None
    assert heard.silence == "gone"


def test_sleeping_is_added_up_however_often_it_is_interrupted(
    ends: tuple[socket.socket, socket.socket],
) -> None:
    with subprocess.Popen([sys.executable, "-c", NAPS]) as process:
        patience = Patience(start_cpu_s=1000.0, all_asleep_s=0.3)
        with pytest.raises(Refused):
            StudentLink(ends[0], NO_PAGE, process.pid, patience).receive()
        process.kill()


def test_sleeping_outside_of_virtual_time_is_refused(
    ends: tuple[socket.socket, socket.socket],
) -> None:
    with subprocess.Popen(["sleep", "60"]) as process:
        with pytest.raises(Refused):
            StudentLink(ends[0], NO_PAGE, process.pid, Patience(asleep_s=0.2)).receive()
        process.kill()
