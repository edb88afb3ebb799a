"""Starts a program on a system that refuses something, as containers and older kernels do.

    python refusing.py WHAT[,WHAT...] COMMAND...

WHAT is `namespaces` (as Docker's filter of system calls has it), `landlock`, or a call's name in
`CALLS`. Who is asked for it says no, to all that the program starts: nothing has to pretend.
"""

import ctypes
import errno
import os
import struct
import sys

#: Call -> its number on x86_64 and on aarch64, and what it answers.
CALLS = {
    "unshare": (272, 97, errno.EPERM),
    "setns": (308, 268, errno.EPERM),
    "mount": (165, 40, errno.EPERM),
    "mount at present": (165, 40, errno.ENOMEM),
    "mount_setattr": (442, 442, errno.ENOSYS),
    "landlock_create_ruleset": (444, 444, errno.ENOSYS),
}
KINDS = {"namespaces": ("unshare", "setns", "mount"), "landlock": ("landlock_create_ruleset",)}
LOAD, JUMP_EQ, JUMP_SET, RETURN, ALLOW, ERRNO = 0x20, 0x15, 0x45, 0x06, 0x7FFF0000, 0x00050000
PR_SET_NO_NEW_PRIVS, PR_SET_SECCOMP, SECCOMP_MODE_FILTER = 38, 22, 2


def answer(errors: dict[int, int], *more: tuple[int, int, int, int]) -> None:
    """Let this process, and all that it starts, have these errors for system calls.

    Args:
        errors: a call's number -> the error.
        more: instructions of classic BPF after those.
    """
    lines = [(LOAD, 0, 0, 0)]
    for number, error in errors.items():
        lines += [(JUMP_EQ, 0, 1, number), (RETURN, 0, 0, ERRNO | error)]
    lines += [*more, (RETURN, 0, 0, ALLOW)]
    code = b"".join(struct.pack("=HBBI", *line) for line in lines)
    memory = ctypes.create_string_buffer(code, len(code))
    program = struct.pack("@HP", len(code) // 8, ctypes.addressof(memory))
    libc = ctypes.CDLL(None, use_errno=True)
    if libc.prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, program) != 0:
        if libc.prctl(PR_SET_NO_NEW_PRIVS, *map(ctypes.c_ulong, (1, 0, 0, 0))) != 0:
            raise OSError(ctypes.get_errno(), "no_new_privs")
        if libc.prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, program) != 0:
            raise OSError(ctypes.get_errno(), "no filter")


def refuse(*kinds: str) -> None:
    """Let this process, and all that it starts, be refused these."""
    place = ("x86_64", "aarch64").index(os.uname().machine)
    names = [name for kind in kinds for name in KINDS.get(kind, (kind,))]
    answer({CALLS[name][place]: CALLS[name][2] for name in names})


if __name__ == "__main__":
    refuse(*sys.argv[1].split(","))
    os.execvp(sys.argv[2], sys.argv[2:])
