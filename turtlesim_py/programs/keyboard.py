"""Single keys from a real terminal, which is always left as it was found."""

from __future__ import annotations

import os
import re
import select
import signal
from collections.abc import Iterator
from typing import Any, Self

try:
    import termios
except ImportError:  # Windows
    termios = None  # type: ignore[assignment]

#: The last letter of what an arrow key sends, in a terminal's normal or application mode.
ARROWS = {b"A": "up", b"B": "down", b"C": "right", b"D": "left"}
#: What a key sends: a letter behind ESC O or ESC [, perhaps with digits for a held key; with Alt,
#: ESC and a character; else one character.
KEY = re.compile(rb"\x1bO(.)|\x1b\[([0-9;]*[A-Za-z~])|\x1b[^O\[]|(?s:.)")
#: A beginning of these, of which more is to come.
UNFINISHED = re.compile(rb"\x1b(O|\[[0-9;]*)?\Z")


class NotATerminal(OSError):
    """Keys cannot be read one by one from this file."""


class Keyboard:
    """A context in which a terminal gives every key at once and shows none of them.

    Ctrl-Z gives the terminal back for the pause. SIGHUP and SIGQUIT, which would end the program
    on the spot, only close the keyboard; SIGINT and SIGTERM are the program's own affair.

    Attributes:
        closed: nothing more will come.

    Raises:
        NotATerminal: `file` is none.
    """

    def __init__(self, file: int) -> None:
        if termios is None:
            raise NotATerminal("this system has no termios, which gives single keys")
        if not os.isatty(file):
            raise NotATerminal("standard input is not a terminal: start it in one of its own")
        self.closed = False
        self._file = file
        self._taken = False
        self._rest = b""

    def __enter__(self) -> Self:
        self._found = termios.tcgetattr(self._file)
        handlers: dict[signal.Signals, Any] = {
            signal.SIGHUP: self._close,
            signal.SIGQUIT: self._close,
            signal.SIGTSTP: self._pause,
            signal.SIGCONT: self._take,
        }
        self._handlers = {number: signal.signal(number, do) for number, do in handlers.items()}
        self._take()
        return self

    def __exit__(self, *_: object) -> None:
        self._give_back()
        for number, handler in self._handlers.items():
            signal.signal(number, handler)

    def keys(self, patience_s: float) -> Iterator[str]:
        """Yield the keys that come within the time [s]: "up", "down", "left", "right" or a letter.

        Letters are small. Keys that have no meaning here are left out.
        """
        if not select.select([self._file], [], [], patience_s)[0]:
            self._rest = b""  # the rest would have come at once: it was the escape key alone
            return
        text = self._rest + self._read()
        unfinished = UNFINISHED.search(text)
        end = unfinished.start() if unfinished else len(text)
        self._rest = text[end:]
        for match in KEY.finditer(text, 0, end):
            if arrow := ARROWS.get(match[1] or match[2]):
                yield arrow
            elif match[0].isalpha():
                yield match[0].decode().lower()

    def _read(self) -> bytes:
        try:
            read = os.read(self._file, 1024)
        except OSError:
            read = b""
        if not read:
            self.closed = True  # the terminal is gone
        return read

    def _take(self, *_: object) -> None:
        if self._is_in_front():
            ours = termios.tcgetattr(self._file)
            ours[3] &= ~(termios.ICANON | termios.ECHO)  # Ctrl-C and Ctrl-Z stay signals
            termios.tcsetattr(self._file, termios.TCSANOW, ours)
            self._taken = True

    def _give_back(self) -> None:
        if self._taken and self._is_in_front():
            termios.tcsetattr(self._file, termios.TCSANOW, self._found)
        self._taken = False

    def _is_in_front(self) -> bool:
        """Whether the terminal is ours: in the background it is a shell's or another program's."""
        if not os.isatty(self._file):
            return False  # it is gone
        try:
            return os.tcgetpgrp(self._file) == os.getpgrp()
        except OSError:
            return True  # no shell has it

    def _close(self, *_: object) -> None:
        self.closed = True

    def _pause(self, number: int, _: object) -> None:
        self._give_back()
        handler = signal.signal(number, signal.SIG_DFL)
        signal.raise_signal(number)  # here the program stands still
        signal.signal(number, handler)
        self._take()
