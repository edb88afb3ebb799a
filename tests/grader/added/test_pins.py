"""Added exercises lie in the user's data folder: whole, and as they were added, or not used."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from grader.added import pins
from grader.added.pins import FILES, PIN, Origin, Pin
from grader.errors import ExerciseError, UsageError

ORIGIN = Origin("https://example.org/x", "v1", "a", "1" * 40, "2" * 64)


@pytest.fixture(autouse=True)
def home(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "data"))
    return tmp_path / "data" / "turtlesim-grader" / "exercises"


def put(name, text="x"):
    with pins.unfinished() as place:
        (place / FILES / "file").write_text(text)
        pins.write(place, Pin(name, ORIGIN))
        pins.put(place, name)


def test_the_folder_follows_the_rules_of_xdg(home, monkeypatch, tmp_path):
    assert pins.home() == home
    monkeypatch.setenv("XDG_DATA_HOME", "relative")
    monkeypatch.setenv("HOME", str(tmp_path))
    assert pins.home() == tmp_path / ".local/share/turtlesim-grader/exercises"


def test_what_is_put_is_there_with_its_pin_and_can_be_dropped(home):
    assert pins.names() == []
    assert pins.folder_of("one") is None
    put("one")
    put("one", "y")
    folder = pins.folder_of("one")
    assert (folder / "file").read_text() == "y"
    assert pins.around(folder) == Pin("one", ORIGIN)
    assert pins.names() == [each.name for each in home.iterdir()] == ["one"]
    assert str(ORIGIN) == "https://example.org/x@v1#a"
    pins.drop("one")
    assert pins.names() == []


@pytest.mark.parametrize("name", ["", ".", "..", ".x", "a/b", "/a"])
def test_no_name_leads_out_of_the_folder(name):
    assert pins.folder_of(name) is None


def test_a_call_that_was_cut_off_leaves_the_older_one(home):
    put("one")
    (home / "one").rename(home / ".older-one")
    (home / ".rest").mkdir()
    with pytest.raises(UsageError), pins.unfinished(), pins.unfinished():
        pass  # another call adds, too
    assert [each.name for each in home.iterdir()] == ["one"]


def test_a_copy_of_an_added_exercise_is_one_wherever_it_lies(tmp_path):
    put("one")
    copy = shutil.copytree(pins.folder_of("one").parent, tmp_path / "copy") / FILES
    assert pins.around(copy) == Pin("one", ORIGIN)
    (tmp_path / "link").symlink_to(copy)
    assert pins.around(tmp_path / "link") == Pin("one", ORIGIN)
    assert pins.around(tmp_path) is None


@pytest.mark.parametrize("text", ["", "[]", '{"name": "one"}', "[" * 100_000, "x" * 30_000])
def test_a_damaged_pin_is_told(text):
    put("one")
    folder = pins.folder_of("one")
    (folder.parent / PIN).write_text(text)
    with pytest.raises(ExerciseError, match="damaged"):
        pins.around(folder)


def test_files_that_were_changed_are_refused(tmp_path):
    from grader import content

    Path(tmp_path / "one").mkdir()
    (tmp_path / "one" / "file").write_text("x")
    pin = Pin("one", Origin("a", "", "", "1" * 40, content.of_folder(tmp_path / "one")))
    pin.check(tmp_path / "one")
    (tmp_path / "one" / "more").touch()
    with pytest.raises(ExerciseError, match="grader exercises update one"):
        pin.check(tmp_path / "one")
