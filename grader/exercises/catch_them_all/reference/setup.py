from setuptools import setup

package_name = "my_turtles"

setup(
    name=package_name,
    version="0.1.0",
    packages=[package_name],
    data_files=[
        ("share/ament_index/resource_index/packages", ["resource/" + package_name]),
        ("share/" + package_name, ["package.xml"]),
        ("share/" + package_name + "/launch", ["launch/catch.launch.py"]),
    ],
    install_requires=["setuptools"],
    zip_safe=True,
    maintainer="Your Name",
    maintainer_email="you@example.org",
    description="Turtles that are spawned, and a turtle that catches them",
    license="BSD-3-Clause",
    entry_points={
        "console_scripts": [
            "turtle_spawner = my_turtles.turtle_spawner:main",
            "turtle_controller = my_turtles.turtle_controller:main",
        ],
    },
)
