from setuptools import setup

package_name = "my_walker"

setup(
    name=package_name,
    version="0.1.0",
    packages=[package_name],
    data_files=[
        ("share/ament_index/resource_index/packages", ["resource/" + package_name]),
        ("share/" + package_name, ["package.xml"]),
        # TODO 4: the launch file and the URDF belong into the package's share folder, too
    ],
    install_requires=["setuptools"],
    zip_safe=True,
    maintainer="Your Name",
    maintainer_email="you@example.org",
    description="A walking robot, and a node that moves it",
    license="Apache-2.0",
    entry_points={
        "console_scripts": ["state_publisher = my_walker.state_publisher:main"],
    },
)
