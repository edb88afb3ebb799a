"""What our bags are read with from inside of rosbags, which promises none of it.

A release that fails here needs another `grader.recording.bag`;
pyproject.toml lets no other series in before.
"""

from __future__ import annotations

import inspect
from pathlib import Path

import pytest
from rosbags.rosbag2 import storage_mcap

#: function or method -> its parameters
CALLED = {
    storage_mcap.McapReader.open: ["self"],
    storage_mcap.McapReader.messages: ["self", "connections", "start", "stop"],
    storage_mcap.McapReader.close: ["self"],
}


@pytest.mark.parametrize("function", CALLED, ids=lambda function: function.__qualname__)
def test_a_function_takes_what_it_is_given(function):
    assert list(inspect.signature(function).parameters) == CALLED[function]


def test_what_is_read_is_there(tmp_path: Path) -> None:
    assert hasattr(storage_mcap.McapReader(tmp_path / "bag.mcap"), "connections")
    assert storage_mcap.zstd.decompress(storage_mcap.zstd.compress(b"chunk")) == b"chunk"
