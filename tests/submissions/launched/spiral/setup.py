from setuptools import find_packages, setup

package_name = "spiral"

setup(
    name=package_name,
    version="0.1.0",
    packages=find_packages(exclude=["test"]),
    data_files=[
        ("share/ament_index/resource_index/packages", ["resource/" + package_name]),
        ("share/" + package_name, ["package.xml"]),
        ("share/" + package_name + "/launch", ["launch/spiral.launch.py"]),
    ],
    entry_points={
        "console_scripts": [
            "turtle_controller = spiral.drive:main",
            "pen_node = spiral.pens:main",
        ],
    },
)
