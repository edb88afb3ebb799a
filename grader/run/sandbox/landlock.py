"""Which files a submission's process may use, and whom it may signal: Landlock.

It needs no rights and no namespaces, so that most containers have it. The ABI, a number, is what a
kernel can restrict: files from 1 on (Linux 5.13), moving files between folders from 2, truncating
from 3, TCP from 4 (6.7), devices' ioctl from 5, signals and abstract Unix sockets from 6 (6.12).
None restricts UDP, Unix sockets by path, chmod, chown, setxattr, or stat of what may not be opened.
"""

from __future__ import annotations

import errno
import os
import stat
import struct
from collections.abc import Sequence
from typing import Final

from grader.system import linux

#: Their numbers are the same on all machines.
CREATE_RULESET, ADD_RULE, RESTRICT_SELF = 444, 445, 446
CREATE_RULESET_VERSION = 1 << 0
RULE_PATH_BENEATH = 1

EXECUTE, WRITE_FILE, READ_FILE, READ_DIR = 1 << 0, 1 << 1, 1 << 2, 1 << 3
#: REMOVE_DIR, REMOVE_FILE; MAKE_DIR, MAKE_REG, MAKE_SOCK, MAKE_FIFO, MAKE_SYM.
REMOVE, MAKE = 1 << 4 | 1 << 5, 1 << 7 | 1 << 8 | 1 << 9 | 1 << 10 | 1 << 12
#: MAKE_CHAR, MAKE_BLOCK: given to nobody.
MAKE_DEVICE = 1 << 6 | 1 << 11
REFER, TRUNCATE, IOCTL_DEV = 1 << 13, 1 << 14, 1 << 15
#: ABI -> the rights over files that a kernel knows from it on.
FILES: Final = {
    1: EXECUTE | WRITE_FILE | READ_FILE | READ_DIR | REMOVE | MAKE | MAKE_DEVICE,
    2: REFER,
    3: TRUNCATE,
    5: IOCTL_DEV,
}
#: TCP's bind and connect, from 4 on; abstract Unix sockets and signals, from 6 on.
NET, NET_SINCE = 0b11, 4
SCOPES, SCOPES_SINCE = 0b11, 6
#: Refusals do not fill the system's log; from 7 on.
LOG_SAME_EXEC_OFF, LOG_SINCE = 1, 7

READ = EXECUTE | READ_FILE | READ_DIR
WRITE = READ | WRITE_FILE | REMOVE | MAKE | REFER | TRUNCATE
#: Of what is no folder.
OF_A_FILE = EXECUTE | WRITE_FILE | READ_FILE | TRUNCATE | IOCTL_DEV


def abi() -> int:
    """Return the ABI of this kernel's Landlock; 0: none."""
    if os.uname().sysname != "Linux":
        return 0
    try:
        return _call(CREATE_RULESET, None, 0, CREATE_RULESET_VERSION)
    except OSError:
        return 0


def restrict(read: Sequence[str], write: Sequence[str], listed: Sequence[str] = ()) -> None:
    """Restrict the calling thread, and all that it starts, to these files.

    It can then neither bind nor connect TCP, nor reach processes outside by signals or abstract
    Unix sockets, as far as `abi` goes. Open descriptors stay as they are. Sets `no_new_privs`.

    Args:
        read: files and folders, with all below, that may be read and executed. Those that are not
            there are left out.
        write: in these anything may be done, but for making devices.
        listed: folders in which, and below which, names may be listed and nothing opened for it.
    """
    version = abi()
    if version < 1:
        raise OSError(errno.ENOSYS, "no Landlock here")
    files = sum(rights for since, rights in FILES.items() if version >= since)
    net = NET if version >= NET_SINCE else 0
    scopes = SCOPES if version >= SCOPES_SINCE else 0
    attributes = struct.pack("=QQQ", files, net, scopes)
    # A kernel refuses what is longer than it knows only if that is not 0.
    ruleset = _call(CREATE_RULESET, attributes, len(attributes), 0)
    try:
        for paths, rights in ((read, READ), (write, WRITE), (listed, READ_DIR)):
            for path in paths:
                _allow(ruleset, path, rights & files)
        linux.forbid_new_privileges()
        _call(RESTRICT_SELF, ruleset, LOG_SAME_EXEC_OFF if version >= LOG_SINCE else 0)
    finally:
        os.close(ruleset)


def _allow(ruleset: int, path: str, rights: int) -> None:
    try:
        place = os.open(path, os.O_PATH | os.O_CLOEXEC)
    except FileNotFoundError:
        return
    try:
        if not stat.S_ISDIR(os.fstat(place).st_mode):
            rights &= OF_A_FILE
        # struct landlock_path_beneath_attr is packed
        _call(ADD_RULE, ruleset, RULE_PATH_BENEATH, struct.pack("=Qi", rights, place), 0)
    finally:
        os.close(place)


def _call(number: int, *words: int | bytes | None) -> int:
    return linux.system_call(number, *words, of="Landlock")
