import json
import math
import os
import re
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

from grader import cli
from grader.errors import RecordingError
from grader.recording import bag, reading, saving
from grader.recording.observations import End, Observations, SourceLine, Standstill
from grader.recording.recording import OwnInterfaces, Provenance, Recordings
from grader.recording.saving import BAG, FILES, OUTPUT, RUN, SCHEMA
from grader.recording.saving import CIRCUMSTANCES_FILE as CIRCUMSTANCES
from grader.scenes.turtlesim.trace import Log
from grader.submission.package_trace import PackageTrace
from grader.system import content
from grader.system.strict_json import to_json
from grader.text.message import msg
from tests.files import contents
from tests.grader.driving import Spiral, drive
from turtlesim_py.world.events import RotateAbsolute, SetParameter, SetPen
from turtlesim_py.world.trajectory import Trajectory

TICKS = 200
OBSERVATIONS = Observations(
    is_known=True,
    ends=(End("publisher", "/pose", "turtlesim/msg/Pose", False, 3, SourceLine("a.py", 7)),),
    stop=Standstill(
        "callback", 1.5, "Client.call", SourceLine("a.py", 9, "on_pose", "self.pen.call(red)")
    ),
)
PACKAGE = PackageTrace(others=("beside",))


@pytest.fixture(scope="module")
def recorded():
    return replace(drive(Spiral(), ticks=TICKS), observations=OBSERVATIONS, package=PACKAGE)


@pytest.fixture(scope="module")
def saved(recorded, tmp_path_factory):
    """As `save` has left it; not to be changed."""
    folder = tmp_path_factory.mktemp("saved") / "recording"
    saving.save_all(Recordings(recorded), folder)
    return folder


@pytest.fixture
def folder(saved, tmp_path):
    return shutil.copytree(saved, tmp_path / "recording")


def change(path, **values):
    """Change what stands at the top of a JSON file; `run__ticks` is `ticks` in `run`."""
    data = json.loads(path.read_text())
    for key, value in values.items():
        *parents, last = key.split("__")
        place = data
        for parent in parents:
            place = place[parent]
        place[last] = value
    path.write_text(json.dumps(data))


def test_equal_runs_make_equal_files_and_so_does_what_was_read(folder, tmp_path):
    again = replace(drive(Spiral(), ticks=TICKS), observations=OBSERVATIONS, package=PACKAGE)
    for number, recording in enumerate((again, reading.load(folder))):
        saving.save_all(Recordings(recording), tmp_path / str(number))
        assert contents(tmp_path / str(number)) == contents(folder)


PROVENANCE = Provenance(
    date="2026-11-21T23:52:52Z",
    grader="0.1.0",
    python="3.12.3",
    rclpy="7.1.6",
    ros_distro="jazzy",
    submission="alice.zip",
    submission_sha256="a" * 64,
    exercise="square",
    exercise_sha256="b" * 64,
    seed=7,
    conditions={"limits.total_s": 90.0},
)
INTERFACES = OwnInterfaces(
    {"mine/msg/Num": "int8 num\n"},
    {"mine/msg/Nums": msg("{file} is missing", file="Nums.msg")},
    {"mine/msg/Num": msg("Num.msg has other fields")},
)


def test_what_differs_between_equal_runs_stands_apart_and_can_be_done_without(
    recorded, folder, tmp_path
):
    run = replace(recorded.run, wall_s=12.5, isolation="ROS domain 77")
    other = replace(recorded, run=run, provenance=PROVENANCE, interfaces=INTERFACES)
    saving.save_all(Recordings(other), tmp_path / "other")
    ours, theirs = contents(folder), contents(tmp_path / "other")
    assert {name for name in ours if ours[name] != theirs[name]} == {CIRCUMSTANCES}
    found = reading.load(tmp_path / "other")
    assert (found.run, found.provenance, found.interfaces) == (run, PROVENANCE, INTERFACES)
    assert reading.load(folder).provenance is None
    (folder / CIRCUMSTANCES).unlink()
    assert reading.load(folder).run == recorded.run


def test_pictures_and_scenario_are_copies_that_nobody_reads(recorded, folder):
    for name in ("path.png", "window.png", "scenario.json"):
        (folder / name).unlink()
    assert (reading.load(folder).trace.canvas == recorded.trace.canvas).all()


