import math
from dataclasses import fields, replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from grader.recording import reading, saving
from grader.recording.recording import ProgramRun, PublishedTopic, Recording, Recordings, Run
from grader.recording.subject import Start
from grader.run.finish import Ending, record
from grader.run.handover import Plan
from grader.scenes.scene import Limits
from grader.text.message import Message, msg
from tests.conftest import EXAMPLES
from tests.grader.driving import Spiral, drive, twist
from tests.grader.scenes.turtlesim.traces import assert_same_trace, odd_traces, texts
from turtlesim_py.scenario import read, replay
from turtlesim_py.world.floats import json_number
from turtlesim_py.world.trajectory import Trajectory


@pytest.fixture(scope="module")
def recorded():
    return drive(Spiral())


@pytest.fixture
def folder(recorded, tmp_path):
    saving.save_all(Recordings(recorded), tmp_path / "recording")
    return tmp_path / "recording"


def assert_same(loaded, saved):
    """Nothing differs, not the sign of a zero, nor the bits of a NaN, nor any order."""
    assert_same_trace(loaded.trace, saved.trace)
    for name in ("topics", "output", "run", "start", "scene"):
        assert getattr(loaded, name) == getattr(saved, name)


def crowd(tick, _, arena):
    """Several turtles, every kind of input, and values that are no ordinary numbers."""
    match tick:
        case 1:
            arena.spawn(2.0, 3.0, 1.0, "zoë/second")
            twist(arena, math.nan, math.inf)
            arena.set_pen("turtle1", 1, 2, 3, 4, 0)
            arena.command("zoë/second", (0.1, 1e-320, -1e300), (0.0, -0.0, 1 / 3))
            twist(arena, 0.25)
            arena.clear()
        case 2:
            arena.kill("nobody")
            arena.rotate_absolute("turtle1", -1.5, b"\x00\xff")
        case 3:
            arena.cancel(b"\x00\xff")
            arena.teleport_absolute("zoë/second", math.nan, -math.inf, 0.0)
            arena.set_parameter("holonomic", True)
        case 5:
            arena.kill("zoë/second")
            arena.spawn(1.0, 1.0, 0.0, "aaa")


def test_a_loaded_recording_equals_the_saved_one(recorded, folder):
    assert_same(reading.load(folder), recorded)
    assert_same(reading.load(folder / "recording.mcap"), recorded)  # any file of it names it


def test_every_kind_of_input_survives_in_its_order(tmp_path):
    recorded = drive(crowd, ticks=9)
    ops = {event.op for event in recorded.trace.events}
    assert ops > {"cmd_vel", "spawn", "kill", "cancel"}
    assert np.isnan(recorded.trace.trajectory("zoë/second").x).any()
    saving.save_all(Recordings(recorded), tmp_path)
    assert_same(reading.load(tmp_path), recorded)


def test_the_facts_about_a_run_survive(recorded, tmp_path):
    ticks, simulated_s = recorded.run.ticks, recorded.run.simulated_s
    programs = (ProgramRun("a-1", "b", "a", "killed", -9, "ü\n"),)
    flags = (Message.of("odd"), msg("ü {at}", at=1.5))
    told = ("ROS domain 77", flags, 42, "i", "late", {"a": 1.5, "b": "ü"}, programs)
    run = Run("virtual", "crashed", -11, ticks, simulated_s, 1.5, recorded.run.trace_sha256, *told)
    changed = replace(
        recorded,
        run=run,
        start=Start(1.25, math.pi, -0.1),
        topics=(PublishedTopic("/a", "b/msg/C"),),
        output="one\r\ntwo\rthree\x00\x1b[31m \ud800 é",
    )
    assert all(getattr(run, f.name) != getattr(Run(), f.name) for f in fields(Run))
    saving.save_all(Recordings(changed), tmp_path)
    assert_same(reading.load(tmp_path), changed)


def test_a_recording_without_a_single_tick_survives(recorded, tmp_path):
    nothing = replace(
        recorded.trace,
        ticks=0,
        events=(),
        logs=(),
        trajectories={"a": Trajectory.of_rows(np.zeros((0, 9)))},
    )
    empty = replace(recorded, trace=nothing, run=Run(trace_sha256=nothing.sha256()))
    saving.save_all(Recordings(empty), tmp_path)
    assert_same(reading.load(tmp_path), empty)


def test_the_hash_depends_on_what_happened_only(recorded, folder):
    loaded = reading.load(folder)
    run = Run(
        "virtual", "crashed", 1, wall_s=99.0, isolation="elsewhere", flags=(Message.of("odd"),)
    )
    plan = Plan(Limits(1, 2, 3), Start(1.0, 2.0, 3.0), seed=7, flags=(Message.of("odder"),))
    again = record(plan, loaded.trace, (), Ending(run, "more output"))
    assert again.run.trace_sha256 == recorded.run.trace_sha256
    other = drive(Spiral(), ticks=500)
    assert other.run.trace_sha256 != recorded.run.trace_sha256


def test_a_recording_replays_as_a_scenario_with_the_same_poses(recorded, folder):
    published = replay(read(folder / "scenario.json")).result["published"]
    assert published.keys() == recorded.trace.trajectories.keys()
    for name, way in recorded.trace.trajectories.items():
        rows = way.rows().tolist()
        assert published[name] == [[json_number(value) for value in row] for row in rows]


def test_the_scenario_begins_where_the_run_did_and_inputs_after_the_last_tick_spoil_nothing(
    recorded, tmp_path
):
    trace = recorded.trace
    late = replace(trace.events[-1], tick=trace.ticks + 1)
    late_one = replace(trace, events=(*trace.events, late))
    start = Start(1.0, 2.0, 3.0, 1.5)
    saving.save_all(Recordings(replace(recorded, trace=late_one, start=start)), tmp_path)
    scenario = read(tmp_path / "scenario.json")
    assert scenario["start"] == {"x": 1.0, "y": 2.0, "theta": 3.0, "speed": 1.5}
    assert replay(scenario).arena.speed_factor == 1.5


def test_varied_runs_come_back_in_their_order(tmp_path):
    recorded = drive(Spiral(), ticks=9)
    varied = tuple(replace(recorded, start=Start(float(n), 0.0, 0.0)) for n in range(11))
    saving.save_all(Recordings(recorded, varied), tmp_path)
    loaded = reading.load_all(tmp_path)
    assert_same(loaded.nominal, recorded)
    assert [r.start for r in loaded.varied] == [r.start for r in varied]


@st.composite
def odd_recordings(draw):
    trace = draw(odd_traces())
    finite = st.floats(allow_nan=False, allow_infinity=False)
    return Recording(
        trace=trace,
        topics=tuple(draw(st.lists(st.builds(PublishedTopic, texts, texts), max_size=3))),
        output=draw(st.text()),
        run=Run(
            ticks=trace.ticks,
            simulated_s=trace.duration_ns / 1e9,
            trace_sha256=trace.sha256(),
            seed=draw(st.none() | st.integers()),
        ),
        start=draw(st.none() | st.builds(Start, finite, finite, finite)),
    )


@settings(max_examples=EXAMPLES or 10)
@given(odd=odd_recordings())
def test_odd_values_survive_bit_for_bit(tmp_path_factory, odd):
    folder = tmp_path_factory.mktemp("odd")
    saving.save_all(Recordings(odd), folder)
    loaded = reading.load(folder)
    assert_same(loaded, odd)
    assert loaded.trace.sha256() == odd.trace.sha256()
