"""What would keep colcon or ros2 from starting a package is noted, and nothing else is.

What they really do with each of these packages was tried with colcon-ros 0.5.0.
"""

from pathlib import Path

import pytest
import yaml

from grader.run.opening import open_submission
from tests.files import lay
from tests.grader.submission.copies import NODE, below

SETUP = """
import os
from glob import glob
from setuptools import find_packages, setup
package_name = 'spiral'
setup(
    name=package_name,
    packages=[package_name],
    data_files=[
        ('share/ament_index/resource_index/packages', ['resource/' + package_name]),
        ('share/' + package_name, ['package.xml']),
    ],
    entry_points={'console_scripts': ['turtle_controller = spiral.node:main']},
)
"""
MANIFEST = """<?xml version="1.0"?>
<package format="3">
  <name>spiral</name>
  <version>0.1.0</version>
  <description>TODO</description>
  <maintainer email="a@example.org">A</maintainer>
  <license>BSD</license>
  <export><build_type>ament_python</build_type></export>
</package>
"""
PACKAGE = {
    "package.xml": MANIFEST,
    "setup.py": SETUP,
    "setup.cfg": "[develop]\nscript_dir=$base/lib/spiral\n"
    "[install]\ninstall_scripts=$base/lib/spiral\n",
    "resource/spiral": "",
    "spiral/__init__.py": "",
    "spiral/node.py": NODE,
}


def notes(path):
    with open_submission(path) as submission:
        assert submission.remarks == submission.notes
        return tuple(map(str, submission.notes))


def changed(name, old, new):
    assert old in PACKAGE[name]
    return {name: PACKAGE[name].replace(old, new)}


def test_a_file_alone_and_loose_files_are_no_package(tmp_path):
    lay(tmp_path, {"node.py": NODE, "README.md": ""})
    assert notes(tmp_path / "node.py") == notes(tmp_path)
    (note,) = notes(tmp_path)
    assert note.startswith("Nothing in node.py calls main(): the grader did")


SHORTCOMINGS = yaml.safe_load(Path(__file__).with_name("building.yaml").read_text(encoding="utf-8"))


@pytest.mark.parametrize("shortcoming", SHORTCOMINGS, ids=lambda each: each["note"])
def test_each_shortcoming_is_a_note(tmp_path, shortcoming):
    files = {
        name: change if isinstance(change, str | None) else changed(name, *change)[name]
        for name, change in shortcoming["change"].items()
    }
    lay(tmp_path, {name: text for name, text in (PACKAGE | files).items() if text is not None})
    assert notes(tmp_path)[0] == shortcoming["note"]


@pytest.mark.parametrize(
    "change",
    [
        {},
        changed("setup.py", "['resource/' + package_name]", "glob('resource/*')"),
        changed("setup.py", "[package_name]", "find_packages(exclude=['test'])"),
        {"setup.cfg": "", **changed("setup.py", "packages=", "cmdclass={'a': 1}, packages=")},
        {"setup.cfg": "", **changed("setup.py", "('share/' + package_name,", "('lib/spiral',")},
        changed("package.xml", "<name>", "<!-- a -->\n<name>"),
        changed("package.xml", "<package ", "<!DOCTYPE p [<!ENTITY a 'b'>]>\n<package "),
        {"CMakeLists.txt": "", **changed("package.xml", "ament_python", "ament_cmake")},
    ],
)
def test_what_is_no_shortcoming_is_not_told(tmp_path, change):
    assert notes(lay(tmp_path, PACKAGE | change)) == ()


def test_a_package_inside_is_named_with_its_folder(tmp_path):
    files = {name: text for name, text in PACKAGE.items() if name != "setup.cfg"}
    lay(tmp_path, {"README.md": "", **below("src/spiral", files)})
    (note,) = notes(tmp_path)
    assert "no setup.cfg in src/spiral with install_scripts" in note


def test_other_console_scripts_are_told_as_not_started(tmp_path):
    scripts = "'again = spiral.node:main', 'pen_node = spiral.pens:main', 'turtle_controller"
    change = changed("setup.py", "'turtle_controller", scripts)
    lay(tmp_path, PACKAGE | change | {"spiral/pens.py": NODE})
    assert notes(tmp_path) == ("another program was not started: pen_node",)


def test_other_programs_of_a_folder_are_told_as_not_started(tmp_path):
    lay(tmp_path, {"turtle_controller.py": NODE, "a.py": NODE, "b.py": NODE, "helper.py": ""})
    assert notes(tmp_path)[-1] == "other programs were not started: a.py, b.py"
