"""The folder of a recording: the same bytes every time, whole or refused with a clear text."""

from __future__ import annotations

import json
import os
import shutil
import sqlite3
from dataclasses import replace
from pathlib import Path

import pytest
import yaml
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

from grader import cli, content
from grader.errors import RecordingError
from grader.inspection.trace import PackageTrace
from grader.message import msg
from grader.recording import bag, reading, saving
from grader.recording.observations import End, Observations, SourceLine, Standstill
from grader.recording.recording import OwnInterfaces, Provenance, Recording, Recordings
from grader.recording.saving import BAG, CIRCUMSTANCES_FILE, FILES, OUTPUT, RUN, SCHEMA
from grader.scenes.turtlesim.trace import Log
from grader.strict_json import to_json
from tests.grader.driving import Spiral, drive
from turtlesim_py.world.events import RotateAbsolute, SetParameter, SetPen
from turtlesim_py.world.trajectory import Trajectory

TICKS = 200
CIRCUMSTANCES = "circumstances.json"
OBSERVATIONS = Observations(
    is_known=True,
    ends=(End("publisher", "/pose", "turtlesim/msg/Pose", False, 3, SourceLine("a.py", 7)),),
    stop=Standstill(
        "callback", 1.5, "Client.call", SourceLine("a.py", 9, "on_pose", "self.pen.call(red)")
    ),
)
PACKAGE = PackageTrace(others=("beside",))


@pytest.fixture(scope="module")
def recorded() -> Recording:
    return replace(drive(Spiral(), ticks=TICKS), observations=OBSERVATIONS, package=PACKAGE)


@pytest.fixture(scope="module")
def saved(recorded, tmp_path_factory) -> Path:
    """As `save` has left it; not to be changed."""
    folder = tmp_path_factory.mktemp("saved") / "recording"
    saving.save_all(Recordings(recorded), folder)
    return folder


@pytest.fixture
def folder(saved, tmp_path) -> Path:
    return shutil.copytree(saved, tmp_path / "recording")


def contents(folder: Path) -> dict[str, bytes]:
    files = (path for path in folder.rglob("*") if path.is_file())
    return {str(path.relative_to(folder)): path.read_bytes() for path in files}


def change(path: Path, **values) -> None:
    """Change what stands at the top of a JSON file; `run__ticks` is `ticks` in `run`."""
    data = json.loads(path.read_text())
    for key, value in values.items():
        *parents, last = key.split("__")
        place = data
        for parent in parents:
            place = place[parent]
        place[last] = value
    path.write_text(json.dumps(data))


# The same bytes -------------------------------------------------------------------------------


def test_two_saves_of_a_recording_are_the_same_byte_for_byte(recorded, tmp_path):
    for name in ("one", "two"):
        saving.save_all(Recordings(recorded, (recorded,)), tmp_path / name)
    assert contents(tmp_path / "one") == contents(tmp_path / "two")


def test_equal_runs_make_equal_files(recorded, folder, tmp_path):
    again = replace(drive(Spiral(), ticks=TICKS), observations=OBSERVATIONS, package=PACKAGE)
    saving.save_all(Recordings(again), tmp_path / "again")
    assert contents(tmp_path / "again") == contents(folder)


def test_a_loaded_recording_saves_as_the_same_files(folder, tmp_path):
    saving.save_all(Recordings(reading.load(folder)), tmp_path / "again")
    assert contents(tmp_path / "again") == contents(folder)


def test_what_differs_between_equal_runs_stands_apart(recorded, folder, tmp_path):
    other = replace(recorded, run=replace(recorded.run, wall_s=12.5, isolation="ROS domain 77"))
    saving.save_all(Recordings(other), tmp_path / "other")
    ours, theirs = contents(folder), contents(tmp_path / "other")
    assert {name for name in ours if ours[name] != theirs[name]} == {CIRCUMSTANCES}
    assert reading.load(tmp_path / "other").run == other.run


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


def test_where_it_comes_from_is_a_circumstance_and_comes_back(recorded, folder, tmp_path):
    saving.save_all(Recordings(replace(recorded, provenance=PROVENANCE)), tmp_path / "other")
    ours, theirs = contents(folder), contents(tmp_path / "other")
    assert {name for name in ours if ours[name] != theirs[name]} == {CIRCUMSTANCES}
    assert reading.load(tmp_path / "other").provenance == PROVENANCE
    assert reading.load(folder).provenance is None


