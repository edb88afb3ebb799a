"""A recording keeps on disk what it was, bit for bit, and can be replayed."""

from __future__ import annotations

import json
import math
from dataclasses import fields, replace

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from grader.recording import recording as recordings
from grader.recording.recording import Recording, Recordings, Run, Start
from tests.grader.driving import Spiral, drive, twist
from turtlesim_py.replay import number, replay
from turtlesim_py.scenario import read


@pytest.fixture(scope="module")
def recorded() -> Recording:
    return drive(Spiral())


@pytest.fixture
def folder(recorded, tmp_path):
    recorded.save(tmp_path / "recording")
    return tmp_path / "recording"


def assert_same(loaded: Recording, saved: Recording) -> None:
    """Nothing differs, not the sign of a zero, nor the bits of a NaN, nor any order."""
    assert json.dumps(loaded.events) == json.dumps(saved.events)
    assert json.dumps(loaded.logs) == json.dumps(saved.logs)
    assert list(loaded.published) == list(saved.published)
    for name, rows in saved.published.items():
        assert loaded.published[name].shape == rows.shape
        assert loaded.published[name].tobytes() == rows.tobytes()
    for picture in ("canvas", "window"):
        ours, theirs = getattr(loaded, picture), getattr(saved, picture)
        assert ours.dtype == theirs.dtype
        assert np.array_equal(ours, theirs)
    for name in ("topics", "output", "run", "start"):
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
    assert_same(recordings.load(folder), recorded)


def test_every_kind_of_input_survives_in_its_order(tmp_path):
    recorded = drive(crowd, ticks=9)
    assert {event["op"] for event in recorded.events} > {"cmd_vel", "spawn", "kill", "cancel"}
    assert any(math.isnan(x) for x in recorded.published["zoë/second"][:, 1])
    recorded.save(tmp_path)
    assert_same(recordings.load(tmp_path), recorded)


def test_the_facts_about_a_run_survive(recorded, tmp_path):
    run = Run(
        "virtual", "crashed", -11, 3, 0.048, 1.5, "ab" * 32, "ROS domain 77", ("odd", "ü"), 42
    )
    changed = replace(
        recorded,
        run=run,
        start=Start(1.25, math.pi, -0.1),
        topics=({"topic": "/a", "type": "b/msg/C"},),
        output="one\r\ntwo\rthree\x00\x1b[31m \ud800 é",
    )
    assert all(getattr(run, f.name) != getattr(Run(), f.name) for f in fields(Run))
    changed.save(tmp_path)
    assert_same(recordings.load(tmp_path), changed)


def test_a_recording_without_a_single_tick_survives(recorded, tmp_path):
    empty = replace(recorded, events=(), logs=(), published={"a": np.zeros((0, 9))}, run=Run())
    empty.save(tmp_path)
    assert_same(recordings.load(tmp_path), empty)


def test_any_file_of_a_recording_names_it(recorded, folder):
    assert_same(recordings.load(folder / "recording.mcap"), recorded)


def test_the_hash_depends_on_what_happened_only(recorded, folder):
    loaded = recordings.load(folder)
    again = loaded.finished(ticks=loaded.run.ticks, wall_s=99.0)
    assert again.run.trace_sha256 == recorded.run.trace_sha256
    other = drive(Spiral(), ticks=500)
    assert other.run.trace_sha256 != recorded.run.trace_sha256


def test_a_recording_replays_as_a_scenario_with_the_same_poses(recorded, folder):
    published = replay(read(folder / "scenario.json")).result["published"]
    for name, rows in recorded.published.items():
        assert published[name] == [[number(value) for value in row] for row in rows.tolist()]


def test_inputs_that_came_after_the_last_tick_do_not_spoil_the_scenario(recorded, tmp_path):
    late = {**recorded.events[-1], "tick": recorded.run.ticks + 1}
    replace(recorded, events=(*recorded.events, late)).save(tmp_path)
    replay(read(tmp_path / "scenario.json"))


def test_a_run_that_started_elsewhere_has_no_scenario(recorded, tmp_path):
    recorded.save(tmp_path)
    replace(recorded, start=Start(1.0, 2.0, 3.0)).save(tmp_path)
    assert not (tmp_path / "scenario.json").exists()


def test_varied_runs_come_back_in_their_order(tmp_path):
    recorded = drive(Spiral(), ticks=50)
    varied = tuple(replace(recorded, start=Start(float(n), 0.0, 0.0)) for n in range(11))
    Recordings(recorded, varied).save(tmp_path)
    loaded = recordings.load_all(tmp_path)
    assert_same(loaded.nominal, recorded)
    assert [r.start for r in loaded.varied] == [r.start for r in varied]


# Odd values -----------------------------------------------------------------------------------

names = st.text(st.characters(exclude_categories=["Cs"]), max_size=8)
doubles = st.floats().map(lambda value: number(value, 17))
commands = st.fixed_dictionaries(
    {
        "op": st.just("cmd_vel"),
        "turtle": names,
        "linear": st.lists(doubles, min_size=3, max_size=3),
        "angular": st.lists(doubles, min_size=3, max_size=3),
    }
)
#: What no Twist can say: other keys, other lengths, 1.0 in place of 1, ...
others = st.dictionaries(
    st.sampled_from(["op", "turtle", "linear", "angular", "name"]),
    st.one_of(names, doubles, st.floats(), st.booleans(), st.lists(st.floats() | names)),
).map(lambda event: {**event, "op": "cmd_vel"})


@st.composite
def odd_recordings(draw) -> Recording:
    ticks = sorted(draw(st.lists(st.integers(0, 9), max_size=12)))
    bits = st.integers(0, 2**32 - 1)  # every float32 there is, NaNs of all kinds too
    published = {}
    for name in draw(st.lists(names, max_size=3, unique=True)):
        count = draw(st.integers(0, 4))
        rows = np.zeros((count, 9))
        rows[:, 0] = np.arange(count) + draw(st.integers(0, 3))
        values = draw(st.lists(bits, min_size=5 * count, max_size=5 * count))
        with np.errstate(invalid="ignore"):  # signalling NaNs become quiet ones here
            rows[:, 1:6] = np.array(values, np.uint32).view(np.float32).reshape(count, 5)
        rows[:, 6:] = draw(st.integers(0, 255))
        published[name] = rows
    severities = st.sampled_from(["DEBUG", "INFO", "WARN", "ERROR", "FATAL"])
    return Recording(
        events=tuple({"tick": tick, **draw(commands | others)} for tick in ticks),
        published=published,
        logs=tuple([tick, draw(severities), draw(names), draw(names)] for tick in ticks),
        canvas=np.full((2, 3, 4), draw(st.integers(0, 255)), np.uint8),
        window=np.full((2, 3, 3), draw(st.integers(0, 255)), np.uint8),
        output=draw(st.text()),
        run=Run(ticks=draw(st.integers(0, 12)), seed=draw(st.none() | st.integers())),
    )


@given(odd=odd_recordings())
@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.too_slow])
def test_odd_values_survive_bit_for_bit(tmp_path_factory, odd):
    folder = tmp_path_factory.mktemp("odd")
    odd.save(folder)
    loaded = recordings.load(folder)
    assert_same(loaded, odd)
    assert loaded.finished().run.trace_sha256 == odd.finished().run.trace_sha256
