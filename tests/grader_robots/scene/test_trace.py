"""What a run leaves: who said what, through a bag."""

from pathlib import Path

import numpy as np
import pytest

from grader.errors import RecordingError
from grader.recording import bag
from grader_robots.scene import trace as messages
from grader_robots.scene.driving import drive, joint_state
from grader_robots.scene.scene import SCENE
from grader_robots.scene.trace import JOINT_STATES, TF, Heard, RobotTrace
from tests.grader_robots.scene.robots import URDF, walks


@pytest.fixture(scope="module")
def walk():
    return drive(walks, 200, URDF)


def test_the_scene_publishes_what_robot_state_publisher_does(walk):
    assert walk.description == URDF
    own = [t for t in walk.transforms if t.publisher == "scene"]
    assert {(t.topic, t.parent, t.child) for t in own} == {
        (TF, "axis", "body"),
        ("/tf_static", "body", "head"),
    }
    stamps = [t.stamp_ns for t in own if t.topic == TF]
    assert np.diff(stamps).tolist() == [64_000_000] * (len(stamps) - 1)  # 31.25 Hz in, half out


def test_what_the_submission_says_is_told_from_what_the_scene_says(walk):
    assert {t.child for t in walk.transforms if t.publisher == "submission"} == {"axis"}
    assert len(walk.joint_states) == 100


def there(trace: RobotTrace, folder: Path) -> RobotTrace:
    return RobotTrace.of(bag.read(bag.write(trace, SCENE, folder), SCENE, trace.duration_ns))


def test_a_trace_goes_through_a_bag_as_it_is_and_an_empty_one_does_so_too(walk, tmp_path):
    for trace in (walk, RobotTrace(0)):
        read = there(trace, tmp_path / str(trace.ticks))
        assert (read.messages, read.sha256()) == (trace.messages, trace.sha256())


def test_a_bag_without_publishers_is_no_recording(walk, tmp_path):
    with pytest.raises(KeyError):
        messages.from_channels([], 3)


def test_a_number_that_is_none_stays_one(tmp_path):
    def odd(tick, now_ns):
        return [joint_state(now_ns, ["turn", "\ufffd", "turn"], [float("nan"), float("inf"), 1])]

    made = drive(odd, 3, URDF)
    read = there(made, tmp_path / "odd")
    assert read.messages == made.messages
    assert np.isnan(read.joint_states[0].positions[0])


@pytest.mark.parametrize(
    "message",
    [
        Heard(9, JOINT_STATES, "submission", b"\x00\x01\x00\x00"),
        Heard(1, JOINT_STATES, "submission", b""),
        Heard(1, TF, "scene", b"\x00\x01\x00\x00\xff\xff\xff\xff"),
    ],
)
def test_what_a_robot_cannot_have_recorded_is_refused(message, tmp_path):
    with pytest.raises(RecordingError, match="holds no recording"):
        there(RobotTrace(3, (message,)), tmp_path / "bag")
