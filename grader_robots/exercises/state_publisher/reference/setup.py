from glob import glob

from setuptools import setup

package_name = "walker"

setup(
    name=package_name,
    version="0.1.0",
    packages=[package_name],
    data_files=[
        ("share/ament_index/resource_index/packages", ["resource/" + package_name]),
        ("share/" + package_name, ["package.xml"]),
        ("share/" + package_name + "/launch", glob("launch/*.launch.py")),
        ("share/" + package_name + "/urdf", glob("urdf/*.urdf")),
    ],
    install_requires=["setuptools"],
    zip_safe=True,
    maintainer="course",
    maintainer_email="course@example.com",
    description="A walking robot: its description, and a node that moves it",
    license="Apache-2.0",
    entry_points={
        "console_scripts": ["state_publisher = walker.state_publisher:main"],
    },
)
