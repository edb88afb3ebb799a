"""What a submission's process may do no more: nothing that only root, or another user, may.

In the process itself, and for good: what it starts has no more either.
"""

from __future__ import annotations

import errno
import os

from grader import linux

#: More than there are.
CAPABILITIES = range(64)
#: Root is nobody special, no capability survives or is raised; all of it locked.
SECURE = 0xEF


def become(uid: int) -> None:
    """Go on as a user and a group of their own, without other groups.

    Raises:
        OSError: the system does not allow it.
    """
    os.setgroups([])
    os.setresgid(uid, uid, uid)
    os.setresuid(uid, uid, uid)


def leave_user_namespace(uid: int, proc: int) -> None:
    """Go on in a user namespace of our own, and as this user in it.

    What was made in the one before, mounts and networks, is then none of our business.

    Args:
        proc: our folder of /proc, opened where it can be written to.

    Raises:
        OSError: the system does not allow it.
    """
    before, group = os.getuid(), os.getgid()
    linux.unshare(linux.CLONE_NEWUSER)
    for name, text in (
        ("setgroups", "deny"),
        ("uid_map", f"{uid} {before} 1"),
        ("gid_map", f"{uid} {group} 1"),
    ):
        file = os.open(name, os.O_WRONLY, dir_fd=proc)
        os.write(file, text.encode())
        os.close(file)


def forgo_more() -> None:
    """Give up what programs that are started could get; before the user is changed.

    Where it is refused (a container's root without CAP_SETPCAP), `no_new_privs` says the same.
    """
    for number in CAPABILITIES:
        linux.control(linux.PR_CAPBSET_DROP, number)
    linux.control(linux.PR_CAP_AMBIENT, linux.PR_CAP_AMBIENT_CLEAR_ALL)
    linux.control(linux.PR_SET_SECUREBITS, SECURE)


def drop() -> None:
    """Give up all capabilities, and that anything could bring new ones.

    Raises:
        OSError: the system does not allow it.
    """
    linux.set_capabilities(0)
    forbid_new()


def forbid_new() -> None:
    """No program that is started has more privileges than who starts it.

    Raises:
        OSError: the system does not know this.
    """
    if not linux.control(linux.PR_SET_NO_NEW_PRIVS, 1):
        raise OSError(errno.EINVAL, os.strerror(errno.EINVAL), "no_new_privs")