@pytest.mark.parametrize(
    "change", [{"date": "today"}, {"grader": 1}, {"more": ""}, {"exercise_sha256": "x"}]
)
def test_a_damaged_origin_is_refused(recorded, folder, change):
    (folder / CIRCUMSTANCES).write_text(json.dumps({"provenance": to_json(PROVENANCE) | change}))
    assert "provenance" in refused(folder)


def test_a_recording_can_do_without_its_circumstances(recorded, folder):
    (folder / CIRCUMSTANCES).unlink()
    assert reading.load(folder).run == recorded.run


def test_pictures_and_scenario_are_copies_that_nobody_reads(recorded, folder):
    for name in ("path.png", "window.png", "scenario.json"):
        (folder / name).unlink()
    assert (reading.load(folder).trace.canvas == recorded.trace.canvas).all()


# Whole or not at all --------------------------------------------------------------------------


def test_the_metadata_comes_last(recorded, folder, monkeypatch):
    rename, moved = Path.replace, []
    monkeypatch.setattr(Path, "replace", lambda a, b: moved.append(b.name) or rename(a, b))
    saving.save_all(Recordings(recorded), folder)
    assert moved[-1] == "metadata.yaml"


# a turtle's window is its plan
@pytest.mark.parametrize("stop_at", FILES)
def test_a_save_that_is_cut_off_leaves_no_recording(recorded, tmp_path, monkeypatch, stop_at):
    rename = Path.replace

    def cut_off(source: Path, target: Path) -> Path:
        if target == tmp_path / stop_at:
            raise OSError("no space left on device")
        return rename(source, target)

    monkeypatch.setattr(Path, "replace", cut_off)
    with pytest.raises(OSError, match="no space left"):
        saving.save_all(Recordings(recorded, (recorded,)), tmp_path)
    with pytest.raises(RecordingError):
        reading.load_all(tmp_path)
    assert not (tmp_path / saving.UNFINISHED).exists()


def test_an_older_recording_stays_whole_until_the_new_one_is_written(recorded, folder, monkeypatch):
    before = contents(folder)

    def disk_full(*_):
        raise OSError("no space left on device")

    monkeypatch.setattr(bag, "write", disk_full)
    with pytest.raises(OSError, match="no space left"):
        saving.save_all(Recordings(recorded), folder)
    assert contents(folder) == before


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


def test_what_a_killed_save_left_behind_goes_with_the_next(recorded, folder):
    before = contents(folder)
    (folder / saving.UNFINISHED / "recording").mkdir(parents=True)
    (folder / saving.UNFINISHED / "recording" / "metadata.yaml").write_text("half of it")
    saving.save_all(Recordings(recorded), folder)
    assert contents(folder) == before


def test_a_new_recording_replaces_an_older_one_and_nothing_else(recorded, tmp_path):
    saving.save_all(Recordings(drive(Spiral(), ticks=100), (recorded,) * 3), tmp_path)
    (tmp_path / "notes.txt").write_text("mine")
    saving.save_all(Recordings(recorded, (recorded,)), tmp_path)
    loaded = reading.load_all(tmp_path)
    assert loaded.nominal.run == recorded.run
    assert len(loaded.varied) == 1
    assert (tmp_path / "notes.txt").read_text() == "mine"


# Damaged and foreign input --------------------------------------------------------------------


def refused(folder: Path) -> str:
    """The text of the error, which the command line prints with exit code 2."""
    with pytest.raises(RecordingError) as error:
        reading.load_all(folder)
    assert cli.main(["check", str(folder)]) == cli.UNUSABLE
    return str(error.value)


def test_a_missing_recording_is_named(tmp_path):
    assert "cannot read the recording" in refused(tmp_path / "nowhere")


def test_a_folder_of_something_else_is_no_recording(tmp_path):
    assert "no recording" in refused(tmp_path)
    (tmp_path / "turtle_controller.py").write_text("print('hello')")
    assert "no recording" in refused(tmp_path / "turtle_controller.py")


