"""A trace survives the way from one process to another, and nothing else is taken for one."""

from __future__ import annotations

import io
import json
import pickle
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from grader.scenes.turtlesim.trace import Log, TurtleTrace, decode, encode
from tests.grader.driving import Spiral, drive
from tests.grader.scenes.turtlesim.traces import assert_same_trace, odd_events, odd_traces
from turtlesim_py.world.events import KINDS, CmdVel, Kill, Spawn
from turtlesim_py.world.trajectory import Trajectory


@pytest.fixture(scope="module")
def trace() -> TurtleTrace:
    return TurtleTrace.of(drive(Spiral(), ticks=100).trace)


# There and back -------------------------------------------------------------------------------


def test_a_decoded_trace_equals_the_encoded_one(trace):
    assert_same_trace(decode(encode(trace)), trace)


@given(odd=odd_traces())
def test_odd_traces_survive_bit_for_bit(odd):
    assert_same_trace(decode(encode(odd)), odd)


@pytest.mark.parametrize("op", KINDS)
@given(data=st.data())
def test_every_kind_of_event_survives(trace, op, data):
    short = replace(trace, trajectories={}, canvas=trace.canvas[:1], window=trace.window[:1])
    odd = replace(short, events=tuple(data.draw(st.lists(odd_events(op), min_size=1, max_size=3))))
    assert_same_trace(decode(encode(odd)), odd)


def test_equal_traces_have_equal_bytes_and_hashes(trace):
    again = TurtleTrace.of(drive(Spiral(), ticks=100).trace)
    assert encode(again) == encode(trace)
    assert again.sha256() == trace.sha256()


def test_names_that_no_file_could_have_survive(trace):
    way = trace.trajectory()
    odd = replace(trace, trajectories={"../a/b": way, "": way, "a\x85\u2028b": way, "\ud800": way})
    decoded = decode(encode(odd))
    assert list(decoded.trajectories) == list(odd.trajectories)


# Strictness -----------------------------------------------------------------------------------


class Trap:
    """Unpickled, it would do something."""

    done = False

    def __reduce__(self):
        return setattr, (Trap, "done", True)


def npz(**arrays) -> bytes:
    data = io.BytesIO()
    np.savez(data, **arrays)
    return data.getvalue()


def parts(trace: TurtleTrace) -> dict:
    with np.load(io.BytesIO(encode(trace))) as arrays:
        return dict(arrays)


def with_facts(trace: TurtleTrace, **changes) -> bytes:
    """The bytes of a trace with some of its facts changed; None takes one away."""
    arrays = parts(trace)
    facts = json.loads(arrays["facts"].tobytes()) | changes
    facts = {key: value for key, value in facts.items() if value is not None}
    arrays["facts"] = np.frombuffer(json.dumps(facts).encode(), np.uint8)
    return npz(**arrays)


def npy(array) -> bytes:
    data = io.BytesIO()
    np.save(data, array)
    return data.getvalue()


@given(data=st.binary(max_size=200))
def test_garbage_is_no_trace(data):
    with pytest.raises(ValueError, match="no trace of turtlesim"):
        decode(data)


def test_nothing_is_unpickled(trace):
    array = np.array([Trap()], dtype=object)
    found = [
        pickle.dumps(Trap()),
        npy(array),
        npz(facts=array),
        npz(**(parts(trace) | {"facts": array})),
        npz(**(parts(trace) | {"canvas": array})),
        npz(**(parts(trace) | {"rows_0": array})),
    ]
    for data in found:
        with pytest.raises(ValueError, match="no trace of turtlesim"):
            decode(data)
    assert not Trap.done


@pytest.mark.parametrize("part", [0, 0.001, 0.1, 0.5, 0.9, 0.999])
def test_a_truncated_trace_is_none(trace, part):
    whole = encode(trace)
    with pytest.raises(ValueError, match="no trace of turtlesim"):
        decode(whole[: int(len(whole) * part)])


@pytest.mark.parametrize("place", range(0, 100, 7))
def test_a_changed_byte_in_the_arrays_is_found(trace, place):
    whole = bytearray(encode(trace))
    at = whole.index(trace.canvas.tobytes()) + trace.canvas.nbytes * place // 100
    whole[at] ^= 1
    with pytest.raises(ValueError, match="no trace of turtlesim"):
        decode(bytes(whole))


