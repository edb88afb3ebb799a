"""A lock has one holder, wherever it is."""

import sys
import types
from pathlib import Path

import pytest

from grader import locks, scratch


@pytest.fixture(params=["fcntl", "msvcrt"])
def locking(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> str:
    """Both kinds; msvcrt's is imitated with what is here."""
    if request.param == "msvcrt":
        import fcntl

        def lock(file: int, mode: int, count: int) -> None:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)

        module = types.ModuleType("msvcrt")
        vars(module).update(locking=lock, LK_NBLCK=2)
        monkeypatch.setitem(sys.modules, "msvcrt", module)
        monkeypatch.setattr(locks, "fcntl", None)
    return str(request.param)


def test_a_lock_has_one_holder_until_he_closes_it(locking: str, tmp_path: Path) -> None:
    path = tmp_path / "lock"
    with path.open("w") as first:
        assert locks.take(first)
        with path.open("w") as second:
            assert not locks.take(second)
    with path.open("w") as third:
        assert locks.take(third)


@pytest.fixture
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(scratch, "home", lambda: tmp_path)
    return tmp_path


def test_a_folder_leaves_nothing(locking: str, home: Path) -> None:
    with scratch.make_folder() as folder:
        (folder / "file").write_text("text")
    assert list(home.iterdir()) == []


def test_what_a_killed_grader_left_is_cleared_and_what_is_in_use_is_not(
    locking: str, home: Path
) -> None:
    (home / "run-dead" / "tmp").mkdir(parents=True)
    (home / "run-dead.lock").touch()
    with scratch.make_folder() as first, scratch.make_folder() as second:
        names = {path.name for path in home.iterdir() if path.is_dir()}
        assert names == {first.name, second.name}
    assert list(home.iterdir()) == []


def test_a_lock_that_another_has_taken_for_a_leftover_is_not_used(
    locking: str, home: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """He looked round between two steps of ours, and has removed it."""
    taken: list[str] = []
    take = locks.take

    def take_late(file):  # type: ignore[no-untyped-def]
        taken.append(file.name)
        if len(taken) == 1:
            Path(file.name).unlink()
        return take(file)

    monkeypatch.setattr(locks, "take", take_late)
    with scratch.make_folder() as folder:
        assert folder.is_dir()
        assert Path(taken[1]).stem == folder.name
