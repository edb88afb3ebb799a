"""Our own folders and locks are made safely, whatever lies in their places."""

import os
import socket
import stat
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from grader.errors import GraderFailure
from grader.run.processes import cores, network
from grader.system import scratch
from tests.children import NOBODYS_UID
from tests.needs import needs


@pytest.fixture
def place(tmp_path, monkeypatch):
    """Where the folder of this user's runs would be; nothing is there."""
    (tmp_path / "tmp").mkdir()
    (tmp_path / "runtime").mkdir(mode=0o700)
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "tmp"))
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path / "runtime"))
    monkeypatch.setenv("HOME", str(tmp_path / "user"))
    return scratch.home_below(tmp_path / "tmp")


def pipe(path: Path) -> None:
    os.mkfifo(path)


def link(path: Path) -> None:
    target = path.parent.parent / "precious"
    target.write_text("precious")
    path.symlink_to(target)


def dangling_link(path: Path) -> None:
    path.symlink_to(path.parent.parent / "made by the grader")


def folder(path: Path) -> None:
    (path / "in").mkdir(parents=True)


def a_socket(path: Path) -> None:
    folder = os.open(path.parent, os.O_RDONLY)  # a path may have 107 bytes
    with socket.socket(socket.AF_UNIX) as server:
        server.bind(f"/proc/self/fd/{folder}/{path.name}")
    os.close(folder)


def forbidden_file(path: Path) -> None:
    path.touch(0)


def another_s_file(path: Path) -> None:
    path.touch()
    os.chown(path, NOBODYS_UID, NOBODYS_UID)


def another_s_folder(path: Path) -> None:
    path.mkdir()
    os.chown(path, NOBODYS_UID, NOBODYS_UID)


def by_root(lay: Callable[[Path], None]) -> Any:
    return pytest.param(lay, marks=needs("root"))


FOREIGN = [pipe, link, dangling_link, a_socket, forbidden_file, by_root(another_s_file)]


@pytest.mark.parametrize("lay", [*FOREIGN, folder])
def test_what_lies_where_locks_are_looked_for_stops_nobody(place, lay):
    home = scratch.home()
    names = [f"domain-{number}" for number in network.DOMAINS]
    names += [f"core-{number}" for number in cores.available()]
    for name in (*names, "run-123456789012", "run-"):
        lay(home / f"{name}.lock")
    with network.reserve_domain() as first, network.reserve_domain() as second:
        assert first != second
    with cores.reserve_core(0) as core:
        assert core in cores.available()
    with scratch.make_folder() as made:
        assert made.parent == home
        assert [path.name for path in home.glob("run-*") if path.is_dir()] == [made.name]
    assert list(home.glob("run-*")) == []
    assert not list(place.parent.parent.rglob("made by the grader"))
    for path in place.parent.parent.rglob("precious"):
        assert path.read_text() == "precious"


def test_a_lock_is_an_ordinary_file_that_nobody_else_reads(place):
    with network.reserve_domain() as number:
        found = (scratch.home() / f"domain-{number}.lock").lstat()
    assert stat.S_ISREG(found.st_mode)
    assert stat.S_IMODE(found.st_mode) == 0o600


@pytest.mark.parametrize("lay", [*FOREIGN, by_root(another_s_folder)])
def test_what_lies_where_the_folder_would_be_is_gone_round_and_left_alone(place, lay):
    lay(place)
    before = place.lstat()
    assert scratch.home() == Path(os.environ["XDG_RUNTIME_DIR"]) / "turtlesim-grader"
    assert scratch.home().stat().st_mode & 0o777 == 0o700
    with scratch.make_folder(), network.reserve_domain(), cores.reserve_core(0):
        pass
    assert place.lstat().st_mode == before.st_mode
    assert not (place.parent.parent / "made by the grader").exists()


def test_a_folder_of_ours_is_closed_to_others_and_a_link_to_one_is_not_followed(place, tmp_path):
    place.mkdir()
    place.chmod(0o777)
    assert scratch.home() == place
    assert stat.S_IMODE(place.stat().st_mode) == 0o700
    place.rename(tmp_path / "mine")
    place.symlink_to(tmp_path / "mine")
    with scratch.make_folder():
        assert list((tmp_path / "mine").iterdir()) == []


def test_where_no_place_is_left_it_says_which_whose_and_what_to_do(place, tmp_path, monkeypatch):
    pipe(place)
    monkeypatch.delenv("XDG_RUNTIME_DIR")
    (tmp_path / "user").touch()
    with pytest.raises(GraderFailure) as error, scratch.make_folder():
        pass
    assert f"{place}: it is no folder, and belongs to " in str(error.value)
    assert f"{tmp_path}/user/.cache/turtlesim-grader: Not a directory" in str(error.value)
    assert "set TMPDIR" in str(error.value)


def test_what_a_run_that_was_killed_leaves_goes_with_the_next_whatever_it_is(place):
    outside = place.parent / "outside"
    outside.mkdir()
    home = scratch.home()
    for name in ("run-1", "run-2"):
        (home / name / "closed").mkdir(parents=True)
        (home / name / "out").symlink_to(outside)
        pipe(home / name / "pipe")
        (home / name / "closed").chmod(0)
    (home / "run-1.lock").touch()  # of the other somebody has removed the lock
    (home / "run-3").symlink_to(outside)
    with scratch.make_folder():
        pass
    assert list(home.iterdir()) == []
    assert outside.is_dir()


def test_a_folder_of_ours_goes_and_nothing_that_is_in_use(place):
    with scratch.make_folder() as made:
        (made / "a" / "b").mkdir(parents=True)
        (made / "a").chmod(0)
    assert list(place.iterdir()) == []
    (scratch.home() / "run-dead" / "tmp").mkdir(parents=True)
    (scratch.home() / "run-dead.lock").touch()
    with scratch.make_folder() as first, scratch.make_folder() as second:
        names = {path.name for path in scratch.home().iterdir() if path.is_dir()}
        assert names == {first.name, second.name}
    assert list(scratch.home().iterdir()) == []


def test_a_lock_has_one_holder_until_he_closes_it(tmp_path):
    path = tmp_path / "lock"
    with path.open("w") as first:
        assert scratch.lock_file(first)
        with path.open("w") as second:
            assert not scratch.lock_file(second)
    with path.open("w") as third:
        assert scratch.lock_file(third)


@pytest.fixture
def locked(monkeypatch):
    """The locks that were asked for: another one, who looks round just then, removes the first."""
    names: list[str] = []
    lock_file = scratch.lock_file

    def lock_late(file):  # type: ignore[no-untyped-def]
        if not names or names[0] == "each":
            Path(file.name).unlink()
        names.append(file.name)
        return lock_file(file)

    monkeypatch.setattr(scratch, "lock_file", lock_late)
    return names


def test_a_lock_that_another_has_taken_for_a_leftover_is_not_used(place, locked):
    with scratch.make_folder() as folder:
        assert folder.is_dir()
        assert Path(locked[1]).stem == folder.name


def test_a_lock_that_is_always_moved_away_is_not_held(place, locked):
    locked.append("each")
    assert scratch.acquire_lock("core-0") is None
    with pytest.raises(GraderFailure, match="removes the locks"), scratch.make_folder():
        pass
