from setuptools import find_packages, setup

package_name = "conversation"

setup(
    name=package_name,
    version="0.1.0",
    packages=find_packages(exclude=["test"]),
    data_files=[
        ("share/ament_index/resource_index/packages", ["resource/" + package_name]),
        ("share/" + package_name, ["package.xml"]),
        ("share/" + package_name + "/launch", ["launch/conversation.launch.py"]),
    ],
    entry_points={
        "console_scripts": [
            "talker = conversation.talker:main",
            "listener = conversation.listener:main",
            "asker = conversation.asker:main",
            "adder = conversation.adder:main",
            "late = conversation.late:main",
            "dies = conversation.dies:main",
        ],
    },
)
