"""Work that many tests look at, done once: by whoever asks first, in whichever process.

What was made lies in pytest's cache and serves until the tree or what is installed changes. So a
submission is run once for all workers of a `make test`, for the tests that `make test-all` adds,
and not again while only tests are edited; `pytest --cache-clear` and `make clean` forget it all.
"""

from __future__ import annotations

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
#: What decides how a submission is run and judged.
TREE = (
    *("grader", "grader_robots", "interfaces", "robot_py", "tests/submissions", "tf2"),
    *("turtlesim_challenge", "turtlesim_py"),
)
OLD_S = 24 * 3600.0  # of another tree: not under the feet of a suite that still runs


def folder(make: Callable[[Path], object], *key: object) -> Path:
    """The folder that `make` fills; made only if nobody has yet.

    It is everybody's: read it, or copy it. What `make` raises goes to this one who asked; the next
    one who asks tries again.

    Args:
        make: is given an empty folder.
        key: whatever the content depends on, beside the tree; its `repr` says all of it.
    """
    ours = PLACE / _state()
    ours.mkdir(parents=True, exist_ok=True)
    path = ours / hashlib.sha256(repr(key).encode()).hexdigest()[:16]
    with path.with_suffix(".lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not path.exists():
            part = path.with_suffix(".part")
            shutil.rmtree(part, ignore_errors=True)
            part.mkdir()
            make(part)
            part.rename(path)
    return path


@cache
def _state() -> str:
    """The tree, and what it runs with."""
    installed = sorted(each.name for way in sys.path for each in Path(way).glob("*.dist-info"))
    tree = _digest()
    for other in PLACE.glob("*"):
        if not other.name.startswith(tree) and time.time() - other.stat().st_mtime > OLD_S:
            shutil.rmtree(other, ignore_errors=True)
    words = f"{sys.version} {sys.prefix} {os.environ.get('ROS_DISTRO')} {installed}"
    beside = hashlib.sha256(words.encode()).hexdigest()[:16]
    return f"{tree}-{beside}"


def _digest() -> str:
    summed = hashlib.sha256()
    for top in TREE:
        for place, folders, names in os.walk(ROOT / top):
            folders[:] = sorted(name for name in folders if name != "__pycache__")
            for name in sorted(names):
                path = Path(place, name)
                summed.update(f"{path.relative_to(ROOT)}\0".encode())
                if path.is_file() and not path.is_symlink():
                    summed.update(hashlib.sha256(path.read_bytes()).digest())
    return summed.hexdigest()[:16]
