from struct import pack

import pytest
import yaml
from mcap.reader import make_reader
from rosbags.rosbag2 import Reader

from grader.recording import bag, mcap, zstd
from grader.scenes.scene import load_scene
from tests.grader.driving import Spiral, drive, twist

SCENE = load_scene("turtlesim")


@pytest.fixture(scope="module")
def written(tmp_path_factory):
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


def test_it_finds_what_rosbags_finds_message_by_message(written):
    with written.open("rb") as stream:
        assert len(make_reader(stream).get_summary().chunk_indexes) > 2
    channels = bag.read_channels(written)
    with Reader(written.parent) as reader:
        expected = [(c.topic, time, bytes(data)) for c, time, data in reader.messages()]
        topics = [(c.topic, c.msgtype) for c in reader.connections]
    assert [(channel.topic, channel.msgtype) for channel in channels] == topics
    for channel in channels:
        found = list(zip(channel.times_ns.tolist(), channel.messages(), strict=True))
        assert found == [(time, data) for topic, time, data in expected if topic == channel.topic]
    places = {n: c.topic for c in channels for n in c.places.tolist()}
    assert [places[n] for n in range(len(places))] == [topic for topic, _, _ in expected]


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


@pytest.fixture(scope="module")
def short(tmp_path_factory):
    trace = drive(Spiral(), ticks=9).trace
    return bag.write(trace, SCENE, tmp_path_factory.mktemp("short") / "recording")


@pytest.mark.parametrize("changed", OTHER.values(), ids=OTHER.keys())
def test_metadata_that_is_not_that_of_the_bag_is_refused(short, tmp_path, changed):
    mcap = tmp_path / "recording.mcap"
    mcap.write_bytes(short.read_bytes())
    data = yaml.safe_load(short.with_name("metadata.yaml").read_text())
    data["rosbag2_bagfile_information"].update(changed)
    mcap.with_name("metadata.yaml").write_text(yaml.safe_dump(data))
    with pytest.raises((ValueError, TypeError)):
        bag.read_channels(mcap)


def test_metadata_that_would_make_an_object_makes_none(short, tmp_path):
    mcap = tmp_path / "recording.mcap"
    mcap.write_bytes(short.read_bytes())
    mcap.with_name("metadata.yaml").write_text("!!python/object/apply:os.system ['false']")
    with pytest.raises(yaml.YAMLError):
        bag.read_channels(mcap)


def record(kind, content):
    return pack("<BQ", kind, len(content)) + content


def text(*words):
    return b"".join(pack("<I", len(word)) + word.encode() for word in words)


def schema(number=1):
    return record(3, pack("<H", number) + text("std_msgs/msg/String", "ros2msg", "string data"))


def channel(number=1, of=1, encoding="cdr"):
    return record(4, pack("<HH", number, of) + text("/chatter", encoding, ""))


def message(time_ns=5, of=1):
    return record(5, pack("<HIQQ", of, 0, time_ns, time_ns) + b"data")


def chunk(data, size=None, compression="zstd"):
    packed = zstd.compress(data)
    head = pack("<QQQI", 0, 0, len(data) if size is None else size, 0) + text(compression)
    return record(6, head + pack("<Q", len(packed)) + packed)


def file(*records, profile="ros2"):
    inside = record(1, text(profile, "tests")) + b"".join(records) + record(15, bytes(4))
    return mcap.MAGIC + inside + record(2, bytes(20)) + mcap.MAGIC


def found(*records, profile="ros2"):
    return mcap.read_mcap(file(*records, profile=profile))


def test_what_is_made_here_is_read_and_not_that_of_another_profile():
    (one,) = found(chunk(schema() + channel() + message()), chunk(message(6)))
    assert (one.topic, one.msgtype) == ("/chatter", "std_msgs/msg/String")
    assert one.times_ns.tolist() == [5, 6]
    assert list(one.messages()) == [b"data", b"data"]
    with pytest.raises(ValueError, match="not that of ROS 2"):
        found(chunk(schema() + channel()), profile="ros1")


BEGUN = schema() + channel()
HOSTILE = {
    "more than may be": ([chunk(BEGUN, size=2**40)], "bytes at most"),
    "much more, in parts": ([chunk(BEGUN), chunk(b"", size=2**30)], "bytes at most"),
    "less than it says": ([chunk(BEGUN, size=2**20)], "expected 1048576 bytes compressed"),
    "more than it says": ([chunk(BEGUN, size=9)], "expected 9 bytes compressed"),
    "another compression": ([chunk(BEGUN, compression="lz4")], "found 'lz4'"),
    "none where there is one": ([chunk(BEGUN, compression="")], "damaged|cut off|bytes"),
    "a chunk that is cut off": ([record(6, bytes(30))], "damaged|cut off"),
    "a chunk in a chunk": ([chunk(BEGUN + chunk(message()))], "kind 6 stands among"),
    "messages outside of chunks": ([chunk(BEGUN), message()], "kind 5 stands between"),
    "an attachment": ([record(9, bytes(50))], "kind 9 stands between"),
    "a topic of no type": ([chunk(channel())], "has no type"),
    "a channel twice": ([chunk(BEGUN), chunk(channel())], "is there twice"),
    "another encoding": ([chunk(schema() + channel(encoding="json"))], "not in CDR"),
    "a message of no channel": ([chunk(BEGUN + message(of=2))], "of no channel"),
    "a message too short": ([chunk(BEGUN + record(5, bytes(9)))], "damaged|no channel"),
    "times that go back": ([chunk(BEGUN + message()), chunk(message(4))], "order of their times"),
    "a time beyond all": ([chunk(BEGUN + message(2**63))], "damaged"),
    "a record beyond all": ([chunk(BEGUN + pack("<BQ", 5, 2**64 - 1))], "cut off"),
    "a name beyond all": ([chunk(record(3, pack("<HI", 1, 2**32 - 1)))], "cut off"),
    "a name that is no text": ([chunk(record(3, pack("<HI", 1, 2) + b"\xff\xff"))], "utf-8"),
}


@pytest.mark.parametrize("records, why", HOSTILE.values(), ids=HOSTILE.keys())
def test_what_no_file_of_ours_holds_is_refused(records, why):
    with pytest.raises(ValueError, match=why):
        found(*records)


def test_a_file_that_is_cut_off_anywhere_is_refused():
    whole = file(chunk(BEGUN + message()))
    mcap.read_mcap(whole)
    for end in range(0, len(whole), 3):
        with pytest.raises(ValueError):
            mcap.read_mcap(whole[:end])
        if end < len(whole) - len(mcap.MAGIC) - 29 - 4:  # what stands behind the data is not read
            with pytest.raises(ValueError):
                mcap.read_mcap(whole[:end] + mcap.MAGIC)
