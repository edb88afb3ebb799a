"""Starts a program as an ordinary user, in a container's way: for tests that root runs.

    python as_user.py [--root] COMMAND...

With `--root` it remains root, and the rest is the same. Where Python or these tests lie in a folder
of root's alone, the program is shown them there and nothing else of that folder.
"""

import ctypes
import os
import stat
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]
USER = 65534
CLONE_NEWNS, MS_BIND, MS_REC, MS_PRIVATE = 0x20000, 0x1000, 0x4000, 0x40000


def call(function: str, *words: object) -> None:
    libc = ctypes.CDLL(None, use_errno=True)
    if getattr(libc, function)(*words) != 0:
        raise OSError(ctypes.get_errno(), f"{function}: {os.strerror(ctypes.get_errno())}")


def mount(source: str | Path, target: Path, kind: str, flags: int = 0, data: str = "") -> None:
    words = (
        str(source).encode(),
        bytes(target),
        kind.encode(),
        ctypes.c_ulong(flags),
        data.encode(),
    )
    call("mount", *words)


def uncover(folders: list[Path]) -> None:
    """Let others reach folders, whatever they lie in."""
    opened = {folder: os.open(folder, os.O_PATH) for folder in folders}
    closed = {folder: private[-1] for folder in folders if (private := hidden_by(folder))}
    for outermost in set(closed.values()):
        mount("tmpfs", outermost, "tmpfs", 0, "mode=755")
    for folder in sorted(closed):  # what is in another one comes after it, and is there already
        if not folder.exists():
            folder.mkdir(parents=True)
            mount(f"/proc/self/fd/{opened[folder]}", folder, "", MS_BIND | MS_REC)
    for descriptor in opened.values():
        os.close(descriptor)


def hidden_by(folder: Path) -> list[Path]:
    """The folders on the way that others cannot pass, the outermost last."""
    return [way for way in folder.parents if not way.stat().st_mode & stat.S_IXOTH]


def show_python() -> None:
    """Let other users get at this Python and at these tests, in the current process's view."""
    call("unshare", CLONE_NEWNS)
    mount("", Path("/"), "", MS_REC | MS_PRIVATE)
    needed = (ROOT, Path(sys.prefix), Path(sys.base_prefix))
    uncover([folder.resolve() for folder in dict.fromkeys(needed)])


def become_user() -> None:
    """Go on as an ordinary user in the current process."""
    os.setgroups([])
    os.setresgid(USER, USER, USER)
    os.setresuid(USER, USER, USER)
    ctypes.CDLL(None).prctl(4, 1)  # it may be looked at by its own, as after a login


if __name__ == "__main__":
    words = sys.argv[1:]
    show_python()
    if words[0] == "--root":
        del words[0]
    else:
        become_user()
    os.execvp(words[0], words)