def test_the_metadata_comes_last(recorded, folder, monkeypatch):
    rename, moved = Path.replace, []
    monkeypatch.setattr(Path, "replace", lambda a, b: moved.append(b.name) or rename(a, b))
    saving.save_all(Recordings(recorded), folder)
    assert moved[-1] == "metadata.yaml"


# a turtle's window is its plan
@pytest.mark.parametrize("stop_at", FILES)
def test_a_save_that_is_cut_off_leaves_no_recording(recorded, tmp_path, monkeypatch, stop_at):
    rename = Path.replace

    def cut_off(source, target):
        if target == tmp_path / stop_at:
            raise OSError("no space left on device")
        return rename(source, target)

    monkeypatch.setattr(Path, "replace", cut_off)
    with pytest.raises(OSError, match="no space left"):
        saving.save_all(Recordings(recorded, (recorded,)), tmp_path)
    with pytest.raises(RecordingError):
        reading.load_all(tmp_path)
    assert not (tmp_path / saving.UNFINISHED).exists()


def test_a_save_that_is_interrupted_leaves_all_as_it_was(recorded, tmp_path, monkeypatch):
    saving.save_all(Recordings(recorded, (recorded,) * 2), tmp_path / "old")
    before = contents(tmp_path / "old")
    write = saving._write_json

    def interrupted(path, facts, **more):
        if "1" in path.parts:  # the nominal one is written by then
            raise KeyboardInterrupt
        write(path, facts, **more)

    monkeypatch.setattr(saving, "_write_json", interrupted)
    for name in ("old", "new"):
        with pytest.raises(KeyboardInterrupt):
            saving.save_all(Recordings(drive(Spiral(), ticks=50), (recorded,)), tmp_path / name)
    assert contents(tmp_path / "old") == before
    assert not (tmp_path / "new").exists()
    monkeypatch.undo()
    # what one that was killed left behind goes with the next
    (tmp_path / "old" / saving.UNFINISHED / "recording").mkdir(parents=True)
    saving.save_all(Recordings(recorded, (recorded,) * 2), tmp_path / "old")
    assert contents(tmp_path / "old") == before


def test_a_new_recording_replaces_an_older_one_and_nothing_else(recorded, tmp_path):
    saving.save_all(Recordings(drive(Spiral(), ticks=100), (recorded,) * 2), tmp_path)
    (tmp_path / "notes.txt").write_text("mine")
    saving.save_all(Recordings(recorded, (recorded,)), tmp_path)
    loaded = reading.load_all(tmp_path)
    assert loaded.nominal.run == recorded.run
    assert len(loaded.varied) == 1
    assert (tmp_path / "notes.txt").read_text() == "mine"


def refused(folder):
    with pytest.raises(RecordingError) as error:
        reading.load_all(folder)
    return str(error.value)


def test_what_is_missing_or_something_else_is_no_recording(tmp_path, capsys):
    assert "cannot read the recording" in refused(tmp_path / "nowhere")
    assert "no recording" in refused(tmp_path)
    assert cli.main(["check", str(tmp_path)]) == cli.UNUSABLE
    assert "no recording" in capsys.readouterr().err
    (tmp_path / "turtle_controller.py").write_text("print('hello')")
    assert "no recording" in refused(tmp_path / "turtle_controller.py")


@pytest.mark.parametrize("name", [BAG, "metadata.yaml", RUN, OUTPUT])
def test_a_missing_file_is_named(folder, name):
    (folder / name).unlink()
    assert name in refused(folder)


@pytest.mark.parametrize("name", ["metadata.yaml", RUN, CIRCUMSTANCES])
@pytest.mark.parametrize("content", [b"", b"{}", b"null", b"\xff\xfe", b"[" * 500, b"a: [b"])
def test_garbage_is_an_error_and_no_traceback(folder, name, content):
    (folder / name).write_bytes(content)
    if (name, content) == (CIRCUMSTANCES, b"{}"):
        reading.load(folder)
    else:
        text = refused(folder)
        assert name != "metadata.yaml" or "cannot read the bag" in text


@pytest.mark.parametrize("name", [BAG, "metadata.yaml"])
@pytest.mark.parametrize("part", [0, 0.5, 0.999])
def test_a_truncated_or_changed_bag_is_an_error(folder, name, part):
    whole = (folder / name).read_bytes()
    (folder / name).write_bytes(whole[: int(len(whole) * part)])
    assert str(folder) in refused(folder)
    if name == BAG:  # one bit
        (folder / name).write_bytes(whole[:99] + bytes([whole[99] ^ 1]) + whole[100:])
        assert "damaged: it is cut off or was changed" in refused(folder)


