"""Hand-ins with interfaces of their own: they work as in ROS, and what is wrong is said first."""

import shutil
import subprocess
from dataclasses import replace
from pathlib import Path

import pytest

from grader import grading
from grader.exercise.result.result import Result
from grader.recording.recording import OwnInterfaces
from grader.run import virtual_time
from grader.run.handover import Plan
from grader.run.opening import open_submission
from grader.scenes.scene import Limits
from grader.text.message import msg
from tests import hand_ins, once, runs
from tests.docs.test_examples import environment_with
from tests.grader.testing import exercises
from tests.tiers import others_are_more
from turtlesim_py.world.events import CmdVel

FOLDER = runs.SUBMISSIONS / "interfaces"
LIGHT = Path(__file__).with_name("scenes") / "light"
JUDGED = hand_ins.read("interfaces")["judged"]
PLAN = Plan(Limits(first_motion_s=3, rest_s=1, total_s=6))
#: What each says once it has used its interfaces.
SAID = {
    "workspace": ("The sum is 6", "All: [0, 1, 1, 2, 3, 5, 8, 13]", "[tutorial_interfaces.msg.Num"),
    "one_package": ("done 4 True", "turtle_spiral.msg.Colour(r=255, g=255, b=255) driving False"),
    "beside": ("crossed 32", "driven for 52.0 s"),
}


def test_a_zip_of_a_workspace_is_one(tmp_path):
    file = shutil.make_archive(str(tmp_path / "alice"), "zip", FOLDER, "workspace")
    with open_submission(tmp_path / file) as zipped, open_submission(FOLDER / "workspace") as it:
        assert zipped.interfaces == it.interfaces
        assert sorted(it.interfaces.texts) == [
            *("tutorial_interfaces/action/Fibonacci", "tutorial_interfaces/msg/Num"),
            *("tutorial_interfaces/msg/Sphere", "tutorial_interfaces/srv/AddThreeInts"),
        ]


@pytest.mark.more("tests/grader/test_archive.py grades the reference of own_interfaces")
@pytest.mark.parametrize("name", SAID)
def test_a_program_uses_its_own_messages_services_and_actions(name):
    result = runs.graded(FOLDER / name)
    recording = runs.recordings(FOLDER / name).nominal
    assert (result.score, recording.run.flags) == (100.0, ())
    for text in SAID[name]:
        assert text in recording.output
    assert recording.interfaces.texts
    assert recording.interfaces.faults == recording.interfaces.unlike == {}


def lit():
    """A Python for which `LIGHT`, the exercise's scene, is installed: found by its entry point."""

    def install(folder):
        shutil.copytree(LIGHT, folder / "light")
        environment_with(folder / "light", folder / "venv")

    return once.folder(install, "lit", made_by=("tests/grader/scenes/light",)) / "venv/bin/python"


def graded(name, folder):
    """What one of `JUDGED` gets; only what is for an exercise of `LIGHT` takes long."""
    case, made = JUDGED[name], runs.path_of(f"interfaces/judged/{name}")
    if "exercise" not in case:
        return runs.graded(made)
    out = folder / "out"
    words = [str(lit()), "-m", "grader", "run", str(made), "--out", str(out)]
    words += ["--exercise", str(LIGHT / case["exercise"])]
    subprocess.run(words, check=True, cwd=folder, capture_output=True)
    return Result.read(out / "result.json")


@pytest.mark.timeout(300)
@pytest.mark.parametrize(
    "name", others_are_more("gradings of the same kind", JUDGED, "a_wrong_cmake")
)
def test_a_workspace_gets_what_was_judged_by_hand(tmp_path, name):
    result = graded(name, tmp_path)
    assert result.score == JUDGED[name]["score"]
    assert (result.diagnosis is not None) == ("says" in JUDGED[name])


def run(path, interfaces=None):
    with open_submission(path) as submission:
        if interfaces is not None:
            submission = replace(submission, interfaces=interfaces)
        return replace(virtual_time.run(submission, PLAN), interfaces=submission.interfaces)


def test_a_package_that_package_xml_does_not_name_is_remarked(tmp_path):
    place = shutil.copytree(FOLDER / "workspace", tmp_path / "it")
    for file, line in (
        ("turtle_tutorial", "  <exec_depend>tutorial_interfaces</exec_depend>\n"),
        ("tutorial_interfaces", "  <exec_depend>rosidl_default_runtime</exec_depend>\n"),
    ):
        path = place / "src" / file / "package.xml"
        path.write_text(path.read_text().replace(line, ""))
    with open_submission(place) as submission:
        notes = [str(note) for note in submission.notes]
    assert [note.partition(",")[0] for note in notes] == [
        "tutorial_interfaces/package.xml does not name rosidl_default_runtime",
        "turtle_tutorial/package.xml does not name tutorial_interfaces",
    ]


#: The reference publishes another Twist than the exercise has.
UNLIKE = {"geometry_msgs/msg/Twist": msg("Twist.msg of geometry_msgs has other fields")}
OTHERWISE = OwnInterfaces({"demo/msg/Num": "int8 num\n"}, {}, UNLIKE)


def test_types_that_the_two_sides_define_otherwise_exchange_nothing():
    recording = run(runs.REFERENCE, OTHERWISE)
    assert not recording.trace.of_kind(CmdVel)
    (topic,) = (each for each in recording.topics if each.topic == "/turtle1/cmd_vel")
    assert topic.type == "geometry_msgs/msg/Twist"


HINTS = """import rclpy
from course_interfaces.msg import Hint
from geometry_msgs.msg import Twist

rclpy.init()
node = rclpy.create_node("node")
node.create_subscription(Hint, "hints", lambda hint: print(hint.text, flush=True), 10)
hints = node.create_publisher(Hint, "hints", 10)
velocity = node.create_publisher(Twist, "/turtle1/cmd_vel", 10)
node.create_timer(0.5, lambda: (hints.publish(Hint(text="left")), velocity.publish(Twist())))
rclpy.spin(node)
"""


def test_a_program_has_the_interfaces_that_its_exercise_brings_along(tmp_path):
    folder = exercises.write(tmp_path / "ahead", interfaces="given")
    package = folder / "given" / "course_interfaces" / "msg"
    package.mkdir(parents=True)
    (package / "Hint.msg").write_text("string text\n")
    (tmp_path / "node.py").write_text(HINTS)
    recording = grading.record(tmp_path / "node.py", folder).nominal
    assert recording.output.startswith("left\nleft\n")
    assert recording.interfaces == OwnInterfaces({"course_interfaces/msg/Hint": "string text\n"})
