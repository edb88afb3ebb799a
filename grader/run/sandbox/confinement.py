"""Confines the calling process, as the grader has ordered; there is no way back.

An order is a dictionary that fits JSON, made by `grader.run.processes.levels`:

| key | what |
|---|---|
| `level` | `namespaces`, `landlock` or `limits`; see there |
| `rlimits` | limits of resources; see `grader.run.limits` |
| `uid` | the user that it is to be |
| `user` | `separate`: as root can; `mapped`: in a user namespace of its own; `same`: not at all |
| `steps` | for `.filesystem`; none where another program of the submission has made it |
| `meeting` | a socket: whose one end gives that view, and whose other end gets it; or -1 |
| `others` | so many programs may get it |
| `read`, `write`, `listed` | for `.landlock` |
| `is_apart` | whether the run has a network of its own |

It is not bubblewrap: that program stands between, so that another process's processor time would
count, and it executes a program where a fork server's child just goes on.
"""

from __future__ import annotations

import os
import signal
from collections.abc import Mapping
from typing import Any

from grader.run.sandbox import filesystem, landlock, seccomp
from grader.system import linux

NAMESPACES, LANDLOCK, LIMITS = "namespaces", "landlock", "limits"
SEPARATE, MAPPED, SAME = "separate", "mapped", "same"
#: More than the kernel has.
CAPABILITIES = range(64)
#: Root has no special rights, no capability survives or is raised; all of it locked.
SECURE = 0xEF


def confine(order: Mapping[str, Any]) -> None:
    """Carry out an order completely."""
    if order["level"] == LIMITS:
        _limit(order)
        linux.forbid_new_privileges()
        return
    uid, user = order["uid"], order["user"]
    # the new user is mapped there, and the new root's /proc cannot be written to
    proc = os.open("/proc/self", os.O_PATH | os.O_CLOEXEC)
    if order["level"] == NAMESPACES:
        if order["steps"]:
            filesystem.enter(order["steps"])
            if order["meeting"] >= 0:
                filesystem.share(order["meeting"], order["others"])
        else:
            filesystem.join(order["meeting"])
    else:
        landlock.restrict(order["read"], order["write"], order["listed"])
    if user == MAPPED:
        linux.unshare_user(uid, proc)
    os.close(proc)
    _forgo_capabilities()
    if user == SEPARATE:
        for output in (1, 2):  # so that /dev/stdout and /dev/stderr can be opened
            os.fchown(output, uid, uid)
        os.setgroups([])
        os.setresgid(uid, uid, uid)
        os.setresuid(uid, uid, uid)
    linux.set_capabilities(0)
    linux.forbid_new_privileges()
    # a change of the user makes the process unreadable to itself, and resets the parent's signal
    linux.control(linux.PR_SET_DUMPABLE, 1)
    linux.signal_at_parents_death(signal.SIGKILL)
    _limit(order)
    seccomp.install(is_apart=order["is_apart"] and order["level"] == NAMESPACES)


def _limit(order: Mapping[str, Any]) -> None:
    for limit in order["rlimits"]:
        linux.lower_limit(*limit)


def _forgo_capabilities() -> None:
    """Give up the capabilities that started programs could get; before the user is changed.

    Where it is refused (a container's root without CAP_SETPCAP), `no_new_privs` does the same.
    """
    for number in CAPABILITIES:
        linux.control(linux.PR_CAPBSET_DROP, number)
    linux.control(linux.PR_CAP_AMBIENT, linux.PR_CAP_AMBIENT_CLEAR_ALL)
    linux.control(linux.PR_SET_SECUREBITS, SECURE)
