"""Work that many tests look at, done once: by whoever asks first, in whichever process.

What was made lies in pytest's cache and serves until what it is made by changes: a recording until
what runs does, whatever judges it; anything else until the tree or what is installed does. So a
submission is run once for all workers of a `make test`, and for the tests that `make test-all`
adds; `pytest --cache-clear` and `make clean` forget it all.
"""

import fcntl
import hashlib
import os
import shutil
import sys
import time
from collections.abc import Callable
from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PLACE = ROOT / ".pytest_cache" / "d" / "once"  # where pytest has its plugins keep theirs
#: What decides how a submission is run; its own files are in the key.
RUNS = (
    *(f"grader/{room}" for room in ("recording", "ros")),
    *(f"grader/{room}" for room in ("run", "scenes", "submission")),
    *("grader_robots/inspection", "grader_robots/scene"),
    *("grader/system", "grader_diagnosis/lint", "interfaces", "ros_doubles", "tf2", "turtlesim_py"),
)
#: What decides how it is judged, as well.
TREE = (
    *("grader", "grader_class", "grader_diagnosis", "grader_robots", "interfaces"),
    *("ros_doubles", "tests/hand_ins.py"),
    *("tests/submissions", "tf2", "turtlesim_challenge", "turtlesim_py"),
)
OLD_S = 24 * 3600.0  # of another tree: not under the feet of a suite that still runs


def folder(make: Callable[[Path], object], *key: object, made_by: tuple[str, ...] = TREE) -> Path:
    """The folder that `make` fills; made only if nobody has yet.

    It is everybody's: read it, or copy it. What `make` raises goes to this one who asked; the next
    one who asks tries again.

    Args:
        make: is given an empty folder.
        key: whatever the content depends on, beside the tree; its `repr` says all of it.
        made_by: the files and folders of the tree that it depends on.
    """
    path = PLACE / _state(made_by) / hashlib.sha256(repr(key).encode()).hexdigest()[:16]
    with path.with_suffix(".lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not path.exists():
            part = path.with_suffix(".part")
            shutil.rmtree(part, ignore_errors=True)
            part.mkdir()
            make(part)
            part.rename(path)
    return path


def digest(*paths: Path) -> str:
    """Return a hash of all files at and below these paths: their names and contents."""
    summed = hashlib.sha256()
    for top in paths:
        for path in [top] if top.is_file() else sorted(top.rglob("*")):
            if "__pycache__" not in path.parts and path.is_file() and not path.is_symlink():
                summed.update(f"{path.relative_to(top)}\0".encode())
                summed.update(hashlib.sha256(path.read_bytes()).digest())
    return summed.hexdigest()[:16]


@cache
def _state(made_by: tuple[str, ...]) -> str:
    """The tree, and what it runs with."""
    installed = sorted(each.name for way in sys.path for each in Path(way).glob("*.dist-info"))
    words = f"{sys.version} {sys.prefix} {os.environ.get('ROS_DISTRO')} {installed}"
    state = hashlib.sha256(f"{digest(*map(ROOT.joinpath, made_by))} {words}".encode())
    ours = PLACE / state.hexdigest()[:32]
    ours.mkdir(parents=True, exist_ok=True)
    os.utime(ours)
    for other in PLACE.iterdir():
        if time.time() - other.stat().st_mtime > OLD_S:
            shutil.rmtree(other, ignore_errors=True)
    return ours.name
