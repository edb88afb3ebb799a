"""The first packet of the link is the simulator's table, with the mailbox, and nothing else."""

import socket
import tempfile

import pytest

from grader.run.clock.link import SimulatorSockets
from grader.run.lockstep.protocol import PROGRESS_BYTES, ProtocolError, Reply, Table, encode, pieces


@pytest.mark.parametrize("packet", [Reply(0, False, 0, 0), Table(())])
def test_another_packet_or_one_without_its_mailbox_is_the_submissions_doing(packet):
    ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    refused = []
    with ours, theirs, tempfile.TemporaryFile() as page:
        page.truncate(PROGRESS_BYTES)
        for piece in pieces(encode(packet)):
            ours.send(piece)
        with pytest.raises(ProtocolError, match="where a table was expected"):
            SimulatorSockets(theirs, page.fileno(), refused.append).introduction()
    assert "broke our virtual time" in str(refused[0])
