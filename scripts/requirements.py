"""Print everything to install into .venv beside the project itself, one requirement a line.

    requirements.py           for building and running it
    requirements.py test      ... and also for `make test` and `make lint`
    requirements.py docs      ... and also for `make docs`
    requirements.py bench     ... and also for `make bench`
    requirements.py release   for scripts/release.sh alone

BOUNDS=lowest asks for our dependencies at their lower bounds.
"""

import os
import sys
import tomllib
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
# They need newer packages than our lower bounds; nothing that `make test-lowest` runs uses them.
NOT_AT_LOWEST = ("check-jsonschema", "import-linter")


def read(path: Path) -> Any:
    return tomllib.loads(path.read_text(encoding="utf-8"))


def lowest(requirement: str) -> str:
    """Return the requirement at its lower bound: name==1.2 for name>=1.2,<2."""
    return requirement.partition(",")[0].replace(">=", "==")


def ros(release: str) -> list[str]:
    """Return what running and building with a ROS release from PyPI takes."""
    found = {path.parent.name: path for path in ROOT.glob("interfaces/*/pyproject.toml")}
    if release not in found:
        sys.exit(f"ROS={release}: interfaces/ has {' and '.join(sorted(found))}")
    its = read(found[release])
    return [*its["project"]["dependencies"], *its["tool"]["turtlesim-py"]["build"]]


def main() -> list[str]:
    ours = read(ROOT / "pyproject.toml")
    groups = ours["dependency-groups"]
    if "release" in sys.argv:
        return list(groups["release"])
    build, dependencies = ours["build-system"]["requires"], ours["project"]["dependencies"]
    lists = {"test": [*ours["project"]["optional-dependencies"]["robots"], *groups["test"]]}
    lists |= {name: groups[name] for name in ("docs", "bench")}
    tools = [each for word in sys.argv[1:] for each in lists[word]]
    # where ROS is sourced, it is all there
    is_sourced = bool(os.environ.get("ROS_DISTRO"))
    of_ros = [] if is_sourced else ros(os.environ.get("ROS") or "jazzy")
    if os.environ.get("BOUNDS") == "lowest":
        # our own build needs a newer setuptools than packages are read with
        dependencies = [each for each in dependencies if not each.startswith("setuptools")]
        build, dependencies, of_ros = ([*map(lowest, n)] for n in (build, dependencies, of_ros))
        tools = [name for name in tools if not name.startswith(NOT_AT_LOWEST)]
    return ["pip", *build, *dependencies, *tools, *of_ros]  # uv brings no pip


print("\n".join(main()))
