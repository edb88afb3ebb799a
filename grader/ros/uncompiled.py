"""Packages of interfaces that are installed as definitions only: there was no compiler.

They do in virtual time, where classes are made from them; DDS carries messages of compiled ones
alone. There are none where ROS is sourced.
"""

from __future__ import annotations

import os
import sys
from functools import cache
from importlib.machinery import PathFinder
from pathlib import Path
from typing import Final

KINDS: Final = ("msg", "srv", "action")
#: Where the ament index has all packages of interfaces, compiled or not.
_INDEX: Final = Path("share", "ament_index", "resource_index", "rosidl_interfaces")


def packages() -> list[str]:
    """Return their names."""
    return sorted(filter(is_uncompiled, _indexed()))


def is_uncompiled(package: str) -> bool:
    """Whether a package is one of them."""
    if package not in _indexed():
        return False
    found = PathFinder.find_spec(package)
    return found is None or found.origin is None  # a mere folder of that name


def texts(package: str) -> dict[str, str]:
    """Return the definitions of one, by their types: 'turtlesim/msg/Pose'; {} for any other."""
    if not is_uncompiled(package):
        return {}
    share = Path(sys.prefix, "share", package)
    files = [file for kind in KINDS for file in sorted((share / kind).glob(f"*.{kind}"))]
    return {f"{package}/{file.suffix[1:]}/{file.stem}": file.read_text("utf-8") for file in files}


@cache
def _indexed() -> frozenset[str]:
    folder = Path(sys.prefix, _INDEX)
    if "ROS_DISTRO" in os.environ or not folder.is_dir():
        return frozenset()
    return frozenset(each.name for each in folder.iterdir())
