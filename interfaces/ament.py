"""How our distributions are built: what `ros2 run` and the ament index look for, as data files.

Used by both setup.py and build.py. Python's own modules alone: `colcon build` imports this.
"""

import re
import shutil
import tomllib
from pathlib import Path
from typing import Any

from setuptools import Command, Distribution
from setuptools.command.build_py import build_py

ROOT = Path(__file__).resolve().parents[1]
PYPROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
PROJECT = PYPROJECT["project"]
PACKAGES = "share/ament_index/resource_index/packages"
# `ros2 run PACKAGE PROGRAM` starts <prefix>/lib/PACKAGE/PROGRAM. pip and colcon write the same
# program, with the right Python in its first line, to <prefix>/bin: run that one.
RUN_FROM_BIN = '#!/bin/sh\nexec "$(dirname "$0")/../../bin/$(basename "$0")" "$@"\n'
# Data files that the build writes, by the folder that `data_files` names for them: there is none of
# that name in the sources. An empty file in the ament index is how packages are found.
WRITTEN = {"run_from_bin": RUN_FROM_BIN, "ament_marker": ""}


def programs(package: str) -> list[str]:
    """Return the data files that start the programs of one of our packages."""
    return [
        f"run_from_bin/{name}"
        for name, function in PROJECT["scripts"].items()
        if re.split(r"[.:]", function)[0] == package
    ]


class BuildPy(build_py):
    """`build_py` that starts empty: pip keeps build/, and a deleted module would be installed."""

    def run(self) -> None:
        """Remove what an earlier build left, then build."""
        for package in {name.partition(".")[0] for name in self.distribution.packages or ()}:
            shutil.rmtree(Path(self.build_lib) / package, ignore_errors=True)
        super().run()


class WriteData(Command):
    """Part of the commands that install data files: writes those which are not in the sources."""

    def copy_file(self, infile: str, outfile: str, **options: Any) -> tuple[str, bool]:
        """Install a data file in the folder `outfile`; return its path there, and True."""
        folder, _, name = infile.partition("/")
        if folder not in WRITTEN:
            copied: tuple[str, bool] = super().copy_file(infile, outfile, **options)
            return copied
        path = Path(outfile, name)
        path.unlink(missing_ok=True)  # a link of `colcon build --symlink-install` would be followed
        path.write_text(WRITTEN[folder], encoding="utf-8")
        path.chmod(0o755 if folder == "run_from_bin" else 0o644)
        return str(path), True


class AmentDistribution(Distribution):
    """A distribution whose data files are partly written by the build.

    Not by `cmdclass`: colcon brings a command of its own, which may not be here.
    """

    def get_command_class(self, command: str) -> type[Command]:
        """Return the class of a command."""
        found: type[Command] = super().get_command_class(command)
        if command not in ("install_data", "symlink_data"):
            return found
        return type(found.__name__, (WriteData, found), {})
