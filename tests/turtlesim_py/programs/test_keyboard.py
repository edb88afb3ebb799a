import os
import pty
import signal
import termios
from dataclasses import dataclass

import pytest

from turtlesim_py.programs.teleop_key import Keyboard, NotATerminal


@dataclass
class Terminal:
    """A pseudo terminal: what is typed into `keys` is read from `file`."""

    keys: int
    file: int

    def type(self, text):
        os.write(self.keys, text)

    def shows_keys(self):
        return bool(termios.tcgetattr(self.file)[3] & termios.ECHO)


@pytest.fixture
def terminal():
    keys, file = pty.openpty()
    yield Terminal(keys, file)
    for end in (keys, file):
        os.close(end)


@pytest.mark.parametrize(
    ("typed", "keys"),
    [
        (b"\x1b[A\x1b[B\x1b[C\x1b[D", ["up", "down", "right", "left"]),
        (b"\x1bOA\x1bOB\x1bOC\x1bOD", ["up", "down", "right", "left"]),
        (b"gTq", ["g", "t", "q"]),
        (b"a\x1b[Ab\x1b[Ac", ["a", "up", "b", "up", "c"]),
        (b"\x1b[5~\x1b[1;2A\x1b[15~x", ["x"]),  # page up, shift and up, F5
        (b"\x1bqx", ["x"]),  # Alt and q
        ("ü1 \n\t\x04x".encode(), ["x"]),
    ],
)
def test_keys_are_told_apart(terminal, typed, keys):
    with Keyboard(terminal.file) as keyboard:
        terminal.type(typed)
        assert list(keyboard.keys(1.0)) == keys


def test_a_sequence_may_come_in_pieces(terminal):
    with Keyboard(terminal.file) as keyboard:
        found = []
        for piece in (b"\x1b", b"[", b"Ax\x1b[", b"B"):
            terminal.type(piece)
            found += keyboard.keys(1.0)
        assert found == ["up", "x", "down"]


def test_the_escape_key_alone_does_not_swallow_the_next_one(terminal):
    with Keyboard(terminal.file) as keyboard:
        terminal.type(b"\x1b")
        assert list(keyboard.keys(1.0)) == []
        assert list(keyboard.keys(0.0)) == []  # nothing more for now
        terminal.type(b"q")
        assert list(keyboard.keys(1.0)) == ["q"]


def test_the_terminal_is_restored_even_after_an_exception(terminal):
    found = termios.tcgetattr(terminal.file)
    with pytest.raises(ZeroDivisionError), Keyboard(terminal.file):
        assert not terminal.shows_keys()
        raise ZeroDivisionError
    assert termios.tcgetattr(terminal.file) == found


def test_signals_that_end_a_program_close_it_and_are_handled_as_before_afterwards(terminal):
    numbers = (signal.SIGHUP, signal.SIGQUIT, signal.SIGTSTP, signal.SIGCONT)
    before = [signal.getsignal(number) for number in numbers]
    for number in numbers[:2]:
        with Keyboard(terminal.file) as keyboard:
            assert [signal.getsignal(each) for each in numbers] != before
            assert not keyboard.closed
            signal.raise_signal(number)
            assert keyboard.closed
        assert [signal.getsignal(each) for each in numbers] == before


def test_it_closes_when_the_terminal_goes_away():
    keys, file = pty.openpty()
    with Keyboard(file) as keyboard:
        os.close(keys)
        assert list(keyboard.keys(1.0)) == []
        assert keyboard.closed
    os.close(file)


def test_a_pipe_is_not_a_terminal():
    ends = os.pipe()
    with pytest.raises(NotATerminal):
        Keyboard(ends[0])
    for end in ends:
        os.close(end)
