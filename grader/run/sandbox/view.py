"""Plans, in the grader, what a submission's process sees of the file system.

It sees Python, the installed packages but for ours, the ROS libraries, the system's programs and
libraries, a little of /etc and /dev, the few modules of ours that work in that process, and the
submission. What is always the same is found once. `.landlock` gets it as lists of what may be read
(`readable`). `.filesystem` builds a root of it (`steps`), for which these rules hold:

- Each place is a mount of one kind: `bind` shows what is there outside, `hide` an empty folder,
  `copy` the submission's copy, `scratch` an empty folder to write into, `proc` the processes.
- A mount is needed where what it lies in does not show the same already: no `bind` in a `bind`, and
  a `hide` only in a `bind`, since nothing else shows anything.
- Folders that lead to a mount are made, but for those in a `bind`, which are there. Those in a
  `scratch` the submission could change: the first of them is a `hide`, which it cannot.
- Links on the way to a place are made as they are outside.
"""

# ruff: noqa: PTH100, PTH110, PTH112, PTH114, PTH115, PTH118
# Paths are text here, as the mounts and rules that come of them are; pathlib would tidy them up.

from __future__ import annotations

import os
import site
import sys
import sysconfig
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path, PurePosixPath

from grader.run.limits import MIB, ROOM, SCRATCH
from grader.system import versions as system

#: Where our packages are, if they are not installed.
ROOT = Path(__file__).resolve().parents[3]
#: Packages of ours, which contain the checks, or a solution.
HIDDEN = (
    *("grader", "grader_class", "grader_diagnosis", "grader_robots", "turtlesim_challenge"),
    *("ros_doubles", "turtlesim_py"),
)
#: ... but for what works in the submission's own process.
HOST = (
    *("grader/__init__.py", "grader/system/__init__.py", "grader/system/versions.py"),
    "grader/run/__init__.py",
    *("grader/run/student", "grader/run/clock", "grader/run/observe", "grader/run/lockstep"),
    "grader/run/processes/__init__.py",
    "grader/system/linux.py",
    # what inspects a package
    *("grader/system/limited.py", "grader/submission", "ros_doubles"),
    *("grader_robots/__init__.py", "grader_robots/inspection", "grader_robots/robot_py"),
    "grader/system/strict_json.py",
    # ... and the sentences of its remarks
    *("grader/text/__init__.py", "grader/text/__init__.pyi", "grader/text/message.py"),
    # interfaces of its own
    *("grader/ros", "grader/errors.py", "grader/text/strings.py"),
)
SYSTEM = ("/usr", "/bin", "/sbin", "/lib", "/lib32", "/lib64", "/libx32")
#: Of /etc, where libraries are, and the time zone; users and hosts have files of ours.
SETTINGS = (
    *("/etc/ld.so.cache", "/etc/ld.so.conf", "/etc/ld.so.conf.d", "/etc/alternatives"),
    *("/etc/localtime", "/etc/timezone", "/etc/os-release", "/etc/mime.types", "/etc/fonts"),
)
#: Of an installed Python, which may lie in a folder with much else.
PREFIX = ("bin", "lib", "lib64", "libexec", "share", "include", "etc", "opt", "pyvenv.cfg")
DEVICES = ("null", "zero", "full", "random", "urandom")
LINKS = {
    "/dev/fd": "/proc/self/fd",
    "/dev/stdin": "/proc/self/fd/0",
    "/dev/stdout": "/proc/self/fd/1",
    "/dev/stderr": "/proc/self/fd/2",
}
#: Of /proc, where it shows all processes.
SHOWN_OF_PROC = ("self", "cpuinfo", "meminfo", "stat", "uptime", "version", "loadavg", "sys")
FILES = {
    "/etc/nsswitch.conf": "passwd: files\ngroup: files\nhosts: files\n",
    "/etc/hosts": "127.0.0.1 localhost\n::1 localhost\n",
}
NAME = "student"

Step = list[str]


@dataclass(frozen=True)
class SystemView:
    """What every submission sees: paths without symbolic links, and the links that lead to them.

    Attributes:
        shown: folders and files, with all that is in them.
        hidden: hidden folders below those ...
        host: ... but for these.
        links: link -> where it points.
    """

    shown: frozenset[str]
    hidden: frozenset[str]
    host: frozenset[str]
    links: dict[str, str]


@cache
def system_view() -> SystemView:
    """Find what is the same for every submission."""
    found: set[str] = set()
    links: dict[str, str] = {}
    for path in _shown():
        found.update(real for real in _follow(path, links) if not _is_wide(real))
    root = os.path.realpath(ROOT)
    host = {path for name in HOST if os.path.exists(path := f"{root}/{name}")}
    hidden = {
        os.path.realpath(f"{folder}/{name}")
        for folder in (*import_path(), str(ROOT))
        for name in HIDDEN
        if os.path.isdir(f"{folder}/{name}")
    }
    outer = {path for path in found if not any(_is_below(path, each) for each in found)}
    return SystemView(frozenset(outer), frozenset(hidden), frozenset(host), links)


def readable(submission: Path, more: Sequence[Path] = ()) -> tuple[list[str], list[str]]:
    """Return, for `.landlock`, what may be read and run, and folders whose names may be listed.

    The latter are only partly readable, and Python searches them for modules.

    Args:
        more: folders that this process sees beside it.
    """
    found, listed = map(list, _always_readable())
    found += [real for path in more for real in _follow(str(path), {})]
    for real in _follow(str(submission), {}):
        found += _without(real, system_view().hidden - {real}, listed)
    return found, listed