@pytest.mark.parametrize("place", range(0, 100, 11))
def test_a_damaged_bag_whose_digest_fits_is_an_error_or_harmless(folder, place):
    """The digest finds chance damage; what is left must not end in a traceback either."""
    path = folder / BAG
    whole = bytearray(path.read_bytes())
    start = len(whole) * place // 100
    whole[start : start + 9] = b"\xff" * 9
    path.write_bytes(whole)
    change(folder / RUN, bag_sha256=content.of_file(path))
    try:
        reading.load(folder)
    except RecordingError as error:
        assert str(folder) in str(error)


def test_an_unknown_version_scene_or_key_is_named(folder):
    whole = (folder / RUN).read_text()
    for values, words in (
        ({"schema": "turtlesim-grader/recording/v99"}, ["recording/v99", SCHEMA]),
        ({"scene": "moon"}, ["grader.scenes: there is no 'moon'; there are: graph, package, "]),
        ({"run__unheard_of": 1}, ["unheard_of"]),
    ):
        change(folder / RUN, **values)
        text = refused(folder)
        assert all(word in text for word in words) and "__init__" not in text
        (folder / RUN).write_text(whole)


@pytest.mark.parametrize(
    ("name", "values"),
    [
        (RUN, {"run__ticks": "many"}),
        (RUN, {"run__outcome": "splendid"}),
        (RUN, {"run__trace_sha256": "ab" * 32}),
        (RUN, {"run__ticks": 10**9, "run__simulated_s": 16_000_000.0}),
        (RUN, {"run__simulated_s": math.nan}),
        (RUN, {"start": {"x": math.inf, "y": 0.0, "theta": 0.0}}),
        (RUN, {"run": None}),
        (RUN, {"topics": [3]}),
        (RUN, {"bag_sha256": 7}),
        (RUN, {"scene": 3}),
        (CIRCUMSTANCES, {"wall_s": math.nan}),
        (CIRCUMSTANCES, {"provenance": to_json(replace(PROVENANCE, date="today"))}),
        (CIRCUMSTANCES, {"provenance": to_json(replace(PROVENANCE, exercise_sha256="x"))}),
        (CIRCUMSTANCES, {"provenance": to_json(PROVENANCE) | {"more": ""}}),
        *(
            (CIRCUMSTANCES, {"interfaces": wrong})
            for wrong in ([], {"texts": {"mine/msg/Num": 3}}, {"more": {}})
        ),
        ("observations.json", {"spun_s": "soon"}),
        ("package.json", {"others": [1]}),
    ],
)
def test_facts_of_the_wrong_kind_are_an_error(folder, name, values):
    change(folder / name, **values)
    text = refused(folder)
    assert str(folder) in text and "damaged" in text
    assert name in text or name == RUN or "provenance" in values


@pytest.mark.parametrize("name", [BAG, "metadata.yaml", RUN, OUTPUT, CIRCUMSTANCES])
def test_a_pipe_is_not_waited_for_nor_a_link_followed(folder, tmp_path, name):
    (folder / name).rename(tmp_path / "secret")
    os.mkfifo(folder / name)
    assert f"{name} is no part of a recording" in refused(folder)
    (folder / name).unlink()
    (folder / name).symlink_to(tmp_path / "secret")
    assert f"{name} is no part of a recording" in refused(folder)


def test_a_lost_varied_run_is_named(recorded, tmp_path):
    saving.save_all(Recordings(recorded, (recorded, recorded)), tmp_path)
    (tmp_path / "varied_2").rename(tmp_path / "elsewhere")
    assert "varied_2 is missing" in refused(tmp_path)


def foreign_bag(folder, plugin, topic, msgtype, text):
    types = get_typestore(Stores.ROS2_JAZZY)
    with Writer(folder, version=9, storage_plugin=plugin) as writer:
        connection = writer.add_connection(topic, msgtype, typestore=types)
        message = types.types[msgtype](text)
        writer.write(connection, 16_000_000, types.serialize_cdr(message, msgtype))


@pytest.mark.parametrize("plugin", list(StoragePlugin))
def test_somebody_elses_bag_is_no_recording(tmp_path, plugin):
    foreign_bag(tmp_path / "bag", plugin, "/chatter", "std_msgs/msg/String", "hello")
    assert "no recording of the grader" in refused(tmp_path / "bag")


