"""Installs the packages, and what `ros2 run` and the ament index need to find them.

What is required stands in pyproject.toml, and is the same everywhere. ROS from PyPI, and what has
to be compiled for it, are distributions of their own: interfaces/jazzy and interfaces/kilted.
"""

import sys
from pathlib import Path

from setuptools import find_packages, setup

# resolved: `colcon build --symlink-install` runs a link to this file, in a folder that lacks most
# of the tree
sys.path.insert(0, str(Path(__file__).resolve().parent))
from interfaces.ament import PACKAGES, PROJECT, ROOT, AmentDistribution, BuildPy, programs

# Each is a ROS package of its own, with the files that it launches. turtlesim_py stands last:
# of several destinations of one file, colcon sees the last.
ROS_PACKAGES: dict[str, list[str]] = {
    "grader": [],
    "grader_robots": [],
    "turtlesim_challenge": ["launch/turtlesim_challenge.launch.py"],
    "turtlesim_py": ["launch/multisim.launch.py"],
}


#: Packages without a program of their own.
PACKAGES_BESIDE = ("grader_class", "grader_diagnosis", "ros_doubles")


def data_files() -> list[tuple[str, list[str]]]:
    """What `ros2 run`, `ros2 launch` and the ament index look for, below the prefix."""
    files = []
    for package, launch_files in ROS_PACKAGES.items():
        manifest = "package.xml" if package == PROJECT["name"] else f"{package}/package.xml"
        files += [
            (PACKAGES, [f"ament_marker/{package}"]),
            (f"share/{package}", [manifest]),
            (f"share/{package}/launch", launch_files),
            (f"lib/{package}", programs(package)),
        ]
    return [(folder, names) for folder, names in files if names]


# What setuptools reads in pyproject.toml, for where that is not: the folder of --symlink-install.
READ_ELSEWHERE = {
    "name": PROJECT["name"],
    "version": PROJECT["version"],
    "install_requires": PROJECT["dependencies"],
    "extras_require": PROJECT["optional-dependencies"],
    "entry_points": {
        group: [f"{name} = {where}" for name, where in points.items()]
        for group, points in {
            "console_scripts": PROJECT["scripts"],
            **PROJECT["entry-points"],
        }.items()
    },
}


setup(
    **({} if Path("pyproject.toml").exists() else READ_ELSEWHERE),
    license="BSD-3-Clause",
    python_requires=">=3.11",
    packages=find_packages(
        str(ROOT),
        include=[
            name
            for package in (*ROS_PACKAGES, *PACKAGES_BESIDE)
            for name in (package, f"{package}.*")
        ],
    ),
    # Everything in the packages. Not by MANIFEST.in (include_package_data): setuptools then
    # warns about the starter, a package that is not to be imported
    package_data={package: ["**/*", "**/.*"] for package in (*ROS_PACKAGES, *PACKAGES_BESIDE)},
    exclude_package_data={package: ["*.py[cod]"] for package in (*ROS_PACKAGES, *PACKAGES_BESIDE)},
    include_package_data=False,
    data_files=data_files(),
    distclass=AmentDistribution,
    cmdclass={"build_py": BuildPy},
    zip_safe=False,
)
