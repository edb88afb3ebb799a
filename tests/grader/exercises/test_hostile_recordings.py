"""Every check of ours comes to an end, with a finding, whatever was recorded."""

import warnings
from dataclasses import fields, replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from grader.exercise.check import judge
from grader.exercise.loading import load_exercise
from grader.recording.recording import Recording, Recordings, Run
from grader.recording.subject import Start
from grader.scenes.turtlesim.trace import TurtleTrace
from grader.testing import drive
from tests.conftest import CASES
from turtlesim_py.world import events
from turtlesim_py.world.trajectory import Trajectory

TICKS = 60
NAMES = ("turtlesim_challenge", "square")

numbers = st.floats(width=32) | st.sampled_from(
    [0.0, -0.0, 1e-45, 1e38, -1e38, np.inf, -np.inf, np.nan, 5.544445, 11.088889]
)
ticks = st.integers(0, TICKS + 1)
turtles = st.sampled_from(["turtle1", "turtle2"])
doubles = st.floats()
vectors = st.tuples(doubles, doubles, doubles)
INPUTS = (
    *(events.CmdVel, events.SetPen, events.TeleportAbsolute, events.Kill, events.Spawn),
    *(events.Reset, events.Clear),
)
FIELDS = {
    **{"tick": ticks, "turtle": turtles, "name": turtles, "linear": vectors, "angular": vectors},
    **dict.fromkeys(("r", "g", "b", "width", "off"), st.integers(0, 255)),
}
inputs = st.one_of(
    *(
        st.builds(kind, **{each.name: FIELDS.get(each.name, doubles) for each in fields(kind)})
        for kind in INPUTS
    ),
    st.builds(
        events.SetParameter,
        tick=ticks,
        name=st.sampled_from(["background_r", "background_x", "holonomic"]),
        value=st.booleans() | st.integers() | st.text(max_size=3),
    ),
)


@st.composite
def ways(draw: st.DrawFn) -> Trajectory:
    """What one turtle did: mostly within the arena, with gaps, with anything as a number."""
    when = sorted(draw(st.sets(st.integers(1, TICKS), max_size=TICKS)))
    rows = np.zeros((len(when), 9))
    rows[:, 0] = when
    chance = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    rows[:, 1:3] = chance.uniform(0, 11.088889, (len(when), 2))
    rows[:, 3:6] = chance.uniform(-4, 4, (len(when), 3)).astype(np.float32)
    for _ in range(draw(st.integers(0, 5)) if when else 0):
        at = draw(st.integers(0, len(when) - 1)), draw(st.integers(1, 5))
        rows[at] = draw(numbers)
    return Trajectory.of_rows(rows)


@st.composite
def recordings(draw: st.DrawFn) -> Recording:
    trace = TurtleTrace(
        ticks=TICKS,
        events=tuple(sorted(draw(st.lists(inputs, max_size=20)), key=lambda e: e.tick)),
        trajectories={name: draw(ways()) for name in draw(st.sets(turtles))},
        logs=(),
        canvas=np.full((500, 500, 4), draw(st.integers(0, 255)), np.uint8),
        window=np.zeros((500, 500, 3), np.uint8),
    )
    start = draw(st.none() | st.builds(Start, x=numbers, y=numbers, theta=numbers))
    return Recording(trace, Run(ticks=TICKS, simulated_s=TICKS * 0.016), start=start)


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.timeout(4 * CASES)
@settings(max_examples=CASES)
@given(nominal=recordings(), varied=recordings())
def test_whatever_was_recorded_is_judged(name, nominal, varied):
    exercise = load_exercise(name)
    asked = Recordings(replace(nominal, start=None), (varied,))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # numpy's, about numbers that are none
        found = judge(asked, exercise.checks, exercise.points, exercise.tolerances)
    assert {verdict.status for verdict in found} <= {"passed", "failed", "not_judged"}
    assert not any("fault of the exercise" in str(verdict.rationale) for verdict in found)


def test_thirty_thousand_inputs_are_judged():
    def floods(tick, pose, arena):
        for number in range(200):
            arena.command("turtle1", (float(number), 0.0, 0.0), (0.0, 0.0, 1.0))
            arena.set_pen("turtle1", number, 0, 0, 3, number % 2)
        if tick % 2:
            arena.teleport_relative("turtle1", 0.0, 0.0)

    recording = drive(floods, 75)
    for name in NAMES:
        exercise = load_exercise(name)
        varied = tuple(replace(recording, start=start) for start in exercise.starts())
        asked = Recordings(recording, varied)
        found = judge(asked, exercise.checks, exercise.points, exercise.tolerances)
        assert not any("fault of the exercise" in str(verdict.rationale) for verdict in found)
