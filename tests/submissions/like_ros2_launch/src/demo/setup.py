from glob import glob

from setuptools import find_packages, setup

setup(
    name="demo",
    version="0.1.0",
    packages=find_packages(),
    data_files=[
        ("share/ament_index/resource_index/packages", ["resource/demo"]),
        ("share/demo", ["package.xml"]),
        ("share/demo/launch", glob("launch/*")),
        ("share/demo/config", glob("config/*")),
        ("share/demo/scripts", glob("scripts/*")),
    ],
    entry_points={
        "console_scripts": [
            "talker = demo.nodes:main",
            "listener = demo.nodes:main",
            "worker = demo.nodes:work",
        ]
    },
)
