import json
import subprocess
import sys

import numpy as np
import pytest
from PIL import Image

from tests import golden_runs
from turtlesim_py.scenario import ScenarioError, main, replay

STRAIGHT = {
    "ticks": 3,
    "events": [{"tick": 1, "op": "cmd_vel", "linear": [1, 0, 0], "angular": [0, 0, 0]}],
}


@pytest.mark.parametrize("name", golden_runs.NAMES)
def test_every_recorded_value_and_pixel_is_reproduced(name):
    recorded = golden_runs.load(name)
    ours = replay(recorded["scenario"])
    for part, expected in recorded.items():
        assert ours.result[part] == expected, part
    drawings = {name: ours.arena.canvas}
    drawings |= {f"{name}.{snapshot}": canvas for snapshot, canvas in ours.snapshots.items()}
    for drawing, canvas in drawings.items():
        assert golden_runs.differing_pixels(canvas.rgba(), golden_runs.drawing(drawing)) == 0


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


def test_the_command_writes_trace_path_window_and_snapshots(tmp_path):
    source = golden_runs.FOLDER / "background.json"
    command = [sys.executable, "-m", "turtlesim_py.scenario", source, "--out", tmp_path / "new"]
    subprocess.run(command, check=True)
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
    assert main([str(tmp_path / "line.json"), "--out", str(tmp_path)]) == 0
    assert (tmp_path / "line.path.png").exists()


@pytest.mark.parametrize(
    "text",
    [
        None,
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
def test_a_file_that_is_no_scenario_gives_one_line_and_exit_code_2(tmp_path, capsys, text):
    if text is not None:
        (tmp_path / "broken.json").write_text(text)
    assert main([str(tmp_path / "broken.json"), "--out", str(tmp_path)]) == 2
    said = capsys.readouterr().err
    assert said.startswith("scenario: ") and said.count("\n") == 1
