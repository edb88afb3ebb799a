"""Replayed scenarios equal the recordings of the original, in every row and every pixel."""

from __future__ import annotations

import json
import subprocess
import sys

import numpy as np
import pytest
from PIL import Image

from tests import golden_runs
from turtlesim_py.scenario import Replay, ScenarioError, replay

STRAIGHT = {
    "ticks": 3,
    "events": [{"tick": 1, "op": "cmd_vel", "linear": [1, 0, 0], "angular": [0, 0, 0]}],
}


@pytest.fixture(scope="module")
def replayed():
    kept: dict[str, Replay] = {}

    def get(name):
        if name not in kept:
            kept[name] = replay(golden_runs.load(name)["scenario"])
        return kept[name]

    return get


@pytest.mark.parametrize("name", golden_runs.NAMES)
def test_every_recorded_value_is_reproduced(name, replayed):
    recorded, ours = golden_runs.load(name), replayed(name).result
    for part, expected in recorded.items():
        assert ours[part] == expected, part


@pytest.mark.parametrize("name", golden_runs.NAMES)
def test_every_recorded_pixel_is_reproduced(name, replayed):
    ours = replayed(name)
    drawings = {name: ours.arena.canvas}
    drawings |= {f"{name}.{snapshot}": canvas for snapshot, canvas in ours.snapshots.items()}
    for drawing, canvas in drawings.items():
        assert golden_runs.differing_pixels(canvas.rgba(), golden_runs.drawing(drawing)) == 0


def test_replaying_twice_gives_the_same_result():
    scene = golden_runs.load("spawn_many")["scenario"]
    assert replay(scene).result == replay(scene).result


def test_a_command_to_a_turtle_that_is_gone_does_nothing():
    events = [{"tick": 1, "op": "kill", "name": "turtle1"}, {**STRAIGHT["events"][0], "tick": 2}]
    assert replay({**STRAIGHT, "events": events}).result["turtles_at_end"] == []


@pytest.mark.parametrize(
    ("event", "words"),
    [
        ({"tick": 1, "op": "fly"}, "event 0 (tick 1): unknown op 'fly'"),
        ({"tick": 9, "op": "clear"}, "event 0: 'tick' must be from 1 to 3, found 9"),
        ({"tick": 1, "op": "spawn", "x": 1}, "event 0 (tick 1, spawn): no field 'y'"),
        ({"tick": 1, "op": "cmd_vel", "linear": [1], "angular": [0, 0, 0]}, "cmd_vel"),
        ({"tick": 1, "op": "set_pen", "r": 999, "g": 0, "b": 0, "width": 1, "off": 0}, "set_pen"),
        ("clear", "event 0"),
        ({"tick": True, "op": "clear"}, "event 0"),
    ],
)
def test_a_wrong_event_is_named_with_its_place(event, words):
    with pytest.raises(ScenarioError) as error:
        replay({"ticks": 3, "events": [event]})
    assert words in str(error.value)


def command(*arguments):
    return subprocess.run(
        [sys.executable, "-m", "turtlesim_py.scenario", *map(str, arguments)],
        capture_output=True,
        text=True,
        check=False,
    )


def test_the_command_writes_trace_path_window_and_snapshots(tmp_path):
    source = golden_runs.FOLDER / "background.json"
    done = command(source, "--out", tmp_path / "new")
    assert done.returncode == 0, done.stderr
    assert {path.name for path in (tmp_path / "new").iterdir()} == {
        "background.json",
        "background.png",
        "background.path.png",
        "background.a_before.path.png",
        "background.b_after_r_no_tick.path.png",
        "background.c_after_gb.path.png",
        "background.d_after_clear.path.png",
    }
    written = json.loads((tmp_path / "new" / "background.json").read_text())
    assert written["published"] == golden_runs.load("background")["published"]
    canvas = replay(golden_runs.load("background")["scenario"]).arena.canvas
    with Image.open(tmp_path / "new" / "background.path.png") as path:
        assert (path.mode, np.array_equal(path, canvas.rgba())) == ("RGBA", True)
    with Image.open(tmp_path / "new" / "background.png") as window:
        assert (window.mode, window.size) == ("RGB", (500, 500))


def test_a_bare_scenario_is_named_after_its_file(tmp_path):
    (tmp_path / "line.json").write_text(json.dumps(STRAIGHT))
    assert command(tmp_path / "line.json", "--out", tmp_path).returncode == 0
    assert (tmp_path / "line.path.png").exists()


@pytest.mark.parametrize(
    "text",
    [
        "{",
        "[]",
        "{}",
        '{"ticks": "three"}',
        '{"ticks": -3}',
        '{"ticks": 3, "events": 5}',
        '{"ticks": 3, "name": "../../elsewhere"}',
        '{"ticks": 3, "events": [{"tick": 1, "op": "snapshot", "name": "/tmp/x"}]}',
    ],
)
def test_a_file_that_is_no_scenario_gives_one_line_and_exit_code_2(tmp_path, text):
    (tmp_path / "broken.json").write_text(text)
    done = command(tmp_path / "broken.json", "--out", tmp_path)
    assert done.returncode == 2
    assert done.stderr.startswith("scenario: ") and done.stderr.count("\n") == 1


def test_a_missing_file_gives_one_line_and_exit_code_2(tmp_path):
    done = command(tmp_path / "nothing.json")
    assert (done.returncode, done.stderr.count("\n")) == (2, 1)
