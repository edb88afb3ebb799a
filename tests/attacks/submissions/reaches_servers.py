"""Reaches for the servers that outlive a grading: their token, their socket, their folder."""

import glob
import json
import os
import socket
import tempfile

import known
from tools import achieved, attempt

tokens = [""]
homes = {"/tmp", known.TEMP, tempfile.gettempdir()}
places = {f"{home}/turtlesim-grader-{known.USER}/servers" for home in homes}
places |= {path for home in homes for path in glob.glob(f"{home}/turtlesim-grader-*/servers")}
for place in places:
    with attempt():
        tokens.append(open(f"{place}/token").read())  # noqa: SIM115
        achieved("read the token of the servers")
    for token in tokens:
        for what in ("status", "stop"):
            with attempt():
                peer = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
                peer.settimeout(3.0)
                peer.connect(f"{place}/socket")
                request = os.memfd_create("request")
                os.write(request, json.dumps({"token": token, "ask": what}).encode())
                socket.send_fds(peer, [b"request"], [request])
                answer = peer.recv(4096)
                if answer and b"refused" not in answer:
                    achieved("was answered by the servers", answer)
    for name in ("socket", "token"):
        with attempt():
            os.unlink(f"{place}/{name}")
            achieved("took away what belongs to the servers", name)
    with attempt():
        os.rename(place, f"{place}-elsewhere")
        achieved("took the folder of the servers away")
