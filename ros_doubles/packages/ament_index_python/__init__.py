"""A double of ROS's `ament_index_python`: packages below AMENT_PREFIX_PATH.

What is asked for is appended to the file that the variable GRADER_ASKED names, a line each:
`+ NAME` where it is there, `- NAME` where it is not. A package that is not there is said to be
beside those of ROS, at the end of the path: so the rest can be looked at as well.
"""

from __future__ import annotations

import os
from contextlib import suppress
from pathlib import Path

from launch._core import module, unknown

_MARKS = "share/ament_index/resource_index/packages"


class PackageNotFoundError(KeyError):
    def __str__(self) -> str:
        return str(self.args[0])


def get_search_paths() -> list[str]:
    paths = os.environ.get("AMENT_PREFIX_PATH", "")
    if not paths:
        raise OSError("Environment variable 'AMENT_PREFIX_PATH' is not set or empty")
    return [each for each in paths.split(os.pathsep) if each]


def _tell(sign: str, name: str) -> None:
    with open(os.environ["GRADER_ASKED"], "a", encoding="utf-8", errors="replace") as file:
        file.write(f"{sign} {' '.join(name.split())[:200]}\n")


def get_package_prefix(package_name: str) -> str:
    if not package_name:
        raise ValueError("package name must be a non-empty string")
    for prefix in get_search_paths():
        if Path(prefix, _MARKS, package_name).is_file():
            _tell("+", package_name)
            with suppress(OSError):  # there may be a file of that name
                Path(prefix, "share", package_name).mkdir(exist_ok=True)
            return prefix
    _tell("-", package_name)
    return get_search_paths()[-1]


def get_package_share_directory(package_name: str, print_warning: bool = True) -> str:
    return os.path.join(get_package_prefix(package_name), "share", package_name)


def get_package_share_path(package_name: str, print_warning: bool = True) -> Path:
    return Path(get_package_share_directory(package_name))


def get_packages_with_prefixes() -> dict[str, str]:
    found: dict[str, str] = {}
    for prefix in reversed(get_search_paths()):
        folder = Path(prefix, _MARKS)
        if folder.is_dir():
            found.update((each.name, prefix) for each in folder.iterdir())
    return found


packages = module(
    "ament_index_python.packages",
    PackageNotFoundError,
    get_package_prefix,
    get_package_share_directory,
    get_package_share_path,
    get_packages_with_prefixes,
    get_search_paths,
)
__getattr__ = unknown("ament_index_python")
