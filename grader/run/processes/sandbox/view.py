"""What a submission's process is to see of the file system: planned in the grader.

Python, the installed packages but for ours, the ROS libraries, the system's programs and libraries,
a little of /etc and /dev, the few modules of ours that work in that process, and the submission.
What is always the same is looked up once. `.filesystem` builds a root of it; `.landlock` gets it as
lists of what may be read.
"""

# ruff: noqa: PTH100, PTH110, PTH112, PTH114, PTH115, PTH118
# Paths are text here, as the mounts and rules that come of them are; pathlib would tidy them up.

from __future__ import annotations

import os
import site
import sys
import sysconfig
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from grader import system

#: Where our packages are, if they are not installed.
ROOT = Path(__file__).resolve().parents[4]
#: Packages of ours, which show how we judge, or a solution.
HIDDEN = ("grader", "turtlesim_challenge", "turtlesim_py")
#: ... but for what works in the submission's own process.
HOST = (
    *("grader/__init__.py", "grader/system.py", "grader/versions.py", "grader/run/__init__.py"),
    *("grader/run/student", "grader/run/lockstep"),
    *("grader/run/processes/__init__.py", "grader/run/processes/cores.py"),
    *("grader/linux.py", "grader/usage.py"),
    # of a package that is looked at
    *("grader/limited.py", "grader/scenes/__init__.py", "grader/scenes/package"),
    "grader/strict_json.py",
    # ... and what says how far it may be
    *("grader/language/__init__.py", "grader/language/phrase.py"),
)
SYSTEM = ("/usr", "/bin", "/sbin", "/lib", "/lib32", "/lib64", "/libx32")
#: Of /etc, where libraries are, and the time zone; who is here, the process is told otherwise.
SETTINGS = (
    *("/etc/ld.so.cache", "/etc/ld.so.conf", "/etc/ld.so.conf.d", "/etc/alternatives"),
    *("/etc/localtime", "/etc/timezone", "/etc/os-release", "/etc/mime.types", "/etc/fonts"),
)
#: Of what belongs to an installed Python, which may lie in a folder with much else.
PREFIX = ("bin", "lib", "lib64", "libexec", "share", "include", "etc", "opt", "pyvenv.cfg")
DEVICES = ("null", "zero", "full", "random", "urandom")
LINKS = {
    "/dev/fd": "/proc/self/fd",
    "/dev/stdin": "/proc/self/fd/0",
    "/dev/stdout": "/proc/self/fd/1",
    "/dev/stderr": "/proc/self/fd/2",
}
#: The one place that can be written to, and what shared memory is made of: so much, so many files.
SCRATCH = {"/tmp": "size=64m,nr_inodes=8192", "/dev/shm": "size=64m,nr_inodes=1024"}
#: Of /proc, what a process may read where it sees that of all.
SHOWN_OF_PROC = ("self", "cpuinfo", "meminfo", "stat", "uptime", "version", "loadavg", "sys")
FILES = {
    "/etc/nsswitch.conf": "passwd: files\ngroup: files\nhosts: files\n",
    "/etc/hosts": "127.0.0.1 localhost\n::1 localhost\n",
}
NAME = "student"

Step = list[str]


@dataclass(frozen=True)
class Places:
    """Paths without symbolic links, and the links that lead to them.

    Attributes:
        shown: folders and files with all that is in them.
        hidden: folders below those that are not to be seen ...
        host: ... but for these.
        links: link -> where it points.
    """

    shown: frozenset[str]
    hidden: frozenset[str]
    host: frozenset[str]
    links: dict[str, str]


@cache
def _always_readable() -> tuple[tuple[str, ...], tuple[str, ...]]:
    always = places()
    listed = [os.path.realpath(ROOT)]  # for those of our modules that work there
    found = (
        *(each for path in sorted(always.shown) for each in _without(path, always.hidden, listed)),
        *sorted(always.host),
        *(f"/dev/{name}" for name in DEVICES),
        *(f"/proc/{name}" for name in SHOWN_OF_PROC),
        *("/etc/passwd", "/etc/group", "/etc/nsswitch.conf", "/etc/hosts"),
    )
    return found, tuple(listed)


