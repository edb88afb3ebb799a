from setuptools import setup

package_name = "my_robot_description"

setup(
    name=package_name,
    version="0.1.0",
    packages=[package_name],
    data_files=[
        ("share/ament_index/resource_index/packages", ["resource/" + package_name]),
        ("share/" + package_name, ["package.xml"]),
        # TODO: the description, the meshes, the launch files, RViz's file
    ],
    install_requires=["setuptools"],
    zip_safe=True,
    maintainer="Your Name",
    maintainer_email="you@example.org",
    description="My robot, described",
    license="BSD-3-Clause",
)
