"""`grader` in a fork of a process that has imported it: for tests of what calls it, many times.

The fork has the caller's arguments, environment, folder and descriptors, so that a script cannot
tell it from a process of its own; only the half second of a start is missing.

As a program this serves at the address of a socket; `tests/warm_call.py` is the caller.
"""

from __future__ import annotations

import fcntl
import importlib
import os
import pkgutil
import signal
import socket
import subprocess
import sys
import traceback
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path

from tests.warm_call import DESCRIPTORS, LOST, MOST_BYTES

ROOT = Path(__file__).resolve().parents[1]


@contextmanager
def serving(folder: Path, env: Mapping[str, str]) -> Iterator[str]:
    """Gives a line of shell that does as `exec python -m grader "$@"` would.

    Args:
        folder: an empty one of the caller's own.
        env: what the caller of the line is to have; what an import makes of it is made of this.
    """
    address = str(folder / "warm")
    process = subprocess.Popen(
        [sys.executable, "-P", "-m", "tests.warm", address],
        env={**env, "PYTHONPATH": str(ROOT)},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
    )
    try:
        assert process.stdout is not None
        assert process.stdout.readline()
        caller = Path(__file__).with_name("warm_call.py")
        yield f'exec {sys.executable} -I -S {caller} {address} "$@"'
    finally:
        process.terminate()
        process.communicate()


def _serve(address: str) -> None:
    for of in ("grader.cli.report", "grader.reports"):
        module = importlib.import_module(of)
        for found in pkgutil.walk_packages(getattr(module, "__path__", ()), f"{of}."):
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
                _answer(caller)
            caller.close()


def _answer(caller: socket.socket) -> None:
    """Be the process of a caller, which is told the exit code."""
    from grader.cli import main

    code = LOST
    try:
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
        sys.stdout = open(1, "w")  # noqa: SIM115  as long as the process lasts
        sys.stderr = open(2, "w", buffering=1)  # noqa: SIM115
        try:
            code = main(words)
        except SystemExit as end:  # of --help
            code = int(end.code or 0)
        for stream in (sys.stdout, sys.stderr):
            with suppress(OSError):
                stream.flush()
        os.write(own, str(code).encode())
    except BaseException:
        traceback.print_exc()
    finally:
        os._exit(code)


if __name__ == "__main__":
    _serve(sys.argv[1])
