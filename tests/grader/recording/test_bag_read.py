"""Reading into columns finds what rosbags finds message by message, and refuses all else."""

from __future__ import annotations

from pathlib import Path

import pytest
import yaml
from mcap.reader import make_reader
from rosbags.rosbag2 import Reader

from grader.recording import bag
from grader.recording.channel import Channel
from grader.scenes import load_scene
from tests.grader.driving import Spiral, drive, twist

SCENE = load_scene("turtlesim")


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


def columns(channels: list[Channel]) -> dict[str, list[tuple[int, bytes]]]:
    return {
        channel.topic: list(zip(channel.times_ns.tolist(), channel.messages(), strict=True))
        for channel in channels
    }


def test_it_finds_what_rosbags_finds_message_by_message(written):
    channels = bag.read_channels(written)
    with Reader(written.parent) as reader:
        expected = [(c.topic, time, bytes(data)) for c, time, data in reader.messages()]
        topics = [(c.topic, c.msgtype) for c in reader.connections]
    assert [(channel.topic, channel.msgtype) for channel in channels] == topics
    for topic, found in columns(channels).items():
        assert found == [(time, data) for where, time, data in expected if where == topic]
    places = {n: c.topic for c in channels for n in c.places.tolist()}
    assert [places[n] for n in range(len(places))] == [topic for topic, _, _ in expected]


def test_it_is_a_bag_of_several_chunks(written):
    with written.open("rb") as stream:
        assert len(make_reader(stream).get_summary().chunk_indexes) > 2


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
        bag.read_channels(mcap)


def test_metadata_that_would_make_an_object_makes_none(written, tmp_path):
    mcap = tmp_path / "recording.mcap"
    mcap.write_bytes(written.read_bytes())
    mcap.with_name("metadata.yaml").write_text("!!python/object/apply:os.system ['false']")
    with pytest.raises(yaml.YAMLError):
        bag.read_channels(mcap)
