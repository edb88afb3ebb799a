"""What would keep colcon or ros2 from starting a package is noted, and nothing else is.

What they really do with each of these packages was tried with colcon-ros 0.5.0.
"""

from pathlib import Path

import pytest

from grader.run.opening import open_submission
from grader.submission.start import EntryPoint
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


def notes(path: Path) -> tuple[str, ...]:
    with open_submission(path) as submission:
        assert submission.remarks == submission.notes
        return tuple(map(str, submission.notes))


def changed(name: str, old: str, new: str) -> dict[str, str | None]:
    assert old in PACKAGE[name]
    return {name: PACKAGE[name].replace(old, new)}


def test_a_file_alone_and_loose_files_are_no_package(tmp_path):
    lay(tmp_path, {"node.py": NODE, "README.md": ""})
    assert notes(tmp_path / "node.py") == notes(tmp_path)
    (note,) = notes(tmp_path)
    assert note.startswith("Nothing in node.py calls main(): the grader did")


NOT_BUILT, NOT_FOUND = "colcon would not build this: ", "ros2 run would not find this: "
NOT_STARTED, NO_PACKAGE = (
    "ros2 run would not start this: ",
    ", so that colcon takes it for no ROS package",
)
NOT_PARSED = f"{NOT_FOUND}package.xml does not parse"
LICENSE, BUILD_TYPE = "<license>BSD</license>", "<build_type>ament_python</build_type>"
MANIFEST_HAS = {
    # what stands there instead -> the note
    ("</license>", "</licence>"): f"{NOT_PARSED}: <license> of line 7 is not closed{NO_PACKAGE}",
    ("A</maintainer>", "A<maintainer>"): (
        f"{NOT_PARSED}: <maintainer> of line 6 is not closed{NO_PACKAGE}"
    ),
    (LICENSE, "<license>B&D</license>"): (
        f"{NOT_PARSED}, line 7: not well-formed (invalid token){NO_PACKAGE}"
    ),
    (LICENSE, ""): f"{NOT_FOUND}package.xml has no <license>{NO_PACKAGE}",
    ("0.1.0", "1.0"): (
        f"{NOT_FOUND}package.xml has the version 1.0; expected three numbers, as 0.1.0{NO_PACKAGE}"
    ),
    (BUILD_TYPE, ""): (
        f"{NOT_BUILT}package.xml names no build type; expected {BUILD_TYPE} in <export>"
    ),
    ("ament_python", "ament_cmake"): (
        f"{NOT_BUILT}package.xml names the build type ament_cmake; expected {BUILD_TYPE} in "
        "<export>"
    ),
    ("<name>spiral", "<name>circle"): (
        f"{NOT_FOUND}package.xml calls the package circle, and setup.cfg and setup.py call it "
        "spiral: expected <name>spiral</name>"
    ),
}
LISTS, LIB = "packages=[package_name]", "install_scripts=$base/lib/spiral"
USES_ANOTHER = {"spiral/utils/__init__.py": "", "spiral/utils/walls.py": ""}
USES_ANOTHER["spiral/node.py"] = f"from spiral.utils import walls\n{NODE}"


@pytest.mark.parametrize(
    ("change", "note"),
    [
        *((changed("package.xml", *words), note) for words, note in MANIFEST_HAS.items()),
        ({"package.xml": None}, f"{NOT_BUILT}no package.xml beside setup.py"),
        (
            {"package.xml": None, **changed("setup.py", "['package.xml']", "[]")},
            f"{NOT_FOUND}no package.xml beside setup.py",
        ),
        (
            changed("setup.cfg", LIB, "install_scripts=$base/lib/s"),
            "ros2 run spiral would find nothing: setup.cfg installs programs in $base/lib/s, "
            f"and package.xml calls the package spiral: expected {LIB}",
        ),
        (
            USES_ANOTHER,
            f"{NOT_STARTED}setup.py lists the packages spiral, and so does not install "
            "spiral.utils",
        ),
        (
            {"resource/spiral": None},
            f"{NOT_BUILT}setup.py installs resource/spiral, and there is no such file",
        ),
        ({"setup.cfg": None}, f"{NOT_FOUND}no setup.cfg with {LIB} below [install]"),
        (
            changed("setup.cfg", "install_scripts", "script_dir"),
            f"{NOT_FOUND}setup.cfg has no {LIB} below [install]",
        ),
        (
            changed("setup.py", LISTS, "packages=['spirale']"),
            f"{NOT_BUILT}setup.py lists the package spirale, and there is no such folder",
        ),
        (
            changed("setup.py", LISTS, "packages=[]"),
            f"{NOT_STARTED}setup.py lists no packages, and so does not install spiral",
        ),
        (
            {"spiral/__init__.py": None, **changed("setup.py", LISTS, "packages=find_packages()")},
            f"{NOT_STARTED}setup.py lists no packages, and so does not install spiral: there is no "
            "spiral/__init__.py",
        ),
        (
            changed("setup.py", "'console_scripts'", "'console_script'"),
            "setup.py names no console script, so that `ros2 run` finds nothing to start. Expected "
            "in its entry_points: 'console_scripts' instead of 'console_script'",
        ),
        ({"setup.py": None, "setup.cfg": None}, f"{NOT_BUILT}no setup.py"),
    ],
)
def test_each_shortcoming_is_a_note(tmp_path, change, note):
    files = PACKAGE | change
    lay(tmp_path, {name: text for name, text in files.items() if text is not None})
    assert notes(tmp_path)[0] == note


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


def test_a_set_up_that_cannot_be_evaluated_is_a_note_with_its_line(tmp_path):
    change = changed("setup.py", "packages=[package_name]", "packages=more()")
    with open_submission(lay(tmp_path, PACKAGE | change)) as submission:
        assert submission.start == EntryPoint("spiral.node", "main")
        assert tuple(map(str, submission.notes)) == (
            "colcon would not build this: setup.py ends with NameError: name 'more' is not "
            "defined (setup.py, line 8)",
        )


def test_a_package_inside_is_named_with_its_folder(tmp_path):
    files = {name: text for name, text in PACKAGE.items() if name != "setup.cfg"}
    lay(tmp_path, {"README.md": "", **below("src/spiral", files)})
    (note,) = notes(tmp_path)
    assert "no setup.cfg in src/spiral with install_scripts" in note


def test_other_console_scripts_are_told_as_not_started(tmp_path):
    scripts = "'again = spiral.node:main', 'pen_node = spiral.pens:main', 'turtle_controller"
    change = changed("setup.py", "'turtle_controller", scripts)
    lay(tmp_path, PACKAGE | change | {"spiral/pens.py": NODE})
    assert notes(tmp_path) == ("another console script was not started: pen_node",)


def test_other_programs_of_a_folder_are_told_as_not_started(tmp_path):
    lay(tmp_path, {"turtle_controller.py": NODE, "a.py": NODE, "b.py": NODE, "helper.py": ""})
    assert notes(tmp_path)[-1] == "other programs were not started: a.py, b.py"
