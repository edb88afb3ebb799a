"""A recording survives the way to the disk and back, and can be replayed."""

from __future__ import annotations

import json

import numpy as np
import pytest

from grader import recording as recordings
from tests.grader.driving import Spiral, drive
from turtlesim_py.replay import replay


@pytest.fixture(scope="module")
def recorded():
    return drive(Spiral())


@pytest.fixture
def folder(recorded, tmp_path):
    recorded.save(tmp_path / "recording")
    return tmp_path / "recording"


def test_a_loaded_recording_equals_the_saved_one(recorded, folder):
    loaded = recordings.load(folder)
    assert loaded.events == recorded.events or json.dumps(loaded.events) == json.dumps(
        recorded.events
    )
    assert loaded.run == recorded.run
    for name, rows in recorded.published.items():
        assert np.array_equal(loaded.published[name], rows)
    assert np.array_equal(loaded.canvas, recorded.canvas)
    assert np.array_equal(loaded.window, recorded.window)


def test_the_hash_depends_on_what_happened_only(recorded, folder):
    loaded = recordings.load(folder)
    again = loaded.finished(ticks=loaded.run.ticks, wall_s=99.0)
    assert again.run.trace_sha256 == recorded.run.trace_sha256
    other = drive(Spiral(), ticks=500)
    assert other.run.trace_sha256 != recorded.run.trace_sha256


def test_a_recording_replays_as_a_scenario_with_the_same_poses(folder):
    data = json.loads((folder / recordings.FILE).read_text())
    assert replay(data["scenario"]).result["published"] == data["published"]


def test_a_missing_recording_is_named(tmp_path):
    with pytest.raises(recordings.RecordingError, match="cannot read the recording"):
        recordings.load(tmp_path / "nowhere")


@pytest.mark.parametrize("text", ["{", "[]", "{}", '{"schema": "turtlesim-grader/recording/v1"}'])
def test_a_damaged_recording_is_an_error_and_no_traceback(folder, text):
    (folder / recordings.FILE).write_text(text)
    with pytest.raises(recordings.RecordingError):
        recordings.load(folder)
