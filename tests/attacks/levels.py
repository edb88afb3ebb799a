"""What a grader may find where it runs: as root or not, with user namespaces or as in a container.

A level here is a kind of machine, made out of this one just before the grader is started; which of
its own levels the grader reaches there is what the tests look at.
"""

from __future__ import annotations

import ctypes
import os
import platform
import struct
from dataclasses import dataclass
from typing import Any

from tests import refusing

#: The ordinary user of the container; has a line in its /etc/passwd.
USER = 60001
NAMES = {USER: "teacher"}

PR_CAPBSET_DROP = 24
#: What docker leaves to root in a container (its default profile).
DOCKERS_CAPABILITIES = (0, 1, 3, 4, 5, 6, 7, 8, 10, 13, 18, 27, 29, 31)
CAPABILITY_VERSION = 0x20080522
CAPSET = 126
CLONE_NEW_ANY = 0x7E020080
EPERM, ENOSYS = 1, 38

#: Calls that docker's default profile refuses to a container without CAP_SYS_ADMIN; x86_64.
REFUSED_BY_DOCKER = (
    *(155, 165, 166, 272, 308),  # pivot_root, mount, umount2, unshare, setns
    *(428, 429, 430, 431, 432, 433, 442),  # open_tree ... fspick, mount_setattr
    *(248, 249, 250, 298, 321, 323),  # add_key ... keyctl, perf_event_open, bpf, userfaultfd
    *(425, 426, 427),  # io_uring
    *(163, 167, 168, 169, 175, 176, 246, 304, 313, 320),  # acct, swap, reboot, modules, handles
)
CLONE, CLONE3 = 56, 435
LANDLOCK = (444, 445, 446)
#: Looks at the first argument of clone: these flags are refused.
NO_NAMESPACES = (
    (refusing.JUMP_EQ, 0, 3, CLONE),
    (refusing.LOAD, 0, 0, 16),
    (refusing.JUMP_SET, 0, 1, CLONE_NEW_ANY),
    (refusing.RETURN, 0, 0, refusing.ERRNO | EPERM),
)


@dataclass(frozen=True)
class Level:
    """A kind of machine.

    Attributes:
        grader: what the grader calls the level that it reaches there.
        is_root: whether it is started as root.
        refused: system calls that are refused as docker's default profile does; empty: none.
        lacking: system calls that the kernel does not have.
    """

    grader: str
    is_root: bool
    refused: tuple[int, ...] = ()
    lacking: tuple[int, ...] = ()

    @property
    def uid(self) -> int:
        """Who starts the grader."""
        return 0 if self.is_root else USER

    @property
    def is_confined(self) -> bool:
        """Whether a filter stands before the grader."""
        return bool(self.refused)


UNCONFINED = Level("", is_root=False)
LEVELS = {
    "namespaces-root": Level("namespaces", is_root=True),
    "namespaces-user": Level("namespaces", is_root=False),
    "landlock-root": Level("landlock", True, REFUSED_BY_DOCKER),
    "landlock-user": Level("landlock", False, REFUSED_BY_DOCKER),
    "limits-user": Level("limits", False, REFUSED_BY_DOCKER, LANDLOCK),
}


def can_filter() -> bool:
    """Whether the numbers of the system calls above are this machine's."""
    return platform.machine() == "x86_64"


def become(level: Level) -> None:
    """Turn the calling process into one that starts the grader at a level; cannot be undone.

    Raises:
        OSError: it has no right to, or the system lacks something.
    """
    if level.is_confined:
        errors = dict.fromkeys(level.refused, EPERM) | dict.fromkeys(level.lacking, ENOSYS)
        refusing.answer(errors | {CLONE3: ENOSYS}, *NO_NAMESPACES)
    if level.is_confined and level.is_root:
        for capability in range(64):
            if capability not in DOCKERS_CAPABILITIES:
                _libc().prctl(PR_CAPBSET_DROP, capability, 0, 0, 0)
        _keep_capabilities(DOCKERS_CAPABILITIES)
    if not level.is_root:
        if os.getuid() == 0:
            os.setgroups([])
            os.setresgid(level.uid, level.uid, level.uid)
            os.setresuid(level.uid, level.uid, level.uid)
        _keep_capabilities(())


def _libc() -> Any:
    return ctypes.CDLL(None, use_errno=True)


def _keep_capabilities(kept: tuple[int, ...]) -> None:
    low = sum(1 << number for number in kept if number < 32)
    high = sum(1 << (number - 32) for number in kept if number >= 32)
    header = ctypes.create_string_buffer(struct.pack("Ii", CAPABILITY_VERSION, 0))
    data = ctypes.create_string_buffer(struct.pack("6I", low, low, 0, high, high, 0))
    if _libc().syscall(CAPSET, header, data):
        raise OSError(ctypes.get_errno(), "capset")
