"""A scene is found by its name, and can be judged without ROS."""

import subprocess
import sys
from pathlib import Path

import pytest

import grader.scenes
from grader.scenes.scene import load_scene
from grader.scenes.subject import load_subject
from grader.system import extensions

ROOT = Path(__file__).parents[3]
NAMES = [*extensions.points(extensions.SCENES)]


@pytest.mark.parametrize("name", NAMES)
def test_a_subject_is_called_as_it_is_asked_for(name):
    assert load_subject(name).name == name


def test_there_is_a_name_for_every_folder_with_a_scene():
    folders = {path.parent.name for path in Path(grader.scenes.__path__[0]).glob("*/scene.py")}
    modules = {point.module for name in NAMES for point in extensions.points("grader.scenes")[name]}
    assert {f"grader.scenes.{name}.scene" for name in folders} <= modules


@pytest.mark.parametrize("name", ["moon", "", "turtlesim.scene", "../turtlesim", "scene"])
def test_a_name_that_no_scene_has_is_told_which_there_are(name):
    with pytest.raises(KeyError) as error:
        load_scene(name)
    known = ", ".join(NAMES)
    assert error.value.args[0] == f"grader.scenes: there is no {name!r}; there are: {known}"


def test_what_is_examined_is_no_scene():
    with pytest.raises(KeyError, match="'package' is no scene"):
        load_scene("package")


@pytest.mark.parametrize("name", NAMES)
def test_judging_a_subject_s_recordings_needs_no_ros(name):
    code = f"""
import sys
sys.modules["rclpy"] = None
from grader.scenes.subject import load_subject
from grader.scenes.scene import Scene
subject = load_subject({name!r})
print(subject.untouched(None), subject.plane)
if isinstance(subject, Scene):
    print(subject.starts(2, 1, 0.5, 1.0), subject.introduction)
"""
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=False, cwd=ROOT
    )
    assert done.returncode == 0, done.stderr
