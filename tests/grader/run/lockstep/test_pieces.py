"""Packets of any length go through a socket that takes short ones only."""

import os
from threading import Thread

import pytest

from grader.run.lockstep.protocol import (
    LAST,
    MORE,
    PIECE_BYTES,
    PacketReader,
    ProtocolError,
    pieces,
)


@pytest.fixture
def ours(ends):
    return ends[0]


@pytest.mark.parametrize("length", [1, PIECE_BYTES, PIECE_BYTES + 1, 10 * PIECE_BYTES])
def test_a_packet_comes_out_as_it_went_in(ours, theirs, length):
    packet = b"P" + os.urandom(length - 1)

    def send() -> None:
        for piece in (*pieces(packet), *pieces(b"next")):
            theirs.send(piece)

    sender = Thread(target=send)
    sender.start()
    reader = PacketReader(ours)
    found = [data for data in iter(reader.read, b"next") if data is not None]
    sender.join()
    assert found == [packet]


def test_a_piece_that_is_none_is_an_error(ours, theirs):
    reader = PacketReader(ours)
    theirs.send(MORE + bytes(PIECE_BYTES))
    assert reader.read() is None
    theirs.send(b"another packet")
    with pytest.raises(ProtocolError):
        reader.read()


def test_who_goes_in_the_middle_of_a_packet_has_gone(ours, theirs):
    reader = PacketReader(ours)
    theirs.send(MORE + bytes(PIECE_BYTES))
    theirs.close()
    assert reader.read() is None
    assert reader.read() == b""


def test_the_last_piece_alone_is_a_packet(ours, theirs):
    theirs.send(LAST + b"all")
    assert PacketReader(ours).read() == b"all"


def test_many_small_pieces_are_none_of_ours(ours, theirs):
    theirs.send(MORE + b"x")
    with pytest.raises(ProtocolError):
        PacketReader(ours).read()


def test_a_packet_without_end_is_an_error(ours, theirs):
    reader = PacketReader(ours, limit_bytes=2 * PIECE_BYTES)
    theirs.send(MORE + bytes(PIECE_BYTES))
    assert reader.read() is None
    theirs.send(MORE + bytes(PIECE_BYTES))
    with pytest.raises(ProtocolError, match="more than"):
        reader.read()