@cache
def places() -> Places:
    """What is the same for every submission."""
    found: set[str] = set()
    links: dict[str, str] = {}
    for path in _shown():
        found.update(real for real in _follow(path, links) if not _is_wide(real))
    host, root = set(), os.path.realpath(ROOT)
    for path in HOST:
        if os.path.exists(f"{root}/{path}"):
            host.add(f"{root}/{path}")
    hidden = {
        os.path.realpath(f"{folder}/{name}")
        for folder in (*import_path(), str(ROOT))
        for name in HIDDEN
        if os.path.isdir(f"{folder}/{name}")
    }
    outer = {path for path in found if not any(_is_below(path, each) for each in found)}
    return Places(frozenset(outer), frozenset(hidden), frozenset(host), links)


def steps(submission: Path, uid: int, owner: int = -1) -> list[Step]:
    """For `.filesystem`: the root of a process that runs this submission as this user.

    Args:
        submission: all of it, which is copied into the new root, to be written to.
        owner: whose the copy is to be; -1: the process's own user's.
    """
    always = places()
    links = dict(always.links) | LINKS
    own = set(_follow(str(submission), links))
    mounts: dict[str, str] = dict.fromkeys(SCRATCH, "scratch")
    mounts["/proc"] = "proc"
    wanted = dict.fromkeys(always.hidden, "hide")
    wanted |= dict.fromkeys((*always.shown, *always.host), "bind")
    wanted |= dict.fromkeys(own, "copy")
    wanted |= {f"/dev/{name}": "bind" for name in DEVICES if os.path.exists(f"/dev/{name}")}
    for path in sorted(wanted, key=_parts):
        kind = wanted[path]
        above = _covering(path, mounts)
        if above != kind and not (kind == "hide" and above != "bind"):
            for top in _within_scratch(path, mounts):
                mounts[top] = "hide"
            mounts[path] = kind
    files = FILES | {
        "/etc/passwd": f"root:x:0:0::/:/bin/false\n{NAME}:x:{uid}:{uid}::/tmp:/bin/sh\n",
        "/etc/group": f"root:x:0:\n{NAME}:x:{uid}:\n",
    }
    room = {path: f"{_room(path)} {owner}" for path in own} | SCRATCH
    return list(_in_order(mounts, links, files, room))


def _room(folder: str) -> str:
    """What a copy of a folder takes, and 24 MB more."""
    size = entries = 0
    for at, folders, files in os.walk(folder):
        entries += len(folders) + len(files)
        # a file takes whole pages
        size += sum(os.lstat(f"{at}/{name}").st_size + 4096 for name in files)
    return f"size={24 + size // (1 << 20) + 1}m,nr_inodes={8192 + entries}"


def readable(submission: Path) -> tuple[list[str], list[str]]:
    """For `.landlock`: what may be read, and run; and folders of which the names may be seen.

    Those hold what is read and what is not: Python looks for modules in them.
    """
    found, listed = map(list, _always_readable())
    for real in _follow(str(submission), {}):
        found += _without(real, places().hidden - {real}, listed)
    return found, listed


def import_path() -> list[str]:
    """Where a submission's Python looks for modules, but for the submission itself."""
    names = ("stdlib", "platstdlib", "purelib", "platlib")
    found = [sysconfig.get_paths()[name] for name in names]
    packages = [
        *site.getsitepackages(),
        *([site.getusersitepackages()] if site.ENABLE_USER_SITE else []),
    ]
    found += packages
    if system.is_ros_sourced():
        found += _listed("PYTHONPATH")
    for folder in filter(os.path.isdir, packages):  # of a user, and of Debian, they may be missing
        found += _added(folder)
    return [path for path in dict.fromkeys(found) if os.path.isdir(path) and not _is_wide(path)]


def _added(folder: str) -> Iterator[str]:
    """Folders that are put on the import path by files in another one."""
    # not by glob, which finds nothing where no descriptor is free
    for file in sorted(path for path in Path(folder).iterdir() if path.suffix == ".pth"):
        for line in file.read_text(encoding="utf-8", errors="replace").splitlines():
            if line.strip() and not line.startswith(("#", "import ", "import\t")):
                path = os.path.normpath(os.path.join(folder, line.strip()))
                if os.path.realpath(path) != os.path.realpath(ROOT):
                    yield path


