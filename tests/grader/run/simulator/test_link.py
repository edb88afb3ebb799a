"""What a submission's process may say, and for how long it may say nothing."""

import math
import os
import signal
import socket
import subprocess
import sys
import time
from itertools import chain

import pytest

from grader.run.limits import Patience
from grader.run.lockstep.protocol import (
    PROGRESS,
    Advance,
    Kind,
    Mail,
    Note,
    Parcel,
    Reply,
    Table,
    encode,
)
from grader.run.observe import account
from grader.run.simulator import link
from grader.run.simulator.link import Refused, StudentLink
from grader.text.message import Message

#: Where nobody asks how far a process has got.
NO_PAGE = -1
ADVANCE = Advance(5, True, 0, 0)


@pytest.fixture
def listen(ends):
    """Give our end: of this process, where no other is named."""

    def listen(pid: int = os.getpid(), page: int = NO_PAGE, **patience: float) -> StudentLink:
        return StudentLink(ends[0], page, pid, Patience(**patience))

    return listen


def mailbox(heard: StudentLink, theirs: socket.socket) -> socket.socket:
    """Introduce a process, and give where it mails to."""
    heard.introduce(Table(()))
    _, (fd,), _, _ = socket.recv_fds(theirs, 1000, 1)
    return socket.socket(fileno=fd)


@pytest.mark.parametrize("data", [b"?", b"A", b"T{}", encode(Reply(0, True, 0)), b"\xff" * 1000])
def test_nonsense_ends_the_conversation(listen, theirs, data):
    heard = listen()
    theirs.send(data)
    assert heard.receive() is None
    assert (heard.silence, len(heard.flags)) == ("broken", 1)


def test_requests_come_through_and_notes_are_kept(listen, theirs):
    heard = listen()
    for packet in (Note(Kind.STUCK), ADVANCE):
        theirs.send(encode(packet))
    assert heard.receive() == ADVANCE
    assert heard.waits == "stuck"


def test_a_million_remarks_are_few_flags(listen):
    heard = listen()
    for number in range(100):
        heard.flag(f"remark {number}")
    assert len(heard.flags) == link.MOST_FLAGS


def test_what_a_dead_process_has_mailed_and_reached_is_known(listen, theirs):
    page = account.make()
    heard = listen(page=page)
    parcels = [Parcel(3, 0, number, 7, b"command") for number in range(5)]
    with mailbox(heard, theirs) as mail:
        for parcel in parcels:
            mail.send(encode(Mail([parcel])))
    os.pwrite(page, PROGRESS.pack(41), 0)
    theirs.close()
    assert heard.receive() is None
    assert (list(chain(*heard.mail())), heard.reached()) == (parcels, 41)
    heard.mailbox.close()
    os.close(page)


def test_nonsense_in_the_mail_ends_the_conversation(listen, theirs):
    heard = listen()
    with mailbox(heard, theirs) as mail:
        mail.send(b"?")
        mail.send(encode(ADVANCE))
        assert list(heard.mail()) == []
    assert heard.silence == "broken"
    heard.mailbox.close()


def test_a_run_that_uses_up_its_processor_time_is_slow(listen, theirs, monkeypatch):
    monkeypatch.setattr(link, "CPU_CHECK_S", 0.0)
    heard = listen(run_cpu_s=0.0)
    theirs.send(encode(ADVANCE))
    assert heard.receive() is None
    assert heard.silence == "slow"


@pytest.mark.parametrize(("excused_cpu_s", "silence"), [(0.0, "flooding"), (60.0, "")])
def test_what_the_simulator_spends_on_showing_a_run_is_not_the_submissions_doing(
    listen, theirs, monkeypatch, excused_cpu_s, silence
):
    monkeypatch.setattr(link, "CPU_CHECK_S", 0.0)
    # of this process, whose pid stands for the submission's, nothing is limited
    heard = listen(run_cpu_s=math.inf, simulator_cpu_s=30.0)
    heard.excused_cpu_s = excused_cpu_s
    before_s = time.process_time()
    monkeypatch.setattr(time, "process_time", lambda: before_s + 50.0)
    theirs.send(encode(ADVANCE))
    heard.receive()
    assert heard.silence == silence


@pytest.mark.parametrize(
    ("kind", "remark", "told"),
    [
        (Kind.UNSUPPORTED, "forks\x1b[31m\n", r"^the submission forks\?\[31m\?$"),
        (Kind.FAILED, "virtual time itself failed", r"^virtual time itself failed$"),
    ],
)
def test_what_is_not_supported_is_refused_and_what_fails_does_not_name_the_submission(
    listen, theirs, kind, remark, told
):
    theirs.send(encode(Note(kind, Message.of(remark))))
    with pytest.raises(Refused, match=told):
        listen().receive()


COMPUTES = (sys.executable, "-S", "-c", "while True: pass")
NAPS = "import time\nwhile True:\n time.sleep(0.1)\n for _ in range(10_000): pass"


@pytest.mark.parametrize(
    ("words", "is_stopped", "patience", "silence"),
    [
        pytest.param(COMPUTES, False, {"start_cpu_s": 0.1}, "stalled", id="computes"),
        pytest.param(("sleep", "60"), True, {"asleep_s": 0.1}, "stopped", id="is stopped"),
        pytest.param(("sleep", "60"), False, {"asleep_s": 0.2}, "refused", id="sleeps"),
        pytest.param(
            *((sys.executable, "-S", "-c", NAPS), False),
            *({"start_cpu_s": 1000.0, "all_asleep_s": 0.3}, "refused"),
            id="naps, again and again",
        ),
    ],
)
def test_a_silent_process_is_waited_for_by_what_it_does(
    listen, words, is_stopped, patience, silence
):
    with subprocess.Popen(words) as process:
        if is_stopped:
            process.send_signal(signal.SIGSTOP)
        heard = listen(process.pid, **patience)
        try:
            assert heard.receive() is None
            found = heard.silence
        except Refused:
            found = "refused"
        process.kill()
    assert found == silence


def test_a_process_that_has_ended_is_gone_although_a_descendant_holds_the_link(listen):
    with subprocess.Popen(["true"]) as process:
        os.waitid(os.P_PID, process.pid, os.WEXITED | os.WNOWAIT)
        heard = listen(process.pid, asleep_s=1000.0)
        assert heard.receive() is None
    assert heard.silence == "gone"
