"""Writes a recording as a rosbag2, real ROS messages in an MCAP file, and reads it. Needs no ROS.

The scene defines the topics, in its module `messages`.

A message's time is counted from the start of the run: a date would be the only thing in the bag
that differs between equal runs. Messages of equal times stand in the file in the order in which
they happened.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from copy import deepcopy
from pathlib import Path
from typing import Any, Final

import yaml

from grader.errors import RecordingError
from grader.recording.mcap import Channel, McapWriter, read_mcap
from grader.recording.subject import Keeper, Trace
from grader.ros.bag_types import BagTypes

#: Under whichever ROS a run was made: the bag's definitions are those of Jazzy.
DISTRO = "jazzy"
#: The C library's, where PyYAML has it: ten times as fast, and as safe.
_Loader: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
_Dumper: Any = getattr(yaml, "CSafeDumper", yaml.SafeDumper)
#: A value that is too long for its line: bags have always had it in the next one.
_LONG: Final = re.compile(r"(?m)^(?=.{81})( *)(\w+:) (\S+)$")
#: Of metadata.yaml.
_VERSION: Final = 9


def pack(trace: Trace, subject: Keeper, name: str = "recording") -> tuple[bytes, dict[str, Any]]:
    """Return a bag: its .mcap, and what its metadata.yaml says.

    The same trace gives the same bytes.

    Raises:
        ValueError: a type has no definition, or messages are not in the order of their times.
    """
    types = BagTypes(subject.definitions_of(trace))
    writer = McapWriter()
    #: topic -> the number of its channel, its type and the hash of that
    channels: dict[str, tuple[int, str, str]] = {}

    def channel(topic: str, kind: str) -> int:
        if topic not in channels:
            type_hash = types.type_hash(kind)
            number = writer.add_channel(topic, kind, types.definition(kind), type_hash)
            channels[topic] = number, kind, type_hash
        return channels[topic][0]

    for topic, kind in subject.bag_topics(trace):
        channel(topic, kind)
    last_ns = 0
    for time_ns, topic, kind, data in subject.to_messages(trace):
        if time_ns < last_ns:
            raise ValueError(f"to_messages() of {subject.name} is not in the order of times")
        writer.write(channel(topic, kind), time_ns, data)
        last_ns = time_ns
    topics = [
        (topic, kind, type_hash, writer.counts[number])
        for topic, (number, kind, type_hash) in channels.items()
    ]
    about = _about(f"{name}.mcap", writer.times_ns, topics)
    return writer.finish(_yaml(about).strip()), {"rosbag2_bagfile_information": about}


def write(trace: Trace, subject: Keeper, folder: Path) -> Path:
    """Write a bag; returns its .mcap, which is named like the folder. Last comes metadata.yaml."""
    data, metadata = pack(trace, subject, folder.name)
    folder.mkdir(parents=True)
    mcap = folder / f"{folder.name}.mcap"
    mcap.write_bytes(data)
    whole = mcap.with_name("metadata.yaml.tmp")
    whole.write_text(_yaml(metadata), encoding="utf-8")
    whole.replace(whole.with_suffix(""))
    return mcap


def read(mcap: Path, subject: Keeper, duration_ns: int) -> Trace:
    """Read a bag that `write` has written; `duration_ns` is how long was recorded."""
    wrong = f"cannot read the bag in {mcap.parent}"
    try:
        channels = read_channels(mcap)
        wrong = f"the bag in {mcap.parent} holds no recording"
        return subject.from_channels(channels, duration_ns)
    except MemoryError:  # a limit
        raise
    except Exception as error:  # where a bag or a message is damaged, its reader may raise anything
        # without the error's repr: for a decoding error that is the whole file
        raise RecordingError(f"{wrong}: {type(error).__name__}: {error!s:.200}") from error


# Writing --------------------------------------------------------------------------------------


def _about(
    file: str, times_ns: tuple[int, int], topics: Sequence[tuple[str, str, str, int]]
) -> dict[str, Any]:
    """Return rosbag2's metadata of a bag.

    Args:
        times_ns: of the first and the last message.
        topics: name, type, its hash, number of messages.
    """
    first_ns, last_ns = times_ns
    span = {
        "starting_time": {"nanoseconds_since_epoch": first_ns},
        "duration": {"nanoseconds": max(0, last_ns - first_ns)},
        "message_count": sum(count for *_, count in topics),
    }
    return {
        "version": _VERSION,
        "storage_identifier": "mcap",
        "relative_file_paths": [file],
        **span,
        "topics_with_message_count": [
            {
                "topic_metadata": {
                    "name": topic,
                    "type": kind,
                    "serialization_format": "cdr",
                    "offered_qos_profiles": [],
                    "type_description_hash": type_hash,
                },
                "message_count": count,
            }
            for topic, kind, type_hash, count in topics
        ],
        # of the file as a whole: its chunks are compressed, which is no matter of rosbag2
        "compression_format": "",
        "compression_mode": "",
        "files": [{"path": file, **deepcopy(span)}],  # else YAML refers to what was there
        "custom_data": None,
        "ros_distro": DISTRO,
    }


def _yaml(about: Mapping[str, Any]) -> str:
    text = yaml.dump(about, Dumper=_Dumper, default_flow_style=False)
    return _LONG.sub(r"\1\2 \n\1  \3", text)


# Reading --------------------------------------------------------------------------------------


def parse_channels(
    channels: Sequence[Channel], subject: Keeper, duration_ns: int, sha256: str
) -> Trace:
    """Parse the channels of a bag whose trace had a hash.

    Raises:
        ValueError: the subject reads something else than it wrote.
        Exception: the subject's own.
    """
    trace = subject.from_channels(channels, duration_ns)
    if trace.sha256() != sha256:
        raise ValueError("from_channels() gives back another sha256() than to_messages() got")
    return trace


def read_channels(mcap: Path) -> list[Channel]:
    """Read the channels of a bag, in their order; beside its .mcap lies its metadata.yaml.

    Raises:
        ValueError: it is damaged, or is none of ours.
        Exception: PyYAML's own.
    """
    channels = read_mcap(mcap.read_bytes())
    _check_metadata(mcap, channels)
    return channels


def _check_metadata(mcap: Path, channels: list[Channel]) -> None:
    """Check that metadata.yaml describes this bag, for readers that use it."""
    text = mcap.with_name("metadata.yaml").read_text(encoding="utf-8")
    about = yaml.load(text, _Loader)["rosbag2_bagfile_information"]
    right = {
        "version": _VERSION,
        "storage_identifier": "mcap",
        "relative_file_paths": [mcap.name],
        "compression_mode": "",
        "message_count": sum(map(len, channels)),
    }
    for key, value in right.items():
        if about[key] != value:
            raise ValueError(f"metadata.yaml: {key} is {about[key]!r:.80}, not {value!r}")
    listed = {
        topic["topic_metadata"]["name"]: (
            *(topic["topic_metadata"][key] for key in ("type", "serialization_format")),
            topic["message_count"],
        )
        for topic in about["topics_with_message_count"]
    }
    right_topics = {c.topic: (c.msgtype, "cdr", len(c)) for c in channels}
    if listed != right_topics or len(listed) < len(channels):
        raise ValueError("metadata.yaml tells of other topics, or two channels have the same one")