@pytest.mark.parametrize("text", ["hello", "[]", '{"tick": "1", "op": "clear"}'])
def test_a_bag_of_the_right_name_with_other_messages_is_an_error(folder, tmp_path, text):
    other = tmp_path / "other" / "recording"
    foreign_bag(other, StoragePlugin.MCAP, "/turtlesim/events", "std_msgs/msg/String", text)
    for name in (BAG, "metadata.yaml"):
        (other / name).replace(folder / name)
    change(folder / RUN, bag_sha256=content.of_file(folder / BAG))
    assert "holds no recording" in refused(folder)


def test_a_bag_that_unpacks_to_more_than_there_is_room_for_is_refused(
    recorded, tmp_path, monkeypatch
):
    bomb = replace(recorded.trace, logs=(Log(1, "INFO", "bomb", "a" * 2**27),))
    saving.save_all(Recordings(replace(recorded, trace=bomb)), tmp_path)
    assert (tmp_path / BAG).stat().st_size < 2**20
    brief = replace(reading.READING, memory_bytes=2**26)
    monkeypatch.setattr(reading, "READING", brief)
    assert re.search(r"cannot .*read.*[Mm]emory", refused(tmp_path))


def test_a_reader_that_comes_to_no_end_is_told(folder, monkeypatch):
    monkeypatch.setattr(reading, "READING", replace(reading.READING, cpu_s=0.3))

    def read(*_):
        while True:
            pass

    monkeypatch.setattr(bag, "read", read)
    assert "reading it did not come to an end in" in refused(folder)


@pytest.mark.parametrize("name", reading.SIZES)
def test_a_file_that_is_larger_than_any_recording_s_is_not_read(folder, name):
    with (folder / name).open("r+b") as file:
        file.truncate(reading.SIZES[name] + 1)  # a hole: it takes no room
    assert re.search(f"{name} has .* bytes; expected", refused(folder))


PEN = SetPen(tick=5, r=1, g=2, b=3, width=4, off=0)
ROW = [5.5, 5.5, 0.0, 0.0, 0.0, 1, 2, 3]


@pytest.mark.parametrize(
    "changes",
    [
        pytest.param({"events": (replace(PEN, r=256),)}, id="no colour"),
        pytest.param({"events": (replace(PEN, width=-1),)}, id="no width"),
        pytest.param({"events": (replace(PEN, tick=10**6),)}, id="long after the end"),
        pytest.param(
            {"events": (SetParameter(tick=5, name="background_r", value={"a": [1]}),)}, id="object"
        ),
        pytest.param({"events": (RotateAbsolute(tick=5, theta=1.0, id=[[]]),)}, id="id: a list"),
        *(
            {"trajectories": {"turtle1": Trajectory.of_rows(np.array([[a, *ROW], [b, *ROW]]))}}
            for a, b in ((5, 5), (0, 1), (TICKS, TICKS + 1))
        ),
    ],
)
def test_what_cannot_have_come_is_refused(recorded, tmp_path, changes):
    trace = replace(recorded.trace, **changes)
    run = replace(recorded.run, trace_sha256=trace.sha256())
    saving.save_all(Recordings(replace(recorded, trace=trace, run=run)), tmp_path)
    assert ("holds no recording" if "events" in changes else "ticks") in refused(tmp_path)


def test_an_input_that_is_nested_without_measure_is_refused(recorded, tmp_path, monkeypatch):
    deep = "[" * 200_000 + "]" * 200_000
    name = "nest"
    event = SetParameter(tick=5, name=name, value=name)
    trace = replace(recorded.trace, events=(event,))
    real = json.dumps
    monkeypatch.setattr(
        "grader.scenes.turtlesim.messages.json.dumps",
        lambda words, **how: real(words, **how).replace(f'"value": "{name}"', f'"value": {deep}'),
    )
    saving.save_all(Recordings(replace(recorded, trace=trace)), tmp_path)
    monkeypatch.undo()
    refused(tmp_path)


def test_what_was_told_and_found_of_a_package_is_read_back_and_may_be_missing(recorded, folder):
    found = reading.load(folder)
    assert (found.observations, found.package) == (OBSERVATIONS, PACKAGE)
    (folder / "package.json").unlink()
    assert reading.load(folder).package is None
    saving.save_all(Recordings(replace(recorded, observations=Observations())), folder)
    assert not (folder / "observations.json").exists()
    assert reading.load(folder).observations == Observations()
