"""Traces with everything odd that one can hold, and a comparison that overlooks nothing."""

import struct
from dataclasses import fields

import numpy as np
from hypothesis import strategies as st

from grader.scenes.turtlesim.trace import Log, TurtleTrace
from turtlesim_py.world import events
from turtlesim_py.world.events import Event, from_json, to_json
from turtlesim_py.world.trajectory import COLUMNS, Trajectory

#: Any text but halves of surrogate pairs, which ROS's strings cannot hold.
texts = st.text(st.characters(exclude_categories=["Cs"]), max_size=8)
#: What a turtle with topics of its own can be called: what ROS accepts in a topic's name. Nothing
#: else publishes or is commanded, and not all else would survive as a topic: YAML, in which a bag's
#: topics are listed, reads U+0085 as a line break.
topic_names = st.from_regex(
    r"[A-Za-z_][A-Za-z0-9_]{0,4}(/[A-Za-z_][A-Za-z0-9_]{0,4})?", fullmatch=True
)
severities = st.sampled_from(["DEBUG", "INFO", "WARN", "ERROR", "FATAL"])

_ticks = st.integers(0, 9)
_doubles = st.floats()
_bytes = st.integers(0, 255)
_vectors = st.tuples(_doubles, _doubles, _doubles)
_ids = st.binary(max_size=16) | texts | st.integers()


_of_type = {"int": _bytes, "float": _doubles, "str": texts, "Vector": _vectors, "GoalId": _ids}


def _of(kind, **more):
    own = {each.name: each.type for each in fields(kind) if each.name not in ("tick", *more)}
    more |= {name: _of_type[its] for name, its in own.items()}
    return st.builds(kind, tick=_ticks, **more)


_doubles_set = _of(events.SetParameter, value=_doubles, double=st.just(True))
_others_set = _of(
    events.SetParameter, value=st.booleans() | st.integers() | texts, double=st.just(False)
)
#: op -> any event of this kind.
_any_of_kind = {
    op: _of(kind) for op, kind in events.KINDS.items() if kind is not events.SetParameter
} | {"cmd_vel": _of(events.CmdVel, turtle=topic_names), "param": _others_set | _doubles_set}


def odd_events():
    """Events of all kinds as a recorder takes them down."""
    found = st.one_of(*(_any_of_kind[op] for op in events.KINDS))
    return found.map(lambda event: from_json(to_json(event)))


@st.composite
def odd_traces(draw):
    """Traces that no run makes, but that nothing forbids."""
    bits = st.integers(0, 2**32 - 1)  # every float32 there is, NaNs of all kinds too
    trajectories = {}
    for name in draw(st.lists(topic_names, max_size=3, unique=True)):
        count = draw(st.integers(0, 4))
        rows = np.zeros((count, len(COLUMNS)))
        rows[:, 0] = np.arange(count) + draw(st.integers(1, 4))
        values = draw(st.lists(bits, min_size=5 * count, max_size=5 * count))
        with np.errstate(invalid="ignore"):  # signalling NaNs become quiet ones here
            rows[:, 1:6] = np.array(values, np.uint32).view(np.float32).reshape(count, 5)
        rows[:, 6:] = draw(_bytes), draw(_bytes), draw(_bytes)
        trajectories[name] = Trajectory.of_rows(rows)
    taken = draw(st.lists(odd_events(), max_size=12))
    lines = draw(st.lists(st.builds(Log, _ticks, severities, texts, texts), max_size=12))
    return TurtleTrace(
        ticks=draw(st.integers(8, 12)),  # no tick above is later than 9, the one after the last
        # inputs and lines are taken down as time goes on
        events=tuple(sorted(taken, key=lambda event: event.tick)),
        trajectories=trajectories,
        logs=tuple(sorted(lines, key=lambda line: line.tick)),
        canvas=np.full((2, 3, 4), draw(_bytes), np.uint8),
        window=np.full((2, 3, 3), draw(_bytes), np.uint8),
    )


def assert_same_trace(ours, theirs):
    """Nothing differs, not the sign of a zero, nor the bits of a NaN, nor any type or order."""
    assert ours.ticks == theirs.ticks
    assert [_bits(event) for event in ours.events] == [_bits(event) for event in theirs.events]
    assert ours.logs == theirs.logs
    assert list(ours.trajectories) == list(theirs.trajectories)
    for name, way in theirs.trajectories.items():
        assert_same_trajectory(ours.trajectories[name], way)
    for picture in ("canvas", "window"):
        _assert_same_array(getattr(ours, picture), getattr(theirs, picture))
    assert ours.sha256() == theirs.sha256()


def assert_same_trajectory(ours, theirs):
    for column in fields(Trajectory):
        _assert_same_array(getattr(ours, column.name), getattr(theirs, column.name))


def _assert_same_array(ours, theirs):
    assert (ours.dtype, ours.shape) == (theirs.dtype, theirs.shape)
    assert ours.tobytes() == theirs.tobytes()


def _bits(value):
    """An event, or a value in one, as something that is equal only where every bit is."""
    if isinstance(value, Event):
        return type(value), [_bits(getattr(value, field.name)) for field in fields(value)]
    if isinstance(value, tuple):
        return [_bits(part) for part in value]
    return type(value), struct.pack("<d", value) if isinstance(value, float) else value
