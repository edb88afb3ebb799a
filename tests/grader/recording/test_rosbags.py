"""What our bags are written and read with from inside of rosbags, which promises none of it.

A release that fails here needs another `grader.recording.bag`;
pyproject.toml lets no other series in before.
"""

from __future__ import annotations

import inspect
from pathlib import Path

import pytest
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer, storage_mcap

from grader.recording.bag import Rosbag2Writer

#: function or method -> its parameters
CALLED = {
    storage_mcap.write_channel: ["bio", "channel", "schemas"],
    storage_mcap.write_string: ["bio", "string"],
    storage_mcap.McapWriter.add_connection: ["self", "connection", "offered_qos_profiles"],
    storage_mcap.McapWriter.close: ["self", "version", "metadata"],
    storage_mcap.McapReader.open: ["self"],
    storage_mcap.McapReader.messages: ["self", "connections", "start", "stop"],
    storage_mcap.McapReader.close: ["self"],
}
#: of whom -> what is read or changed
USED = {
    "the writer": {"storage", "metapath"},
    "its storage": {"chunk", "channels", "schemas"},
    "its chunk": {"bio"},
    "the reader": {"connections"},
    "a channel": {"metadata"},
}


@pytest.mark.parametrize("function", CALLED, ids=lambda function: function.__qualname__)
def test_a_function_takes_what_it_is_given(function):
    assert list(inspect.signature(function).parameters) == CALLED[function]


def test_what_is_read_and_changed_is_there(tmp_path: Path) -> None:
    writer = Writer(tmp_path / "bag", version=9, storage_plugin=StoragePlugin.MCAP)
    writer.set_compression(CompressionMode.STORAGE, CompressionFormat.ZSTD)
    with writer:
        found = {
            "the writer": writer,
            "its storage": writer.storage,
            "its chunk": writer.storage.chunk,
        }
        lacking = [
            (who, name) for who in found for name in USED[who] if not hasattr(found[who], name)
        ]
    reader = storage_mcap.McapReader(tmp_path / "bag" / "bag.mcap")
    kinds = {"a channel": storage_mcap.Channel}
    lacking += [("the reader", name) for name in USED["the reader"] if not hasattr(reader, name)]
    lacking += [(who, n) for who in kinds for n in USED[who] if n not in kinds[who]._fields]
    assert lacking == []


def test_its_storage_is_replaced_where_it_looks_for_it():
    assert Writer.STORAGE_PLUGINS.keys() >= Rosbag2Writer.STORAGE_PLUGINS.keys()
