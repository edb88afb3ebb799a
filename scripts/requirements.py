"""Print everything to install into .venv beside the project itself, one requirement a line.

    requirements.py         for building and running it
    requirements.py test    ... and also for `make test` and `make lint`
    requirements.py docs    ... and also for `make docs`

BOUNDS=lowest asks for our dependencies at their lower bounds.
"""

import os
import sys
import tomllib
from pathlib import Path

# Needs newer packages than our lower bounds; only what `make test-lowest` leaves out uses it.
NOT_AT_LOWEST = ("check-jsonschema",)


def lowest(requirement: str) -> str:
    """Return the requirement at its lower bound: name==1.2 for name>=1.2,<2."""
    return requirement.partition(",")[0].replace(">=", "==")


pyproject = tomllib.loads((Path(__file__).parents[1] / "pyproject.toml").read_text("utf-8"))
ours = pyproject["tool"]["turtlesim-py"]
build = pyproject["build-system"]["requires"]
is_sourced = bool(os.environ.get("ROS_DISTRO"))  # the same rule as in setup.py
dependencies = [*ours["dependencies"], *([] if is_sourced else ours["robots_without_ros"])]
lists = {"test": ["robots", "test"], "docs": ["docs"]}
tools = [each for word in sys.argv[1:] for name in lists[word] for each in ours["extras"][name]]
if os.environ.get("BOUNDS") == "lowest":
    # our own build needs a newer setuptools than packages are read with
    dependencies = [each for each in dependencies if not each.startswith("setuptools")]
    build, dependencies = map(lowest, build), map(lowest, dependencies)
    tools = [name for name in tools if not name.startswith(NOT_AT_LOWEST)]
requirements = ["pip", *build, *dependencies, *tools]  # uv brings no pip
if not is_sourced:
    release = os.environ.get("ROS") or "jazzy"
    if release not in ours["ros"]:
        sys.exit(f"ROS={release}: pyproject.toml has {' and '.join(ours['ros'])}")
    requirements += [*ours["ros"][release]["run"], *ours["ros"][release]["build"]]
print("\n".join(requirements))
