import json
import pickle
from dataclasses import replace
from struct import pack as packed

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from grader.recording.transfer import pack, unpack
from grader.scenes.turtlesim.scene import SCENE
from grader.scenes.turtlesim.trace import TurtleTrace
from tests.conftest import EXAMPLES
from tests.grader.driving import Spiral, drive
from tests.grader.scenes.turtlesim.traces import assert_same_trace, odd_events, odd_traces
from turtlesim_py.world.events import KINDS


@pytest.fixture(scope="module")
def trace():
    return TurtleTrace.of(drive(Spiral(), ticks=100).trace)


def there(trace):
    return TurtleTrace.of(unpack(pack(trace, SCENE), SCENE))


def test_an_unpacked_trace_equals_the_packed_one_and_equal_ones_have_equal_bytes(trace):
    assert_same_trace(there(trace), trace)
    again = TurtleTrace.of(drive(Spiral(), ticks=100).trace)
    assert pack(again, SCENE) == pack(trace, SCENE)
    assert again.sha256() == trace.sha256()


@given(odd=odd_traces())
def test_odd_traces_survive_bit_for_bit(odd):
    assert_same_trace(there(odd), odd)


@pytest.mark.parametrize("op", KINDS)
@settings(max_examples=EXAMPLES or 10)
@given(data=st.data())
def test_every_kind_of_event_survives(trace, op, data):
    short = replace(trace, trajectories={}, canvas=trace.canvas[:1], window=trace.window[:1])
    event = data.draw(odd_events(op))
    odd = replace(short, ticks=max(event.tick, 0), events=(event,))
    assert_same_trace(there(odd), odd)


def test_names_that_no_file_could_have_survive(trace):
    way = trace.trajectory()
    odd = replace(trace, trajectories={"../a/b": way, "": way, "a\x85\u2028b": way, "\ud800": way})
    assert list(there(odd).trajectories) == list(odd.trajectories)


class Trap:
    """Unpickled, it would do something."""

    done = False

    def __reduce__(self):
        return setattr, (Trap, "done", True)


def changed(trace, **changes):
    """The bytes of a trace with some of its head changed; None takes one away."""
    whole = pack(trace, SCENE)
    end = 8 + int.from_bytes(whole[:8], "little")
    head = json.loads(whole[8:end]) | changes
    text = json.dumps({key: value for key, value in head.items() if value is not None}).encode()
    return packed("<Q", len(text)) + text + whole[end:]


@given(data=st.binary(max_size=200))
def test_garbage_is_no_trace(data):
    with pytest.raises(ValueError, match="no trace of turtlesim"):
        unpack(data, SCENE)


def test_nothing_is_unpickled(trace):
    data = pickle.dumps(Trap())
    for found in (data, packed("<Q", len(data)) + data, pack(trace, SCENE) + data):
        with pytest.raises(ValueError, match="no trace of turtlesim"):
            unpack(found, SCENE)
    assert not Trap.done


@pytest.mark.parametrize("part", [0, 0.001, 0.5, 0.999])
def test_a_truncated_trace_is_none(trace, part):
    whole = pack(trace, SCENE)
    with pytest.raises(ValueError, match="no trace of turtlesim"):
        unpack(whole[: int(len(whole) * part)], SCENE)


@pytest.mark.parametrize(
    "changes",
    [
        *({"duration_ns": value} for value in (None, "many", 3)),
        *({"topics": value} for value in (None, [], ["/a"], [["/a", "std_msgs/msg/Int8"]])),
        *({"messages": value} for value in (None, -1, 10**9, "all")),
    ],
)
def test_a_head_of_another_trace_is_refused(trace, changes):
    with pytest.raises(ValueError, match="no trace of turtlesim"):
        unpack(changed(trace, **changes), SCENE)


@pytest.mark.parametrize("column", [1, 2])
@pytest.mark.parametrize("value", [-1, 1_000, 2**62])
def test_columns_of_another_trace_are_refused(trace, column, value):
    whole = bytearray(pack(trace, SCENE))
    at = 8 + int.from_bytes(whole[:8], "little") + 8 * column
    whole[at : at + 8] = packed("<q", value)
    with pytest.raises(ValueError, match="no trace of turtlesim"):
        unpack(bytes(whole), SCENE)
