"""What a run leaves: who said what, from process to process and through a bag."""

from __future__ import annotations

import io

import numpy as np
import pytest

from grader.recording import bag
from grader.scenes.robot import messages, trace
from grader.scenes.robot.driving import drive, joint_state
from grader.scenes.robot.scene import SCENE
from grader.scenes.robot.trace import JOINT_STATES, TF, Heard, RobotTrace
from tests.grader.scenes.robot.robots import URDF, walks


@pytest.fixture(scope="module")
def walk() -> RobotTrace:
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


def test_a_trace_goes_through_bytes_and_through_a_bag_as_it_is(walk, tmp_path):
    there = trace.decode(trace.encode(walk))
    bag.write(walk, SCENE, tmp_path / "recording")
    read = RobotTrace.of(bag.read(tmp_path / "recording" / "recording.mcap", SCENE, walk.ticks))
    assert walk.messages == there.messages == read.messages
    assert walk.sha256() == there.sha256() == read.sha256()


def test_an_empty_trace_does_so_too(tmp_path):
    empty = RobotTrace(0)
    bag.write(empty, SCENE, tmp_path / "recording")
    read = bag.read(tmp_path / "recording" / "recording.mcap", SCENE, 0)
    assert RobotTrace.of(read).messages == trace.decode(trace.encode(empty)).messages == ()


def test_a_message_that_is_no_number_stays_one():
    def odd(tick, now_ns):
        return [joint_state(now_ns, ["turn", "\udcff", "turn"], [float("nan"), float("inf"), 1])]

    made = drive(odd, 3, URDF)
    there = trace.decode(trace.encode(made))
    assert there.messages == made.messages
    assert np.isnan(there.joint_states[0].positions[0])


@pytest.mark.parametrize(
    "message",
    [
        Heard(9, JOINT_STATES, "submission", b"\x00\x01\x00\x00"),
        Heard(1, JOINT_STATES, "submission", b""),
        Heard(1, TF, "scene", b"\x00\x01\x00\x00\xff\xff\xff\xff"),
    ],
)
def test_what_cannot_have_been_recorded_is_refused(message):
    with pytest.raises(ValueError, match="no trace of a robot"):
        trace.decode(trace.encode(RobotTrace(3, (message,))))


def test_foreign_arrays_are_refused():
    data = io.BytesIO()
    np.savez(data, ticks=np.array([1.5]))
    with pytest.raises(ValueError, match="no trace of a robot"):
        trace.decode(data.getvalue())


def test_a_bag_without_publishers_is_no_recording(walk, tmp_path):
    with pytest.raises(KeyError):
        messages.from_channels([], 3)
