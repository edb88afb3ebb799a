"""Reading by columns finds what rosbags finds message by message, and refuses all else."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st
from rosbags.rosbag2 import Reader

from grader.recording import bag, rosbag2_reader
from grader.recording.channel import Channel
from grader.scenes import load_scene
from grader.scenes.scene import STEP_NS
from tests.grader.driving import Spiral, drive, twist

SCENE = load_scene("turtlesim")
#: Where in its head a message says what it is, and how long.
OPCODE, LENGTH, CHANNEL = 0, 1, 9


@pytest.fixture(scope="module")
def written(tmp_path_factory) -> Path:
    """A bag of several chunks, with commands and other inputs between the poses."""

    class Busy(Spiral):
        def __call__(self, tick, pose, arena):
            super().__call__(tick, pose, arena)
            if tick == 700:
                arena.spawn(2.0, 3.0, 1.0, "second")
            if tick % 100 == 0:
                arena.clear()
                twist(arena, 1.0)

    recording = drive(Busy(), ticks=11_000)
    folder = tmp_path_factory.mktemp("bag") / "recording"
    return bag.write(recording.trace, SCENE, folder)


@pytest.fixture(scope="module")
def chunks(written):
    """The unpacked chunks with their indices."""
    reader = rosbag2_reader.McapReader(written)
    reader.open()
    known = {connection.id for connection in reader.connections}
    found = [
        (
            np.frombuffer(rosbag2_reader._unpacked(reader, chunk), np.uint8),
            rosbag2_reader._index(reader, chunk, known),
        )
        for chunk in reader.chunks
    ]
    reader.close()
    return found


def columns(channels: list[Channel]) -> dict[str, list[tuple[int, bytes]]]:
    return {
        channel.topic: list(zip(channel.times_ns.tolist(), channel.messages(), strict=True))
        for channel in channels
    }


def test_it_finds_what_rosbags_finds_message_by_message(written):
    channels = rosbag2_reader.read(written)
    with Reader(written.parent) as reader:
        expected = [(c.topic, time, bytes(data)) for c, time, data in reader.messages()]
        topics = [(c.topic, c.msgtype) for c in reader.connections]
    assert [(channel.topic, channel.msgtype) for channel in channels] == topics
    for topic, found in columns(channels).items():
        assert found == [(time, data) for where, time, data in expected if where == topic]
    places = {n: c.topic for c in channels for n in c.places.tolist()}
    assert [places[n] for n in range(len(places))] == [topic for topic, _, _ in expected]


def test_it_is_a_bag_of_several_chunks(chunks):
    assert len(chunks) > 2


@pytest.mark.parametrize("first", [True, False])
def test_a_message_that_the_index_leaves_out_is_missed(chunks, first):
    chunk, index = chunks[0]
    for channel, rows in index.items():
        cut = {**index, channel: rows[1:] if first else rows[:-1]}
        with pytest.raises(ValueError, match="missing in the index"):
            rosbag2_reader._messages(chunk, cut)


@pytest.mark.parametrize("by", [1, 7, 2**40, 2**63])
def test_an_index_that_leads_elsewhere_is_refused(chunks, by):
    chunk, index = chunks[0]
    wrong = {channel: rows.copy() for channel, rows in index.items()}
    next(iter(wrong.values()))[3, 1] += np.uint64(by)
    with pytest.raises(ValueError, match=r"tells of messages|out of its chunk"):
        rosbag2_reader._messages(chunk, wrong)


def test_an_index_with_another_time_is_refused(chunks):
    chunk, index = chunks[0]
    wrong = {channel: rows.copy() for channel, rows in index.items()}
    next(iter(wrong.values()))[3, 0] += np.uint64(STEP_NS)
    with pytest.raises(ValueError, match="tells of messages"):
        rosbag2_reader._messages(chunk, wrong)


def test_an_index_of_another_channel_is_refused(chunks):
    chunk, index = chunks[0]
    (one, rows), (other, others), *rest = index.items()
    with pytest.raises(ValueError, match="tells of messages"):
        rosbag2_reader._messages(chunk, {one: others, other: rows, **dict(rest)})


def test_a_message_that_is_told_of_twice_is_refused(chunks):
    chunk, index = chunks[0]
    channel, rows = next(iter(index.items()))
    with pytest.raises(ValueError, match="overlap"):
        rosbag2_reader._messages(chunk, {**index, channel: np.concatenate([rows, rows[-1:]])})


@pytest.mark.parametrize(
    ("field", "value"),
    [(OPCODE, [6]), (CHANNEL, [99]), (LENGTH, [0] * 8), (LENGTH, [255] * 8), (LENGTH, [50])],
)
def test_a_message_with_another_head_is_refused(chunks, field, value):
    chunk, index = chunks[0]
    at = int(next(iter(index.values()))[2, 1]) + field
    wrong = chunk.copy()
    wrong[at : at + len(value)] = value
    with pytest.raises(ValueError):
        rosbag2_reader._messages(wrong, index)


@given(
    places=st.lists(st.tuples(st.floats(0, 1), st.integers(0, 255)), min_size=1, max_size=9),
)
def test_any_damage_of_a_chunk_is_refused_or_leaves_its_messages_where_they_are(chunks, places):
    chunk, index = chunks[-1]
    whole = rosbag2_reader._messages(chunk, index)
    damaged = chunk.copy()
    for part, value in places:
        damaged[int(part * (len(chunk) - 1))] = value
    try:
        found = rosbag2_reader._messages(damaged, index)
    except ValueError:
        return
    assert all(np.array_equal(a, b) for a, b in zip(found, whole, strict=True))


OTHER = {
    "another file": {"relative_file_paths": ["other.mcap"]},
    "a file elsewhere": {"relative_file_paths": ["../recording.mcap"]},
    "two files": {"relative_file_paths": ["recording.mcap", "recording.mcap"]},
    "another count": {"message_count": 3},
    "another kind of bag": {"storage_identifier": "sqlite3"},
    "packed messages": {"compression_mode": "message"},
    "a version to come": {"version": 99},
    "no topics": {"topics_with_message_count": []},
    "a topic that is none": {"topics_with_message_count": [3]},
}


@pytest.mark.parametrize("changed", OTHER.values(), ids=OTHER.keys())
def test_metadata_that_is_not_that_of_the_bag_is_refused(written, tmp_path, changed):
    mcap = tmp_path / "recording.mcap"
    mcap.write_bytes(written.read_bytes())
    data = yaml.safe_load(written.with_name("metadata.yaml").read_text())
    data["rosbag2_bagfile_information"].update(changed)
    mcap.with_name("metadata.yaml").write_text(yaml.safe_dump(data))
    with pytest.raises((ValueError, TypeError)):
        rosbag2_reader.read(mcap)


def test_metadata_that_would_make_an_object_makes_none(written, tmp_path):
    mcap = tmp_path / "recording.mcap"
    mcap.write_bytes(written.read_bytes())
    mcap.with_name("metadata.yaml").write_text("!!python/object/apply:os.system ['false']")
    with pytest.raises(yaml.YAMLError):
        rosbag2_reader.read(mcap)
