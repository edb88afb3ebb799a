from setuptools import setup

package_name = "my_numbers"

setup(
    name=package_name,
    version="0.1.0",
    packages=[package_name],
    data_files=[
        ("share/ament_index/resource_index/packages", ["resource/" + package_name]),
        ("share/" + package_name, ["package.xml"]),
    ],
    install_requires=["setuptools"],
    zip_safe=True,
    maintainer="Your Name",
    maintainer_email="you@example.org",
    description="A node that uses interfaces of my own",
    license="BSD-3-Clause",
    entry_points={
        "console_scripts": [
            "numbers = my_numbers.numbers:main",
        ],
    },
)