@pytest.mark.parametrize("name", ["facts", "canvas", "window", "rows_0"])
def test_a_missing_part_is_told(trace, name):
    arrays = parts(trace)
    del arrays[name]
    with pytest.raises(ValueError, match=name):
        decode(npz(**arrays))


@pytest.mark.parametrize(
    "changes",
    [
        {"ticks": None},
        {"ticks": "many"},
        {"events": None},
        {"events": [3]},
        {"events": [{"tick": 1, "op": "fly"}]},
        {"events": [{"tick": 1, "op": "kill"}]},
        {"turtles": ["turtle1", "another"]},
        {"logs": [[1, "INFO", "turtlesim"]]},
        {"logs": [[1, "INFO", "turtlesim", "text", "more"]]},
    ],
)
def test_facts_of_the_wrong_kind_are_refused(trace, changes):
    with pytest.raises(ValueError, match="no trace of turtlesim"):
        decode(with_facts(trace, **changes))


@pytest.mark.parametrize("rows", [np.zeros((3, 8)), np.zeros((3, 5)), np.zeros(9), np.array("x")])
def test_rows_of_another_shape_are_refused(trace, rows):
    with pytest.raises(ValueError, match="no trace of turtlesim"):
        decode(npz(**(parts(trace) | {"rows_0": rows})))


@pytest.mark.parametrize("name", ["canvas", "window"])
@pytest.mark.parametrize(
    "pixels", [np.zeros((2, 3, 2), np.uint8), np.zeros((2, 3), np.uint8), np.zeros((2, 3, 4))]
)
def test_pictures_of_another_shape_or_type_are_refused(trace, name, pixels):
    with pytest.raises(ValueError, match="a picture is"):
        decode(npz(**(parts(trace) | {name: pixels})))


# Asking ---------------------------------------------------------------------------------------


def test_the_hash_knows_every_pose_and_every_input_and_nothing_else(trace):
    first = trace.trajectory()
    moved = replace(first, x=np.nextafter(first.x, np.inf))
    for other in (
        replace(trace, trajectories={"turtle1": moved}),
        replace(trace, trajectories={"turtle2": first}),
        replace(trace, events=trace.events[:-1]),
        replace(trace, events=trace.events[::-1]),
    ):
        assert other.sha256() != trace.sha256()
    for same in (
        replace(trace, logs=()),
        replace(trace, window=trace.window[::-1], canvas=trace.canvas[::-1]),
    ):
        assert same.sha256() == trace.sha256()


def test_the_hash_does_not_hang_on_the_order_in_which_turtles_appeared(trace):
    way = trace.trajectory()
    one, other = (dict.fromkeys(names, way) for names in ("ab", "ba"))
    assert replace(trace, trajectories=one).sha256() == replace(trace, trajectories=other).sha256()


def test_inputs_are_found_by_kind_and_turtle(trace):
    zero = (0.0, 0.0, 0.0)
    mine = CmdVel(tick=1, linear=zero, angular=zero)
    its = CmdVel(tick=2, turtle="another", linear=zero, angular=zero)
    spawn = Spawn(tick=2, x=1.0, y=2.0, theta=0.0, name="another")
    made = replace(trace, events=(mine, spawn, its))
    assert made.of_kind(CmdVel) == [mine]
    assert made.of_kind(CmdVel, "another") == [its]
    assert made.of_kind(Spawn) == made.of_kind(Spawn, "nobody") == [spawn]
    assert made.of_kind(Kill) == []


def test_a_turtle_that_never_was_has_an_empty_trajectory(trace):
    way = trace.trajectory("nobody")
    assert isinstance(way, Trajectory)
    assert len(way) == 0
    assert way.rgb.shape == (0, 3)


def test_its_length_in_seconds_is_16_ms_a_tick(trace):
    assert (trace.ticks, trace.simulated_s) == (100, 1.6)


def test_another_scene_s_trace_is_refused():
    with pytest.raises(TypeError, match="expected a trace of turtlesim, found a Log"):
        TurtleTrace.of(Log(1, "INFO", "turtlesim", "no trace"))