@cache
def _always_readable() -> tuple[tuple[str, ...], tuple[str, ...]]:
    always = system_view()
    listed = [os.path.realpath(ROOT)]  # for those of our modules that work there
    found = (
        *(each for path in sorted(always.shown) for each in _without(path, always.hidden, listed)),
        *sorted(always.host),
        *(f"/dev/{name}" for name in DEVICES),
        *(f"/proc/{name}" for name in SHOWN_OF_PROC),
        *("/etc/passwd", "/etc/group", "/etc/nsswitch.conf", "/etc/hosts"),
    )
    return found, tuple(listed)


def _without(path: str, hidden: Collection[str], listed: list[str]) -> Iterator[str]:
    """Yield a folder; or if it has hidden contents, the other ones, and add it to `listed`."""
    below = [each for each in hidden if _is_below(each, path)]
    if not below and path not in hidden:
        yield path
    elif path not in hidden:
        listed.append(path)
        with os.scandir(path) as entries:
            for entry in sorted(entries, key=lambda entry: entry.name):
                if entry.is_symlink():
                    continue  # its target is shown or hidden by itself
                yield from _without(entry.path, hidden, listed)


def steps(submission: Path, uid: int, owner: int = -1, more: Sequence[Path] = ()) -> list[Step]:
    """Return, for `.filesystem`, the root of a process that runs this submission as this user.

    Args:
        submission: all of it; a writable copy comes into the new root.
        owner: the user that is to own the copy; -1: the process's user.
        more: folders that this process sees beside it.
    """
    always = system_view()
    links = always.links | LINKS
    copied = set(_follow(str(submission), links))
    wanted = dict.fromkeys(always.hidden, "hide")
    seen = (real for path in more for real in _follow(str(path), links))
    wanted |= dict.fromkeys((*always.shown, *always.host, *seen), "bind")
    wanted |= dict.fromkeys(copied, "copy")
    wanted |= {f"/dev/{name}": "bind" for name in DEVICES if os.path.exists(f"/dev/{name}")}
    wanted |= {"/proc": "proc", **dict.fromkeys(SCRATCH, "scratch")}
    mounts: dict[str, str] = {}
    for path in sorted(wanted, key=_parts):
        kind, outer = wanted[path], _kind_around(path, mounts)
        if kind != outer and (kind != "hide" or outer == "bind"):
            if outer == "scratch" and (top := _top_in_scratch(path)) != path:
                mounts[top] = "hide"
            mounts[path] = kind
    files = FILES | {
        "/etc/passwd": f"root:x:0:0::/:/bin/false\n{NAME}:x:{uid}:{uid}::/tmp:/bin/sh\n",
        "/etc/group": f"root:x:0:\n{NAME}:x:{uid}:\n",
    }
    room = {path: f"{_room(path)} {owner}" for path in copied}
    room |= {path: _size(*size) for path, size in SCRATCH.items()}
    return list(_in_order(mounts, links, files, room))


def _in_order(
    mounts: dict[str, str], links: dict[str, str], files: dict[str, str], room: dict[str, str]
) -> Iterator[Step]:
    """Yield every step after those that make its parents."""
    made = {*mounts, *links}
    for path in sorted({*mounts, *links, *files}, key=_parts):
        is_shown = _kind_around(path, mounts) == "bind"
        if not is_shown:
            for folder in map(str, reversed(PurePosixPath(path).parents[:-1])):
                if folder not in made and _kind_around(folder, mounts) != "bind":
                    made.add(folder)
                    yield ["folder", folder]
        if path in mounts:
            if not is_shown:
                is_file = mounts[path] == "bind" and not os.path.isdir(path)
                yield ["file", path, ""] if is_file else ["folder", path]
            yield [mounts[path], path, room.get(path, "")]
        elif not is_shown:
            yield ["link", path, links[path]] if path in links else ["file", path, files[path]]


def _kind_around(path: str, mounts: dict[str, str]) -> str:
    """Return the kind of the mount that a path lies in; '' for the root."""
    while path := path.rpartition("/")[0]:
        if path in mounts:
            return mounts[path]
    return ""


def _top_in_scratch(path: str) -> str:
    """Return the first folder in a `scratch` on the way to a path."""
    scratch = next(folder for folder in SCRATCH if _is_below(path, folder))
    return f"{scratch}/{_parts(path.removeprefix(scratch))[0]}"


def _room(folder: str) -> str:
    """Return the room for a copy of a folder, with what may be added to it."""
    size = entries = 0
    for at, folders, files in os.walk(folder):
        entries += len(folders) + len(files)
        # a file takes whole pages
        size += sum(os.lstat(f"{at}/{name}").st_size + 4096 for name in files)
    return _size(ROOM[0] + size // MIB + 1, ROOM[1] + entries)


def _size(mib: int, files: int) -> str:
    return f"size={mib}m,nr_inodes={files}"


def import_path() -> list[str]:
    """Return the folders where a submission's Python finds modules, but for the submission's."""
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
    """Yield the folders that the .pth files of a folder add to the import path."""
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
    """Yield where a path leads, if there is something; add the links on the way to `links`."""
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
