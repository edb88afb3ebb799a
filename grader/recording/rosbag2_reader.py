"""Reads a bag that `grader.recording.rosbag2_writer` has written, by rosbags, into columns."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import yaml
from rosbags.rosbag2.storage_mcap import McapReader

from grader.recording.channel import Channel, divided

#: The C library's, where PyYAML has it: ten times as fast, and as safe.
_Loader: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
#: The oldest and the newest version of metadata.yaml that rosbags reads.
_VERSIONS = range(1, 10)


def read(mcap: Path) -> list[Channel]:
    """Read the channels of a bag, in their order; beside its .mcap lies its metadata.yaml.

    Raises:
        ValueError: it is damaged, or is none of ours.
        Exception: rosbags' and yaml's own.
    """
    reader = McapReader(mcap)
    reader.open()
    try:
        topics = {c.id: (c.topic, c.msgtype) for c in reader.connections}
        found = list(reader.messages(reader.connections))
    finally:
        reader.close()
    places = {id: number for number, id in enumerate(topics)}
    columns = [(time_ns, places[of.id], len(cdr)) for of, time_ns, cdr in found]
    times_ns, numbers, sizes = np.array(columns, np.int64).reshape(-1, 3).T
    data = np.frombuffer(b"".join(cdr for _, _, cdr in found), np.uint8)
    channels = divided(list(topics.values()), times_ns, numbers, sizes, data)
    _check_metadata(mcap, channels)
    return channels


def _check_metadata(mcap: Path, channels: list[Channel]) -> None:
    """Check that metadata.yaml describes this bag, for readers that use it."""
    text = mcap.with_name("metadata.yaml").read_text(encoding="utf-8")
    about = yaml.load(text, _Loader)["rosbag2_bagfile_information"]
    right = {
        "storage_identifier": "mcap",
        "relative_file_paths": [mcap.name],
        "compression_mode": "",
        "message_count": sum(map(len, channels)),
    }
    for key, value in right.items():
        if about[key] != value:
            raise ValueError(f"metadata.yaml: {key} is {about[key]!r:.80}, not {value!r}")
    if about["version"] not in _VERSIONS:
        raise ValueError(f"metadata.yaml is of the version {about['version']!r:.80}")
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
