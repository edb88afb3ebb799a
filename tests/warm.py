"""`grader` in a fork of a process that has imported it: for tests of what calls it, many times.

The fork has the caller's arguments, environment, folder and descriptors, so that a script cannot
tell it from a process of its own; only the half second of a start is missing.

As a program this serves at the address of a socket; with further arguments it is the caller.
"""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
#: All that a caller may have open: grade.sh opens files as 3 and 4.
DESCRIPTORS = range(5)
MOST_BYTES = 1 << 16


@contextmanager
def serving(folder: Path, env: Mapping[str, str]) -> Iterator[str]:
    """Gives a line of shell that does as `exec python -m grader` would.

    Args:
        folder: an empty one of the caller's own.
        env: what the caller of the line is to have; what an import makes of it is made of this.
    """
    address = str(folder / "warm")
    words = [sys.executable, "-P", __file__, address]
    process = subprocess.Popen(
        words, env={**env, "PYTHONPATH": str(ROOT)}, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE
    )
    try:
        assert process.stdout is not None and process.stdout.readline()
        # nothing but the interpreter: this is started again and again
        yield f'exec {sys.executable} -I -S {__file__} {address} "$@"'
    finally:
        process.terminate()
        process.communicate()


def _serve(address: str) -> None:
    import importlib
    import pkgutil
    import signal
    import socket

    import grader.cli.report
    import grader.reports

    for found in pkgutil.walk_packages(grader.reports.__path__, "grader.reports."):
        importlib.import_module(found.name)
    signal.signal(signal.SIGCHLD, signal.SIG_IGN)  # nobody waits for the forks
    with socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET) as server:
        server.bind(address)
        server.listen()
        os.write(1, b"ready\n")
        while True:
            caller, _ = server.accept()
            if not os.fork():
                signal.signal(signal.SIGCHLD, signal.SIG_DFL)
                server.close()
                os._exit(_answer(caller))
            caller.close()


def _answer(caller: object) -> int:
    """Be the process of a caller; it is told the exit code."""
    import fcntl
    import socket

    from grader.cli import main

    assert isinstance(caller, socket.socket)
    data, fds, _, _ = socket.recv_fds(caller, MOST_BYTES, len(DESCRIPTORS))
    told, words, env = (part.split("\0") for part in data.decode().split("\0\0"))
    os.environ.clear()
    os.environ.update(each.split("=", 1) for each in env)
    os.chdir(told[0])
    # away from the numbers that they are to have
    own, *fds = (fcntl.fcntl(fd, fcntl.F_DUPFD_CLOEXEC, 100) for fd in (caller.fileno(), *fds))
    os.closerange(3, 100)
    for number, fd in zip(map(int, told[1:]), fds, strict=True):
        os.dup2(fd, number)
    # those of the server knew another kind of file
    sys.stdin, sys.stdout, sys.stderr = open(0), open(1, "w"), open(2, "w", buffering=1)
    try:
        code = main(words)
    except SystemExit as end:  # of --help
        code = int(end.code or 0)
    for stream in (sys.stdout, sys.stderr):
        with suppress(OSError):
            stream.flush()
    os.write(own, str(code).encode())
    return code


def _call(address: str, words: list[str]) -> int:
    """Have it done; the exit code."""
    import _socket
    from array import array

    def is_open(number: int) -> bool:
        try:
            os.fstat(number)
        except OSError:
            return False
        return True

    fds = [number for number in DESCRIPTORS if is_open(number)]
    server = _socket.socket(_socket.AF_UNIX, _socket.SOCK_SEQPACKET)
    server.connect(address)
    env = [f"{name}={value}" for name, value in os.environ.items()]
    parts = ([os.getcwd(), *map(str, fds)], words, env)
    data = "\0\0".join("\0".join(part) for part in parts).encode()
    server.sendmsg([data], [(_socket.SOL_SOCKET, _socket.SCM_RIGHTS, array("i", fds))])
    return int(server.recv(16) or 70)


if __name__ == "__main__":
    if len(sys.argv) > 2:
        sys.exit(_call(sys.argv[1], sys.argv[2:]))
    _serve(sys.argv[1])
