from setuptools import setup

package_name = "my_talk"

setup(
    name=package_name,
    version="0.1.0",
    packages=[package_name],
    data_files=[
        ("share/ament_index/resource_index/packages", ["resource/" + package_name]),
        ("share/" + package_name, ["package.xml"]),
        ("share/" + package_name + "/launch", ["launch/talk.launch.py"]),
    ],
    install_requires=["setuptools"],
    zip_safe=True,
    maintainer="Your Name",
    maintainer_email="you@example.org",
    description="A node that talks and a node that listens",
    license="BSD-3-Clause",
    entry_points={
        "console_scripts": [
            "talker = my_talk.talker:main",
            "listener = my_talk.listener:main",
        ],
    },
)
