"""What of the packages that are not ROS's rosdep brings, and a Python that has only those."""

import ast
import re
import sys
import tomllib
import warnings
from collections.abc import Iterable
from importlib.metadata import PackageNotFoundError, packages_distributions, requires
from pathlib import Path

from catkin_pkg.package import parse_package

from .conftest import ROOT

#: pip's name of each package -> rosdep's, which all are in rosdistro's rosdep/, for Ubuntu 24.04.
KEYS = {
    "backports-zstd": "libzstd-dev",  # for Python's zstd the C library
    "jinja2": "python3-jinja2",
    "jsonschema": "python3-jsonschema",
    "numpy": "python3-numpy",
    "pillow": "python3-pil",
    "psutil": "python3-psutil",
    "pyyaml": "python3-yaml",
    "rich": "python3-rich",
    "setuptools": "python3-setuptools",
    "websockets": "python3-websockets",
    "xacro": "xacro",
}

#: Folders of files that students write.
STUDENTS = {"starter", "reference", "right"}
#: Hides packages from every Python that finds it on its path.
SITECUSTOMIZE = """
import sys

HIDDEN = {hidden}

class Hidden:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in HIDDEN:
            raise ModuleNotFoundError(f"No module named {{name!r}}", name=name)

sys.meta_path.insert(0, Hidden())
"""


def dependencies(extra: str = "") -> dict[str, str]:
    """What pip is to install, or what an extra adds, or the tests need besides, by name."""
    pyproject = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    extras = {
        "": pyproject["project"]["dependencies"],
        **pyproject["project"]["optional-dependencies"],
        **pyproject["dependency-groups"],
    }
    return {_name(line): line for line in extras[extra]}


def depends(manifest: str, release: str) -> set[str]:
    """What a package.xml wants at run time in a ROS 2 release."""
    package = parse_package(str(ROOT / manifest))
    with warnings.catch_warnings(action="ignore"):  # of pyparsing's, about catkin_pkg
        package.evaluate_conditions({"ROS_DISTRO": release})
    return {depend.name for depend in package.exec_depends if depend.evaluated_condition}


def keys(manifest: str) -> set[str]:
    """The Python packages that a package.xml wants from rosdep."""
    wanted = depends(manifest, "jazzy")
    return {key for key in wanted if key.startswith("python3-") or key in KEYS.values()}


def hide_all_but(folder: Path, names: Iterable[str]) -> Path:
    """A folder for PYTHONPATH that hides every installed package but these and ROS's own.

    Args:
        names: as pip calls them; what they need themselves stays as well.
    """
    installed = packages_distributions()
    ros = {name for owners in installed.values() for name in owners if name.startswith("ros-")}
    kept = {"turtlesim-py", "turtlesim-py-jazzy", "turtlesim-py-kilted"}
    wanted = [*names, *ros]
    while wanted:
        name = _name(wanted.pop())
        if name not in kept:
            kept.add(name)
            wanted += [line for line in _requires(name) if "extra ==" not in line]
    hidden = {module for module, owners in installed.items() if kept.isdisjoint(map(_name, owners))}
    folder.mkdir()
    (folder / "sitecustomize.py").write_text(SITECUSTOMIZE.format(hidden=sorted(hidden)))
    return folder


def imported(package: str) -> set[str]:
    """The packages of ROS that the modules of one of our packages import."""
    names: set[str] = set()
    for path in (ROOT / package).rglob("*.py"):
        # students' files
        if STUDENTS.isdisjoint(path.relative_to(ROOT / package).parts):
            for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
                if isinstance(node, ast.Import):
                    names |= {each.name.partition(".")[0] for each in node.names}
                elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
                    names.add(node.module.partition(".")[0])
    owners = packages_distributions()
    pip = {name for name in names if not all(o.startswith("ros-") for o in owners.get(name, []))}
    return names - pip - sys.stdlib_module_names - {"compression"}


def _requires(name: str) -> list[str]:
    try:
        return requires(name) or []
    except PackageNotFoundError:  # another Python or system needs it
        return []


def _name(requirement: str) -> str:
    match = re.match(r"[\w.-]+", requirement)
    assert match, requirement
    return re.sub(r"[-_.]+", "-", match[0]).lower()
