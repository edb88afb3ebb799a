"""The package that turtlesim's messages, services and action come from: it has had two names.

Up to ROS 2 Jazzy they are in `turtlesim`, from Kilted on in `turtlesim_msgs`; the definitions are
the same. Both ends of a topic must name the same, so a node serves one of the two. Nothing of ROS
is imported before `Interfaces.of`: to choose needs none.
"""

from __future__ import annotations

import os
from dataclasses import dataclass
from importlib import import_module
from importlib.util import find_spec
from typing import Any, Final, Self

OLDER: Final = "turtlesim"
NEWER: Final = "turtlesim_msgs"
NAMES: Final = (OLDER, NEWER)
KINDS: Final = ("msg", "srv", "action")
#: The first ROS 2 release of the newer name; releases are named in the order of the alphabet.
FIRST_OF_NEWER: Final = "kilted"


@dataclass(frozen=True)
class Interfaces:
    """One of the packages: its name, and its modules with the classes."""

    package: str
    msg: Any
    srv: Any
    action: Any

    @classmethod
    def of(cls, package: str) -> Self:
        """Import the modules of a package.

        Raises:
            ModuleNotFoundError: the package is not installed.
        """
        return cls(package, *(import_module(f"{package}.{kind}") for kind in KINDS))


def installed() -> tuple[str, ...]:
    """Return which of the packages can be imported here, without running any of them."""
    specs = ((name, find_spec(name)) for name in NAMES)
    # without an origin it is no more than a folder of that name
    return tuple(name for name, spec in specs if spec is not None and spec.origin)


def of_release(ros_distro: str) -> str:
    """Return the package's name in a ROS 2 release, which is named as in `ROS_DISTRO`."""
    return NEWER if ros_distro >= FIRST_OF_NEWER else OLDER


def usual() -> str:
    """Return the default package: that of the sourced ROS, else the older."""
    name = of_release(os.environ.get("ROS_DISTRO", ""))
    return name if name in installed() else OLDER
