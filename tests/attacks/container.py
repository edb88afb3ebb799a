"""A container for attacks: what they do to the machine is done to a copy of it, which goes.

    python -m tests.attacks.container EMPTY-FOLDER

It has processes, network, IPC and terminals of its own, and the files of this machine below a layer
that takes all that is written (overlayfs), so that even an attack that succeeds as root harms
nothing, and all that was written can be told. The first process of it is ours, which no signal from
inside ends. It reads a job (JSON) from standard input and writes what it saw (JSON) to standard
output; see `observing`.
"""

import ctypes
import fcntl
import json
import os
import socket
import struct
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from tests import as_user
from tests.as_user import CLONE_NEWNS, MS_BIND, MS_PRIVATE, MS_REC
from tests.programs import ran

ROOT = Path(__file__).parents[2]
CLONE_NEWUTS, CLONE_NEWIPC = 0x04000000, 0x08000000
CLONE_NEWUSER, CLONE_NEWPID, CLONE_NEWNET = 0x10000000, 0x20000000, 0x40000000
MS_NOSUID, MS_NODEV = 2, 4
MNT_DETACH, PIVOT_ROOT, PR_SET_PDEATHSIG, PR_SET_DUMPABLE = 2, 155, 1, 4
SIOCSIFFLAGS, IFF_UP, IFF_RUNNING = 0x8914, 0x1, 0x40
DEVICES = ("null", "zero", "full", "random", "urandom", "tty")
#: All that attacks may write together, to files and to shared memory [bytes].
ROOM, SHARED = "1g", "512m"
#: Folders of / that are not as this machine's, and those that are empty but for what is needed.
OTHERS, EMPTY = ("proc", "sys", "dev", "tmp"), ("/tmp", "/var/tmp")
PROBE = {"probe": True}


class NoContainer(Exception):
    """This system allows none; the text says why."""


def run(job: dict[str, Any]) -> Any:
    """Do a job in a container of its own, and give what it tells.

    Raises:
        NoContainer: there can be none here.
        RuntimeError: it has died.
    """
    with tempfile.TemporaryDirectory() as folder:  # the mounts in it are not seen from here
        done = ran(
            [sys.executable, "-P", "-m", "tests.attacks.container", folder],
            input=json.dumps(job),
            cwd=ROOT,
            env={**os.environ, "PYTHONPATH": str(ROOT), "PYTHONDONTWRITEBYTECODE": "1"},
        )
    try:
        answer = json.loads(done.stdout)
    except ValueError:
        raise RuntimeError(f"no answer ({done.returncode}): {done.stderr[-4000:]}") from None
    if isinstance(answer, dict) and "refused" in answer:
        raise NoContainer(answer["refused"])
    return answer


def main() -> int:
    """Make it, and go on in it as its first process."""
    job = json.loads(sys.stdin.read())
    folder = Path(sys.argv[1])
    try:
        _leave(CLONE_NEWNS | CLONE_NEWPID | CLONE_NEWIPC | CLONE_NEWNET | CLONE_NEWUTS)
        if child := os.fork():
            return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
        _libc().prctl(PR_SET_PDEATHSIG, 9, 0, 0, 0)
        layer = _enter(folder, [ROOT, *map(Path, (sys.prefix, sys.base_prefix))])
    except OSError as error:
        print(json.dumps({"refused": str(error)}))
        return 0
    if job == PROBE:
        print(json.dumps("works"))
        return 0
    from tests.attacks import observing

    # what it says must not lie within reach: all that we hold is closed to who is not root
    _libc().prctl(PR_SET_DUMPABLE, 0, 0, 0, 0)
    said = os.dup(1)
    os.set_inheritable(said, False)
    os.dup2(2, 1)
    answer = observing.observe(job, layer)
    with os.fdopen(said, "w") as file:
        file.write(json.dumps(answer))
    return 0


def _leave(kinds: int) -> None:
    user, group = os.getuid(), os.getgid()
    if _libc().unshare(kinds | (CLONE_NEWUSER if user else 0)):
        raise OSError(ctypes.get_errno(), "unshare")
    if not user:
        return
    for name, text in (
        ("setgroups", "deny"),
        ("uid_map", f"{user} {user} 1"),
        ("gid_map", f"{group} {group} 1"),
    ):
        Path(f"/proc/self/{name}").write_text(text)


def _libc() -> Any:
    return ctypes.CDLL(None, use_errno=True)


