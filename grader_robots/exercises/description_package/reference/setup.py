"""Installs the walker: its description, meshes, launch files and RViz's settings."""

from glob import glob

from setuptools import find_packages, setup

package_name = "walker_description"

setup(
    name=package_name,
    version="0.1.0",
    packages=find_packages(),
    data_files=[
        ("share/ament_index/resource_index/packages", ["resource/" + package_name]),
        ("share/" + package_name, ["package.xml"]),
        ("share/" + package_name + "/launch", glob("launch/*.py")),
        ("share/" + package_name + "/urdf", glob("urdf/*")),
        ("share/" + package_name + "/meshes", glob("meshes/*")),
        ("share/" + package_name + "/rviz", glob("rviz/*")),
    ],
    install_requires=["setuptools"],
    zip_safe=True,
    maintainer="Student",
    maintainer_email="student@example.org",
    description="A walker with a camera, for RViz and for Gazebo",
    license="BSD-3-Clause",
    entry_points={"console_scripts": []},
)
