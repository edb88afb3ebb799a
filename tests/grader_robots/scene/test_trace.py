"""What a run leaves: who said what, from process to process and through a bag."""

import numpy as np
import pytest

from grader.recording import bag
from grader.recording.transfer import pack, unpack
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


def test_a_trace_goes_through_a_bag_as_it_is_and_an_empty_one_does_so_too(walk, tmp_path):
    for trace in (walk, RobotTrace(0)):
        place = tmp_path / str(trace.ticks) / "recording"
        bag.write(trace, SCENE, place)
        read = RobotTrace.of(bag.read(place / "recording.mcap", SCENE, trace.duration_ns))
        assert (read.messages, read.sha256()) == (trace.messages, trace.sha256())


def test_a_bag_without_publishers_is_no_recording(walk, tmp_path):
    with pytest.raises(KeyError):
        messages.from_channels([], 3)


def there(trace: RobotTrace) -> RobotTrace:
    return RobotTrace.of(unpack(pack(trace, SCENE), SCENE))


def test_messages_survive_the_way_from_process_to_process(walk):
    assert there(walk).messages == walk.messages
    assert there(walk).sha256() == walk.sha256()
    assert there(RobotTrace(0)).messages == ()


def test_a_number_that_is_none_stays_one():
    def odd(tick, now_ns):
        return [joint_state(now_ns, ["turn", "\ufffd", "turn"], [float("nan"), float("inf"), 1])]

    made = drive(odd, 3, URDF)
    assert there(made).messages == made.messages
    assert np.isnan(there(made).joint_states[0].positions[0])


@pytest.mark.parametrize(
    "message",
    [
        Heard(9, JOINT_STATES, "submission", b"\x00\x01\x00\x00"),
        Heard(1, JOINT_STATES, "submission", b""),
        Heard(1, TF, "scene", b"\x00\x01\x00\x00\xff\xff\xff\xff"),
    ],
)
def test_what_a_robot_cannot_have_recorded_is_refused(message):
    with pytest.raises(ValueError, match="no trace of robot"):
        there(RobotTrace(3, (message,)))