@pytest.mark.parametrize("name", ["recording.mcap", "metadata.yaml", "run.json", "output.txt"])
def test_a_missing_file_is_named(folder, name):
    (folder / name).unlink()
    assert name in refused(folder)


@pytest.mark.parametrize("name", ["metadata.yaml", "run.json", CIRCUMSTANCES])
@pytest.mark.parametrize(
    "content",
    [b"", b"{", b"[]", b"{}", b"null", b"3", b"\xff\xfe", b"[" * 500, b"a: [b", b"\x00" * 99],
)
def test_garbage_is_an_error_and_no_traceback(folder, name, content):
    (folder / name).write_bytes(content)
    if (name, content) == (CIRCUMSTANCES, b"{}"):
        reading.load(folder)
    else:
        refused(folder)


@pytest.mark.parametrize("name", ["recording.mcap", "metadata.yaml"])
@pytest.mark.parametrize("part", [0, 0.001, 0.5, 0.999])
def test_a_truncated_bag_is_an_error(folder, name, part):
    whole = (folder / name).read_bytes()
    (folder / name).write_bytes(whole[: int(len(whole) * part)])
    assert str(folder) in refused(folder)


def test_one_changed_bit_in_the_bag_is_an_error(folder):
    whole = bytearray((folder / "recording.mcap").read_bytes())
    whole[len(whole) // 3] ^= 1
    (folder / "recording.mcap").write_bytes(whole)
    assert "damaged: it is cut off or was changed" in refused(folder)


@pytest.mark.parametrize("place", range(0, 100, 3))
def test_a_damaged_bag_whose_digest_fits_is_an_error_or_harmless(folder, place):
    """The digest finds chance damage; what is left must not end in a traceback either."""
    path = folder / "recording.mcap"
    whole = bytearray(path.read_bytes())
    start = len(whole) * place // 100
    whole[start : start + 9] = b"\xff" * 9
    path.write_bytes(whole)
    change(folder / "run.json", bag_sha256=content.of_file(path))
    try:
        reading.load(folder)
    except RecordingError as error:
        assert str(folder) in str(error)


def test_the_version_is_checked(folder):
    change(folder / "run.json", schema="turtlesim-grader/recording/v99")
    text = refused(folder)
    assert "recording/v99" in text
    assert SCHEMA in text


@pytest.mark.parametrize(
    "values",
    [
        {"run__ticks": "many"},
        {"run__outcome": "splendid"},
        {"run__flags": "odd"},
        {"run__unheard_of": 1},
        {"run__trace_sha256": "ab" * 32},
        {"run__ticks": 10**9},
        {"run__ticks": 10**9, "run__simulated_s": 16_000_000.0},
        {"run__simulated_s": float("nan")},
        {"start": {"x": float("inf"), "y": 0.0, "theta": 0.0}},
        {"run": None},
        {"start": {"x": 1.0}},
        {"topics": [3]},
        {"bag_sha256": 7},
        {"scene": 3},
    ],
)
def test_facts_of_the_wrong_kind_are_an_error(folder, values):
    change(folder / "run.json", **values)
    assert "damaged" in refused(folder)


@pytest.mark.parametrize("wall_s", ["NaN", "-Infinity", "1e999"])
def test_a_number_that_is_none_is_an_error(folder, wall_s):
    (folder / CIRCUMSTANCES).write_text(f'{{"wall_s": {wall_s}}}')
    assert f"{CIRCUMSTANCES} is damaged" in refused(folder)


def test_an_unknown_key_is_named(folder):
    change(folder / "run.json", run__unheard_of=1)
    text = refused(folder)
    assert "unheard_of" in text
    assert "__init__" not in text


@pytest.mark.parametrize(
    "name", ["recording.mcap", "metadata.yaml", "run.json", "output.txt", CIRCUMSTANCES]
)
def test_a_pipe_is_refused_and_not_waited_for(folder, name):
    (folder / name).unlink()
    os.mkfifo(folder / name)
    assert f"{name} is damaged: it is no ordinary file" in refused(folder)


def test_a_scene_that_is_not_known_is_named(folder):
    change(folder / "run.json", scene="moon")
    assert "grader.scenes: there is no 'moon'; there are: graph, package, " in refused(folder)


def test_the_usual_scene_may_be_named(recorded, folder):
    change(folder / "run.json", scene="turtlesim")
    assert reading.load(folder).scene == recorded.scene == "turtlesim"


def test_a_lost_varied_run_is_named(recorded, tmp_path):
    saving.save_all(Recordings(recorded, (recorded, recorded)), tmp_path)
    (tmp_path / "varied_2").rename(tmp_path / "elsewhere")
    assert "varied_2 is missing" in refused(tmp_path)


def foreign_bag(folder: Path, plugin: StoragePlugin, topic: str, msgtype: str, text: str) -> None:
    types = get_typestore(Stores.ROS2_JAZZY)
    with Writer(folder, version=9, storage_plugin=plugin) as writer:
        connection = writer.add_connection(topic, msgtype, typestore=types)
        message = types.types[msgtype](text)
        writer.write(connection, 16_000_000, types.serialize_cdr(message, msgtype))


@pytest.mark.parametrize("plugin", list(StoragePlugin))
def test_somebody_elses_bag_is_no_recording(tmp_path, plugin):
    foreign_bag(tmp_path / "bag", plugin, "/chatter", "std_msgs/msg/String", "hello")
    assert "a rosbag, but no recording of the grader" in refused(tmp_path / "bag")


@pytest.mark.parametrize("text", ["hello", "[]", "3", "{}", '{"tick": "1", "op": "clear"}'])
def test_a_bag_of_the_right_name_with_other_messages_is_an_error(folder, tmp_path, text):
    other = tmp_path / "other" / "recording"
    foreign_bag(other, StoragePlugin.MCAP, "/turtlesim/events", "std_msgs/msg/String", text)
    for name in ("recording.mcap", "metadata.yaml"):
        (other / name).replace(folder / name)
    change(folder / "run.json", bag_sha256=content.of_file(folder / "recording.mcap"))
    assert "holds no recording" in refused(folder)


def test_a_bag_converted_to_sqlite3_is_an_error(folder):
    with sqlite3.connect(folder / "recording.db3") as database:
        database.execute("create table messages (id integer)")
    database.close()
    metadata = yaml.safe_load((folder / "metadata.yaml").read_text())
    info = metadata["rosbag2_bagfile_information"]
    info.update(storage_identifier="sqlite3", relative_file_paths=["recording.db3"])
    (folder / "metadata.yaml").write_text(yaml.safe_dump(metadata))
    assert "cannot read the bag" in refused(folder)


# From anywhere --------------------------------------------------------------------------------


def test_a_bag_that_unpacks_to_more_than_there_is_room_for_is_refused(
    recorded, tmp_path, monkeypatch
):
    bomb = replace(recorded.trace, logs=(Log(1, "INFO", "bomb", "a" * 2**27),))
    saving.save_all(Recordings(replace(recorded, trace=bomb)), tmp_path)
    assert (tmp_path / BAG).stat().st_size < 2**20
    brief = replace(reading.READING, memory_bytes=2**26)
    monkeypatch.setattr(reading, "READING", brief)
    with pytest.raises(RecordingError, match=r"cannot .*read.*[Mm]emory"):
        reading.load(tmp_path)


def test_a_reader_that_comes_to_no_end_is_told(folder, monkeypatch):
    monkeypatch.setattr(reading, "READING", replace(reading.READING, cpu_s=0.3))

    def read(*_):
        while True:
            pass

    monkeypatch.setattr(bag, "read", read)
    with pytest.raises(RecordingError, match="reading it did not come to an end in"):
        reading.load(folder)


@pytest.mark.parametrize("name", reading.SIZES)
def test_a_file_that_is_larger_than_any_recording_s_is_not_read(folder, name):
    with (folder / name).open("r+b") as file:
        file.truncate(reading.SIZES[name] + 1)  # a hole: it takes no room
    with pytest.raises(RecordingError, match=f"{name} has .* bytes; expected"):
        reading.load(folder)


@pytest.mark.parametrize("name", [OUTPUT, RUN, CIRCUMSTANCES_FILE])
def test_a_file_that_leads_out_of_the_recording_is_not_read(folder, tmp_path, name):
    secret = tmp_path / "secret"
    secret.write_bytes((folder / name).read_bytes())
    (folder / name).unlink()
    (folder / name).symlink_to(secret)
    with pytest.raises(RecordingError, match="it leads somewhere else"):
        reading.load(folder)


def pen_of(**values):
    return SetPen(**{"tick": 5, "r": 1, "g": 2, "b": 3, "width": 4, "off": 0, **values})


HOSTILE = {
    "a colour that is none": pen_of(r=256),
    "a width that is none": pen_of(width=-1),
    "long after the end": pen_of(tick=10**6),
    "a value that is an object": SetParameter(tick=5, name="background_r", value={"a": [1]}),
    "an id that is a list": RotateAbsolute(tick=5, theta=1.0, id=[[]]),
}


@pytest.mark.parametrize("event", HOSTILE.values(), ids=HOSTILE.keys())
def test_an_input_that_cannot_have_come_is_refused(recorded, tmp_path, event):
    trace = replace(recorded.trace, events=(*recorded.trace.events, event))
    run = replace(recorded.run, trace_sha256=trace.sha256())
    saving.save_all(Recordings(replace(recorded, trace=trace, run=run)), tmp_path)
    with pytest.raises(RecordingError, match="holds no recording"):
        reading.load(tmp_path)


@pytest.mark.parametrize("ticks", [(5, 5), (0, 1), (TICKS, TICKS + 1)])
def test_a_way_with_impossible_ticks_is_refused(recorded, tmp_path, ticks):
    rows = recorded.trace.trajectory().rows()[:2]
    rows[:, 0] = ticks
    trace = replace(recorded.trace, trajectories={"turtle1": Trajectory.of_rows(rows)})
    run = replace(recorded.run, trace_sha256=trace.sha256())
    saving.save_all(Recordings(replace(recorded, trace=trace, run=run)), tmp_path)
    with pytest.raises(RecordingError, match="ticks"):
        reading.load(tmp_path)


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
    with pytest.raises(RecordingError):
        reading.load(tmp_path)


# What the process told of itself --------------------------------------------------------------


def test_what_the_process_told_comes_back(folder):
    assert reading.load(folder).observations == OBSERVATIONS


def test_a_recording_of_which_nothing_was_told_has_no_file_for_it(recorded, folder):
    saving.save_all(Recordings(replace(recorded, observations=Observations())), folder)
    assert not (folder / "observations.json").exists()
    assert reading.load(folder).observations == Observations()


def test_what_was_found_of_a_package_is_read_back_and_nothing_else_taken_for_it(folder):
    assert reading.load(folder).package == PACKAGE
    change(folder / "package.json", others=[1])
    with pytest.raises(RecordingError, match=r"package\.json is damaged"):
        reading.load(folder)
    (folder / "package.json").unlink()
    assert reading.load(folder).package is None


def test_observations_of_another_form_are_refused_by_name(folder):
    change(folder / "observations.json", spun_s="soon")
    damage = r"observations\.json is damaged: spun_s: expected a number, found 'soon'"
    with pytest.raises(RecordingError, match=damage):
        reading.load(folder)


INTERFACES = OwnInterfaces(
    {"mine/msg/Num": "int8 num\n"},
    {"mine/msg/Nums": msg("{file} is missing", file="Nums.msg")},
    {"mine/msg/Num": msg("Num.msg has other fields")},
)


def test_the_interfaces_of_a_submission_are_a_circumstance_and_come_back(recorded, tmp_path):
    saving.save_all(Recordings(replace(recorded, interfaces=INTERFACES)), tmp_path)
    assert reading.load(tmp_path).interfaces == INTERFACES


@pytest.mark.parametrize("wrong", [[], {"texts": {"mine/msg/Num": 3}}, {"more": {}}])
def test_interfaces_of_another_form_are_refused_by_name(folder, wrong):
    path = folder / CIRCUMSTANCES
    path.write_text(json.dumps(json.loads(path.read_text()) | {"interfaces": wrong}))
    with pytest.raises(RecordingError, match=r"circumstances\.json is damaged"):
        reading.load(folder)
