"""The student's end of the sockets and the page that both processes have.

Where the simulator has gone, this process ends; nobody would hear what it still did.
"""

from __future__ import annotations

import mmap
import os
import socket
from collections.abc import Callable
from typing import Any, NoReturn

from grader.run.lockstep import link, real
from grader.run.lockstep.protocol import (
    PROGRESS,
    Kind,
    Mail,
    Note,
    Packet,
    Parcel,
    ProtocolError,
    Table,
    decode,
    encode,
)


class SimulatorChannel:
    """Packets to and from the simulator; `take_up` comes before anything else."""

    def __init__(self, refuse: Callable[[str], None]) -> None:
        self._refuse = refuse
        self._connection: socket.socket
        self._packets: link.PacketReader
        self._mailbox: socket.socket
        self._progress: Any = bytearray(PROGRESS.size)

    def take_up(self, connection: socket.socket) -> None:
        """Use this connection from now on."""
        self._connection = connection
        self._packets = link.PacketReader(connection)

    def introduction(self) -> Table:
        """The first table, and with it the page that both processes see, and where mail goes."""
        try:
            data, descriptors, _, _ = socket.recv_fds(self._connection, link.PIECE_BYTES, 2)
        except OSError:
            data = b""
        if not data:
            real.leave(1)
        packet = self._decode(data)
        if not isinstance(packet, Table) or len(descriptors) != 2:
            self.fail(packet, "a table")
        page, mailbox = descriptors
        os.set_inheritable(mailbox, False)
        self._progress = mmap.mmap(page, mmap.PAGESIZE)
        os.close(page)
        self._mailbox = socket.socket(fileno=mailbox)
        self._mailbox.setblocking(False)
        return packet

    def note(self, kind: Kind, text: str = "") -> None:
        """Tell the simulator something about this process."""
        self.send(Note(kind, text))

    def send(self, packet: Packet) -> None:
        """Send a packet that the simulator waits for, or does not answer."""
        try:
            for piece in link.pieces(encode(packet)):
                self._connection.send(piece)
        except OSError:
            real.leave(1)

    def receive(self) -> Packet:
        """Wait for a packet."""
        data: bytes | None = None
        while data is None:
            try:
                data = self._packets.read()
            except OSError:
                data = b""
        if not data:
            real.leave(1)
        return self._decode(data)

    def mail(self, parcel: Parcel) -> list[bytes]:
        """Put a parcel into the mailbox; returns what of it is left, for `mail_rest`."""
        return self.mail_rest(list(link.pieces(encode(Mail([parcel])))))

    def mail_rest(self, pieces: list[bytes]) -> list[bytes]:
        """Put the rest of a parcel into the mailbox, when that has been emptied; as `mail`."""
        for number, piece in enumerate(pieces):
            try:
                self._mailbox.send(piece)
            except BlockingIOError:
                return pieces[number:]
            except OSError:
                real.leave(1)
        return []

    def has_reached(self, tick: int) -> None:
        """Say so where it is read when this process has ended without a word."""
        PROGRESS.pack_into(self._progress, 0, tick)

    def fail(self, packet: object, expected: str) -> NoReturn:
        """Somebody else has read or written here, and only the submission can."""
        self._break(ProtocolError(f"{packet!r:.200} where {expected} was expected"))

    def _decode(self, data: bytes) -> Packet:
        try:
            return decode(data)
        except ProtocolError as error:
            self._break(error)

    def _break(self, error: ProtocolError) -> NoReturn:
        self._refuse(f"broke our virtual time ({error!r})")
        raise error
