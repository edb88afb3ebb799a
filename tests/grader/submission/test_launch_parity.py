"""What a launch file starts, when and with which arguments is what ROS's own launch has started.

The files are of the kinds that public courses have; launched.json is what launch 3.4.3 and
launch_ros 0.26.6 made of them, packages laid out as `colcon build` would: the name that `ros2
launch` prints, the moment [s], and the arguments. `worker` and scripts ended at once, all others
waited.
"""

import json
from functools import cache
from pathlib import Path

import pytest

from grader.run import inspecting
from grader.submission.request import LaunchAsked
from tests.grader.submission.test_launching import opened
from tests.hand_ins import SUBMISSIONS
from tests.inspecting import inspected

FOLDER = SUBMISSIONS / "like_ros2_launch"
STARTS = json.loads(Path(__file__).with_name("launched.json").read_text())
#: What the grader does not start, and says so.
LEFT_OUT = ("sleep", "rqt_graph", "static_transform_publisher", "turtlesim_node", "Spawn")
#: The programs of `composed.launch.py` that it does not start either; a prefix is no name.
OF_COMPOSED = ("component_container", "talker")


@cache
def all_of_it(*folders):
    order = {"set_ups": folders, "program": "turtle_controller", "inspectors": None}
    return inspected(FOLDER, **order)


@pytest.fixture(autouse=True)
def inspection(monkeypatch):
    """All launch files are evaluated once, and not again for each of them."""
    monkeypatch.setattr(inspecting, "inspect", lambda _, folders, *__: (all_of_it(*folders), ()))


def in_real_time(programs):
    """Each program with its moment: `worker` and scripts end at once, all others never."""
    at = []
    for program in programs:
        began = 0.0 if program.after < 0 else at[program.after]
        at.append(None if began is None else began + program.delay_s)
    return ((moment, p) for moment, p in zip(at, programs, strict=True) if moment is not None)


def comparable(words):
    """Arguments without the order of parameters that are given side by side."""
    found = []
    for option, word in zip(["", *words], words, strict=False):
        if option == "-p":
            found[-1] = [*found[-1], word] if isinstance(found[-1], list) else found[-1]
        elif word == "--ros-args" and word in found:
            continue  # that is said already
        elif word != "-p":
            found.append(Path(word).name if word.startswith("/") and "." in word else word)
        elif not (found and isinstance(found[-1], list)):
            found.append([])
    return [sorted(each, key=lambda p: p.split(":=")[0]) if isinstance(each, list) else each
            for each in found]  # fmt: skip


#: What is said of what a file leaves out.
OTHERS = "{} starts programs of other packages, and these were not: "
SAID = {
    "mimic": [
        "turtlesim_node of {} was started without info, __ns:=/turtlesim1",
        f"{OTHERS}turtlesim turtlesim_node, rqt_graph rqt_graph",
    ],
    "events": ["of {} was not followed: EmitEvent, a function for an event"],
    "composed": [
        f"{OTHERS}rclcpp_components component_container, LifecycleNode demo talker",
        "of {} was not followed: prefix of worker",
    ],
}


@pytest.mark.parametrize("file", STARTS)
def test_what_is_started_is_what_ros2_launch_starts_and_the_rest_is_said(file):
    submission = opened(FOLDER, launch=LaunchAsked(file))
    skipped = LEFT_OUT + (OF_COMPOSED if "composed" in file else ())
    real = [each for each in STARTS[file] if not each[0].startswith(skipped)]
    ours = sorted(in_real_time(submission.programs), key=lambda each: each[0])
    assert [p.name for _, p in ours] == [name.replace("nice", "worker") for name, *_ in real]
    for (at_s, program), (name, real_s, words) in zip(ours, real, strict=True):
        words = words[1:] if name.startswith(("python3", "nice")) else words
        words = words[3:] if name.startswith("ros2") else words
        assert comparable(submission.words(program.arguments)) == comparable(words), name
        # on a machine with something else to do
        assert at_s == pytest.approx(real_s - STARTS[file][0][1], abs=0.2), name
    notes = "\n".join(map(str, submission.notes))
    for said in SAID.get(Path(file).name.partition(".")[0], ()):
        assert said.format(f"launch/{Path(file).name}") in notes
