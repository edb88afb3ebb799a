"""The folder of a user's servers: their socket, and the token that opens it.

It lies in the folder of this user's runs and locks. Nobody else may list it, write into it or go
through it, which is looked at by each call, and so is who answers at the socket. A submission that
is confined by Landlock alone could connect to a socket; it cannot read the token.
"""

from __future__ import annotations

import os
import socket
import stat
import struct
from collections.abc import Iterator
from contextlib import contextmanager, suppress

from grader import scratch
from grader.errors import UsageError
from grader.message import msg

FOLDER, SOCKET, TOKEN = "servers", "socket", "token"
#: An environment variable, and its values with which no call looks for servers.
SETTING, OFF = "GRADER_SERVERS", ("off", "0", "no", "false")


class Occupied(UsageError):
    """What has the name of the folder, or listens in it, is not this user's alone."""


def is_off() -> bool:
    """Whether no call is to look for servers."""
    return os.environ.get(SETTING, "").lower() in OFF


@contextmanager
def opened() -> Iterator[int]:
    """Open the folder: yield a descriptor, so that nobody puts another in its place meanwhile.

    Raises:
        FileNotFoundError: there is none.
        Occupied: it is not this user's alone, or no folder.
    """
    path = scratch.home() / FOLDER
    try:
        folder = os.open(path, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW)
    except FileNotFoundError:
        raise
    except OSError as error:
        why = msg("cannot use {path}: {why}", path=str(path), why=error.strerror or str(error))
        raise Occupied(why) from None
    try:
        found = os.fstat(folder)
        if found.st_uid != os.geteuid() or stat.S_IMODE(found.st_mode) & 0o077:
            raise Occupied(msg("{path} is not this user's alone (chmod 700)", path=str(path)))
        yield folder
    finally:
        os.close(folder)


@contextmanager
def listening() -> Iterator[tuple[socket.socket, str]]:
    """Listen in the folder, which is made; yield the socket, and the token of all requests.

    Raises:
        GraderFailure: there is no place that is this user's alone.
        UsageError: others listen there.
    """
    import secrets  # here: no call needs it

    with suppress(FileExistsError):
        (scratch.home() / FOLDER).mkdir(mode=0o700)
    lock = scratch.acquire_lock(FOLDER)
    if lock is None:
        raise UsageError(msg("there are servers already: grader servers status"))
    with lock, opened() as folder, socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET) as made:
        _clear(folder)
        token = secrets.token_hex()
        file = os.open(TOKEN, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600, dir_fd=folder)
        os.write(file, token.encode())
        os.close(file)
        before = os.umask(0o177)
        made.bind(f"/proc/self/fd/{folder}/{SOCKET}")
        os.umask(before)
        made.listen(16)
        made.setblocking(False)
        try:
            yield made, token
        finally:
            _clear(folder)
            with suppress(OSError):
                (scratch.home() / FOLDER).rmdir()


def _clear(folder: int) -> None:
    for name in (SOCKET, TOKEN):
        with suppress(FileNotFoundError):
            os.unlink(name, dir_fd=folder)


def who_is_there() -> tuple[int, ...]:
    """Return what lies in the folder: the same numbers as long as it is the same servers'."""
    with suppress(OSError, UsageError), opened() as folder:
        return tuple(os.stat(name, dir_fd=folder).st_ino for name in (SOCKET, TOKEN))
    return ()


def connected(folder: int) -> socket.socket:
    """Connect to who listens in the folder.

    Raises:
        OSError: nobody does.
        Occupied: another user does.
    """
    made = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    try:
        made.connect(f"/proc/self/fd/{folder}/{SOCKET}")  # whatever the length of its path
        if (user := user_of(made)) != os.geteuid():
            raise Occupied(msg("user {user} listens in their place", user=user))
    except BaseException:
        made.close()
        raise
    return made


def user_of(peer: socket.socket) -> int:
    """Return the user who is at the other end of a Unix socket."""
    found = peer.getsockopt(socket.SOL_SOCKET, socket.SO_PEERCRED, struct.calcsize("3i"))
    return int(struct.unpack("3i", found)[1])


def read_token(folder: int) -> str:
    """Return the token.

    Raises:
        OSError: there is none, or it is no ordinary file.
    """
    file = os.open(TOKEN, os.O_RDONLY | os.O_NOFOLLOW, dir_fd=folder)
    try:
        return os.read(file, 1024).decode("ascii", "replace")
    finally:
        os.close(file)
