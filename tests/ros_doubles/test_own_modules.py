"""What stands beside the doubles hides no module of a hand-in's."""

import pytest

from tests.files import lay
from tests.inspecting import inspected

FILES = {
    "package.xml": "<package format='3'><name>demo</name><version>0.0.0</version></package>",
    "setup.py": "from setuptools import setup\nsetup(name='demo', packages=[])\n",
}
LAUNCH = """
from launch import LaunchDescription
from launch_ros.actions import Node
from {module} import NAMES


def generate_launch_description():
    return LaunchDescription([Node(package="demo", executable=name) for name in NAMES])
"""


@pytest.mark.parametrize("module", ["known", "frontend", "launch_time", "mine"])
def test_a_launch_file_imports_the_packages_own_module_whatever_its_name(module, tmp_path):
    files = {
        f"{module}.py": "NAMES = ['talker']\n",
        "launch/a.launch.py": LAUNCH.format(module=module),
    }
    root = lay(tmp_path, {f"demo/{name}": text for name, text in (FILES | files).items()})
    (launch,) = inspected(root, set_ups=["demo"], inspectors=None).trace.launches
    assert [node.executable for node in launch.nodes] == ["talker"]
