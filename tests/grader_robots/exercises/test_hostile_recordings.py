"""Every check of a robot comes to an end, with a finding, whatever was recorded."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from grader.exercise.check import judge
from grader.exercise.loading import load_exercise
from grader.recording.recording import Recording, Recordings
from grader_robots.robot_py.robot_state import Placed
from grader_robots.scene.driving import EPOCH_NS, drive, joint_state, tf
from tests.conftest import CASES

TICKS = 60

ROBOT = load_exercise("state_publisher")
names = st.sampled_from(["swivel", "tilt", "periscope", "odom", "axis", "", "/a", "ü", "a" * 3000])
sizes = st.sampled_from([0.0, 1.0, -2.5, 1e-320, 1e300, np.inf, -np.inf, np.nan])
stamps = st.sampled_from([0, 1, EPOCH_NS, EPOCH_NS - 1, (2**31 - 1) * 10**9])
placed = st.builds(Placed, stamps, names, names, st.tuples(*[sizes] * 3), st.tuples(*[sizes] * 4))
messages = st.one_of(
    st.builds(joint_state, stamps, st.lists(names, max_size=5), st.lists(sizes, max_size=5)),
    st.lists(placed, max_size=3).map(lambda each: tf(*each)),
)


@pytest.mark.timeout(4 * CASES)
@settings(max_examples=CASES)
@given(said=st.lists(st.tuples(st.integers(1, TICKS), messages), max_size=30))
def test_whatever_a_robot_has_said_is_judged(said):
    trace = drive(lambda tick, _: [each for at, each in said if at == tick], TICKS, ROBOT.setting)
    asked = Recordings(Recording(trace, scene="robot"))
    found = judge(asked, ROBOT.checks, ROBOT.points, ROBOT.tolerances)
    assert not any("fault of the exercise" in str(verdict.rationale) for verdict in found)
