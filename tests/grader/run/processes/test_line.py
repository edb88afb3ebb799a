"""The simulator's process gets its end of the line, whether it can inherit it or has to call."""

import socket
from concurrent.futures import ThreadPoolExecutor

import pytest

from grader import system
from grader.run.processes.line import LOOPBACK, Line, take_up


@pytest.fixture
def calls(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(system, "inherits_descriptors", lambda: False)


def test_an_inherited_line() -> None:
    with Line() as line:
        (theirs,) = line.fds
        assert line.word == str(theirs)
        with line.connect(lambda: True, 5.0) as ours:
            assert ours.fileno() >= 0


def test_a_line_that_has_to_be_called(calls: None) -> None:
    with Line() as line, ThreadPoolExecutor(1) as pool:
        assert line.fds == ()
        called = pool.submit(take_up, line.word)
        ours = line.connect(lambda: True, 20.0)
        with called.result() as theirs:
            theirs.sendall(b"ready")
            assert ours.recv(5) == b"ready"


def test_who_does_not_know_the_word_is_not_heard(calls: None) -> None:
    with Line() as line, ThreadPoolExecutor(1) as pool:
        port = int(line.word.partition(":")[0])
        stranger = socket.create_connection((LOOPBACK, port))
        stranger.sendall(b"x" * 32)
        called = pool.submit(take_up, line.word)
        ours = line.connect(lambda: True, 20.0)
        with called.result() as theirs:
            theirs.sendall(b"right")
            assert ours.recv(5) == b"right"
        stranger.close()


def test_a_process_that_dies_without_a_call_is_not_waited_for(calls: None) -> None:
    with Line() as line, pytest.raises(ConnectionError, match="nobody called"):
        line.connect(lambda: False, 1000.0)
