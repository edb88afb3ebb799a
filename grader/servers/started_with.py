"""What servers were started with: a call that has something else is not theirs.

They have imported files that may have changed since, in an environment that may be another's. What
only calls read is not here: a submission, an exercise of one's own.
"""

from __future__ import annotations

import os
import re
import stat
import sys
import zlib
from collections.abc import Iterable, Iterator, Mapping

import grader

#: The variables that Python, its libraries and ROS read when they are loaded, or that say where
#: things are. A call brings all others with it.
READ_AT_START = re.compile(
    r"(PYTHON|LD_|DYLD_|LC_|ROS_|RMW_|RCUTILS_|AMENT_|COLCON_|CONDA_|FASTRTPS_|FASTDDS_|CYCLONEDDS_"
    r"|MALLOC_)\w*|XDG_\w+_(DIR|HOME)|PATH|TERM|HOME|USER|TMPDIR|TMP|TEMP|TZ|LANG|VIRTUAL_ENV"
)
#: A file's inode, size and time of change [ns]; of a folder: inode, and what `_of_folder` counts.
State = tuple[int, int, int]


def environment() -> dict[str, str]:
    """Return the variables that have to be the same, and are a process's own."""
    return {name: value for name, value in os.environ.items() if READ_AT_START.fullmatch(name)}


def process() -> dict[str, str]:
    """Return which Python this is, which grader, how nice, and how limited."""
    import resource  # here: Windows lacks it

    kinds = [name for name in dir(resource) if name.startswith("RLIMIT_")]
    return {
        "Python": f"{sys.executable} {sys.version}",
        "grader": str(grader.__file__),
        "niceness": str(os.getpriority(os.PRIO_PROCESS, 0)),
        **{name: str(resource.getrlimit(getattr(resource, name))) for name in kinds},
    }


def files(folders: Iterable[str]) -> dict[str, State]:
    """Return the state of all that this process or a fork server of it has loaded, or may load.

    Those are the files in `folders`, all loaded modules, and where such are installed.
    """
    loaded = {str(getattr(each, "__file__", None) or "") for each in list(sys.modules.values())}
    paths = {*sys.path, *loaded, *(path for folder in folders for path in _below(folder))}
    return {path: _state(path) for path in paths if path.startswith("/")}


def differing(before: Mapping[str, object], now: Mapping[str, object]) -> str:
    """Return the first name of which the value differs; '' for none."""
    names = sorted({*before, *now})
    return next((name for name in names if not _are_alike(before.get(name), now.get(name))), "")


def _are_alike(one: object, other: object) -> bool:
    """Whether two values are the same but for the order of a path.

    ROS's wheels put their libraries onto LD_LIBRARY_PATH in another order at each start of Python.
    """
    if isinstance(one, str) and isinstance(other, str):
        return sorted(one.split(os.pathsep)) == sorted(other.split(os.pathsep))
    return one == other


def _below(folder: str) -> Iterator[str]:
    for at, folders, names in os.walk(folder):
        folders[:] = [each for each in folders if each != "__pycache__"]
        yield at
        yield from (f"{at}/{name}" for name in names)


def _state(path: str) -> State:
    try:
        found = os.stat(path)  # noqa: PTH116  thousands of them for each call
        if stat.S_ISDIR(found.st_mode):
            return (found.st_ino, *_of_folder(path))
    except OSError:
        return (0, 0, 0)
    return (found.st_ino, found.st_size, found.st_mtime_ns)


def _of_folder(path: str) -> tuple[int, int]:
    """Return how many names in a folder Python could import, or pip has installed, and their sum.

    Its time would also tell of all else: results that are written into a folder on the path.
    """
    with os.scandir(path) as found:
        names = sorted(
            each.name
            for each in found
            if each.name.endswith((".py", ".so", ".pth", ".dist-info"))
            or os.path.lexists(f"{each.path}/__init__.py")
        )
    return len(names), zlib.crc32("\0".join(names).encode(errors="surrogateescape"))