def _shown() -> Iterator[str]:
    yield from (*SYSTEM, *SETTINGS)
    prefixes = {sys.prefix, sys.exec_prefix, sys.base_prefix, sys.base_exec_prefix}
    yield from (f"{prefix}/{name}" for prefix in sorted(prefixes) for name in PREFIX)
    yield sys.executable
    yield from import_path()
    if system.is_ros_sourced():
        for name in ("AMENT_PREFIX_PATH", "LD_LIBRARY_PATH"):
            yield from (path for path in _listed(name) if path not in prefixes)


def _listed(variable: str) -> list[str]:
    return [path for path in os.environ.get(variable, "").split(os.pathsep) if path.startswith("/")]


def _is_wide(path: str) -> bool:
    """Whether a folder holds everything, or somebody's home."""
    real, home = os.path.realpath(path), os.path.realpath(Path.home())
    return real == home or _is_below(home, real)


def _is_below(path: str, folder: str) -> bool:
    return path != folder and path.startswith(folder.rstrip("/") + "/")


def _follow(path: str, links: dict[str, str]) -> Iterator[str]:
    """Where a path leads, if there is something; the links on the way are put down."""
    parts, real, hops = _parts(os.path.abspath(path)), "", 0
    while parts:
        here = f"{real}/{parts.pop(0)}"
        if os.path.islink(here) and (hops := hops + 1) < 40:
            links[here] = os.readlink(here)
            target = os.path.normpath(os.path.join(real or "/", links[here]))
            parts, real = [*_parts(target), *parts], ""
        else:
            real = here
    if os.path.exists(real):
        yield real


def _parts(path: str) -> list[str]:
    return [part for part in path.split("/") if part]


def _covering(path: str, mounts: dict[str, str]) -> str:
    """What kind of mount a path lies in; '': the root."""
    while path := path.rpartition("/")[0]:
        if path in mounts:
            return mounts[path]
    return ""


def _within_scratch(path: str, mounts: dict[str, str]) -> Iterator[str]:
    """The first folder on the way to a path that would belong to what can be written to."""
    if _covering(path, mounts) == "scratch":
        within = next(folder for folder in SCRATCH if _is_below(path, folder))
        top = f"{within}/{_parts(path.removeprefix(within))[0]}"
        if top != path:
            yield top


def _in_order(
    mounts: dict[str, str], links: dict[str, str], files: dict[str, str], room: dict[str, str]
) -> Iterator[Step]:
    """Every step after those that make its place."""
    made: set[str] = set()
    everything = {*mounts, *links, *files}
    for path in sorted(everything, key=_parts):
        if path not in mounts and _covering(path, mounts) == "bind":
            continue  # it is there already
        if _covering(path, mounts) != "bind":
            for folder in _above(path):
                if folder not in made and folder not in mounts and folder not in links:
                    if _covering(folder, mounts) != "bind":
                        yield ["folder", folder]
                    made.add(folder)
        if path in links and path not in mounts:
            yield ["link", path, links[path]]
        elif path in files:
            yield ["file", path, files[path]]
        else:
            if _covering(path, mounts) != "bind":
                is_file = mounts[path] == "bind" and not os.path.isdir(path)
                yield ["file", path, ""] if is_file else ["folder", path]
            yield [mounts[path], path, room.get(path, "")]


def _above(path: str) -> list[str]:
    """The folders that a path lies in, the outermost first."""
    parts = _parts(path)[:-1]
    return ["/" + "/".join(parts[: n + 1]) for n in range(len(parts))]


def _without(path: str, hidden: Collection[str], listed: list[str]) -> Iterator[str]:
    """A folder, or if something in it is to be hidden, what else is in it; it is then `listed`."""
    below = [each for each in hidden if _is_below(each, path)]
    if not below and path not in hidden:
        yield path
    elif path not in hidden:
        listed.append(path)
        with os.scandir(path) as entries:
            for entry in sorted(entries, key=lambda entry: entry.name):
                if entry.is_symlink():
                    continue  # where it leads is shown or not for its own sake
                yield from _without(entry.path, hidden, listed)
