"""Confines the process that it is called in, as a grader has ordered it; there is no way back.

An order is a dictionary of what JSON can say, so that it can be an argument of a program:

| key | what |
|---|---|
| `level` | `namespaces`, `landlock` or `limits`; see `.levels` |
| `uid` | the user that it is to be |
| `user` | `own`: as root can; `namespace`: in a user namespace of its own; `same`: not at all |
| `steps`, `folder` | for `.filesystem` |
| `read`, `write`, `listed` | for `.landlock` |
| `is_apart` | whether the run has a network of its own |

Hundred lines of our own, not bubblewrap: that is a program that stands between, so that the process
whose processor time counts would be another, and it cannot go on as a zygote's child does.
"""

from __future__ import annotations

import os
import signal
from typing import Any

from grader import linux
from grader.run.processes.sandbox import filesystem, landlock, limits, privileges, seccomp

NAMESPACES, LANDLOCK, LIMITS = "namespaces", "landlock", "limits"
OWN, NAMESPACE, SAME = "own", "namespace", "same"


def confine(order: dict[str, Any]) -> None:
    """Do what is ordered, all of it.

    Raises:
        OSError: the system refuses something; then this process must not go on.
    """
    if order["level"] == LIMITS:
        limits.apply(is_alone=False)
        privileges.forbid_new()
        return
    uid, user = order["uid"], order["user"]
    # there the new user is made known, and what is shown in the new root cannot be written to
    proc = os.open("/proc/self", os.O_PATH | os.O_CLOEXEC)
    if order["level"] == NAMESPACES:
        filesystem.enter(order["steps"], order["folder"])
    else:
        landlock.restrict(order["read"], order["write"], order["listed"])
    if user == NAMESPACE:
        privileges.leave_user_namespace(uid, proc)
    os.close(proc)
    privileges.forgo_more()
    if user == OWN:
        for output in (1, 2):  # so that /dev/stdout and /dev/stderr can be opened
            os.fchown(output, uid, uid)
        privileges.become(uid)
    privileges.drop()
    # a process that has changed its user is closed to itself as well, and has forgotten its parent
    linux.control(linux.PR_SET_DUMPABLE, 1)
    linux.signal_at_parents_death(signal.SIGKILL)
    limits.apply(is_alone=user != SAME)
    seccomp.install(is_apart=order["is_apart"] and order["level"] == NAMESPACES)