def _raise_loopback() -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as any_socket:
        words = struct.pack("16sh14x", b"lo", IFF_UP | IFF_RUNNING)
        fcntl.ioctl(any_socket, SIOCSIFFLAGS, words)


def _enter(folder: Path, needed: Sequence[Path]) -> int:
    """Have files of our own from here on.

    Returns:
        a folder with a folder NAME/upper for each folder of /: what is written there.
    """
    as_user.mount("none", Path("/"), "", MS_REC | MS_PRIVATE)
    as_user.mount("tmpfs", folder, "tmpfs", 0, f"size={ROOM}")
    root, layers = folder / "root", folder / "layers"
    root.mkdir()
    as_user.mount("tmpfs", root, "tmpfs", MS_NODEV, "mode=755,size=16m")
    for entry in Path("/").iterdir():
        if entry.is_symlink():
            (root / entry.name).symlink_to(entry.readlink())
        elif entry.is_dir():
            (root / entry.name).mkdir()
            if entry.name not in OTHERS:
                _show(entry, root, layers, needed)
    places = {_mount_point(path) for path in needed if not _is_temporary(path)}
    (folder / "empty").mkdir()
    for place in map(Path, EMPTY):
        (root / place.relative_to("/")).mkdir(exist_ok=True)
        _overlay(folder / "empty", root / place.relative_to("/"), layers / _layer(place))
        (root / place.relative_to("/")).chmod(0o1777)
    for place in [place for place in places if len(place.parts) > 2] + list(
        filter(_is_temporary, needed)
    ):
        target = root / place.relative_to("/")
        if not (layers / _layer(place)).exists():
            target.mkdir(parents=True, exist_ok=True)
            _overlay(place, target, layers / _layer(place))
    as_user.mount("proc", root / "proc", "proc")
    as_user.mount("/sys", root / "sys", "", MS_BIND | MS_REC)
    _make_devices(root / "dev")
    layer = os.open(layers, os.O_RDONLY | os.O_DIRECTORY)
    os.chdir(root)
    if _libc().syscall(PIVOT_ROOT, b".", b".") or _libc().umount2(b".", MNT_DETACH):
        raise OSError(ctypes.get_errno(), "pivot_root")
    os.chdir("/")
    _raise_loopback()
    _open_to_all(needed)
    return layer


def _show(place: Path, root: Path, layers: Path, needed: Sequence[Path]) -> None:
    """Have a folder of / as it is; one with other mounts in it may be refused to a user."""
    try:
        _overlay(place, root / place.name, layers / place.name)
    except OSError:
        if any(path.is_relative_to(place) for path in needed if not _is_temporary(path)):
            raise


def _is_temporary(path: Path) -> bool:
    return any(path.is_relative_to(place) for place in EMPTY)


def _layer(place: Path) -> str:
    return "!".join(place.parts[1:])


def _mount_point(path: Path) -> Path:
    return next(each for each in (path, *path.parents) if each.is_mount())


def _overlay(lower: Path, target: Path, layer: Path) -> None:
    for name in ("upper", "work"):
        (layer / name).mkdir(parents=True)
    options = f"lowerdir={lower},upperdir={layer}/upper,workdir={layer}/work"
    if os.getuid():
        options += ",userxattr"
    as_user.mount("overlay", target, "overlay", 0, options)


def _make_devices(dev: Path) -> None:
    as_user.mount("tmpfs", dev, "tmpfs", MS_NOSUID, "mode=755,size=64k")
    for name in DEVICES:
        (dev / name).touch()
        as_user.mount(Path("/dev", name), dev / name, "", MS_BIND)
    for name, kind, options in (
        ("shm", "tmpfs", f"mode=1777,size={SHARED}"),
        ("pts", "devpts", "newinstance,mode=620,ptmxmode=666"),
        ("mqueue", "mqueue", ""),
    ):
        (dev / name).mkdir()
        as_user.mount(kind, dev / name, kind, MS_NOSUID, options)
    (dev / "ptmx").symlink_to("pts/ptmx")
    (dev / "fd").symlink_to("/proc/self/fd")
    for number, name in enumerate(("stdin", "stdout", "stderr")):
        (dev / name).symlink_to(f"/proc/self/fd/{number}")


def _open_to_all(needed: Sequence[Path]) -> None:
    """Whoever grades finds Python and this checkout, also where they lie in root's own folder."""
    if os.getuid() == 0:
        for place in {parent for path in needed for parent in path.resolve().parents}:
            place.chmod(place.stat().st_mode | 0o055)


if __name__ == "__main__":
    sys.exit(main())
