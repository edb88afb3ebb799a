"""Prints everything to install into .venv before the project itself, one requirement a line."""

import os
import tomllib
from pathlib import Path

pyproject = tomllib.loads((Path(__file__).parents[1] / "pyproject.toml").read_text("utf-8"))
ours = pyproject["tool"]["turtlesim-py"]
requirements = [
    *pyproject["build-system"]["requires"],
    *ours["dependencies"],
    *pyproject["project"]["optional-dependencies"]["test"],
]
if not os.environ.get("ROS_DISTRO"):  # the same rule as in setup.py
    requirements += [*ours["ros"], *ours["ros-build"]]
print("\n".join(requirements))
