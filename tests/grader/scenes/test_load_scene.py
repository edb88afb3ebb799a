"""A scene is found by its name, and can be judged without ROS."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

import grader.scenes
from grader.scenes import NAMES, load_scene

ROOT = Path(__file__).parents[3]


@pytest.mark.parametrize("name", NAMES)
def test_a_scene_is_called_as_it_is_asked_for(name):
    assert load_scene(name).name == name


def test_there_is_a_name_for_every_folder_with_a_scene():
    folder = Path(grader.scenes.__path__[0])
    assert sorted(path.parent.name for path in folder.glob("*/scene.py")) == sorted(NAMES)


@pytest.mark.parametrize("name", ["moon", "", "turtlesim.scene", "../turtlesim", "scene"])
def test_a_name_that_no_scene_has_is_told_which_there_are(name):
    with pytest.raises(KeyError) as error:
        load_scene(name)
    known = "turtlesim, robot, package"
    assert error.value.args[0] == f"there is no scene {name!r}; there are: {known}"


@pytest.mark.parametrize("name", NAMES)
def test_judging_a_scene_s_recordings_needs_no_ros(name):
    code = f"""
import sys
sys.modules["rclpy"] = None
from grader.scenes import load_scene
scene = load_scene({name!r})
print(scene.message_definitions(), scene.starts(2, 1, 0.5, 1.0), scene.plane, scene.introduction)
"""
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=False, cwd=ROOT
    )
    assert done.returncode == 0, done.stderr
