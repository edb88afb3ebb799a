"""An end of the link between the two processes: whole packets, however long they are."""

from __future__ import annotations

import socket
from collections.abc import Iterator

from grader.run.lockstep.protocol import ProtocolError

#: The most that is handed to the system at once: a socket takes no longer packet as a whole.
PIECE_BYTES = 150_000
#: The longest packet from the simulator: a picture of the window takes 0.75 MB, and some may come
#: at once.
LIMIT_BYTES = 64_000_000
#: Before each piece of a longer packet, and before its last one.
MORE, LAST = b"+", b"-"


def pieces(data: bytes) -> Iterator[bytes]:
    """What is to be sent, one after the other, so that a `PacketReader` reads the packet."""
    if len(data) <= PIECE_BYTES:
        yield data
        return
    for begin in range(0, len(data), PIECE_BYTES):
        end = begin + PIECE_BYTES
        yield (LAST if end >= len(data) else MORE) + data[begin:end]


class PacketReader:
    """Puts pieces together again."""

    def __init__(self, link: socket.socket, limit_bytes: int = LIMIT_BYTES) -> None:
        self._link = link
        self._limit_bytes = limit_bytes
        self._pieces: list[bytes] = []
        self._length = 0

    def read(self) -> bytes | None:
        """Receive once: a packet, or b"" when the other side has gone; None: there is more of it.

        Raises:
            OSError: the other side has gone.
            ProtocolError: it is longer than any of ours, or in pieces that are none of ours.
        """
        data = self._link.recv(PIECE_BYTES + 1)
        if data[:1] not in (MORE, LAST):
            if self._pieces and data:
                raise ProtocolError(f"{data[:32]!r} in the middle of a packet")
            return data
        is_last = data[:1] == LAST
        if not is_last and len(data) != PIECE_BYTES + 1:  # many small ones would fill memory too
            raise ProtocolError(f"a piece of {len(data)} bytes")
        self._pieces.append(data[1:])
        self._length += len(data)
        if self._length > self._limit_bytes:
            raise ProtocolError(f"a packet of more than {self._limit_bytes} bytes")
        if not is_last:
            return None
        whole = b"".join(self._pieces)
        self._pieces, self._length = [], 0
        return whole
