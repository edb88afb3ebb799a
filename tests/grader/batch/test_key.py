"""Equal content has an equal key, whatever an export has called it."""

from pathlib import Path

import pytest

from grader.batch import key
from grader.exercise.loading import load_exercise
from tests.files import lay_too_deep


def folder(at: Path, source: str, *junk: str) -> Path:
    (at / "pkg").mkdir(parents=True)
    (at / "pkg" / "node.py").write_text(source)
    for name in junk:
        (at / name).mkdir()
        (at / name / "file").write_text(str(at))
    return at


def test_what_git_and_python_leave_beside_does_not_count(tmp_path: Path) -> None:
    plain = folder(tmp_path / "alice", "x = 1\n")
    clone = folder(tmp_path / "bob", "x = 1\n", ".git", "__pycache__")
    assert key.of_hand_in(plain, "") == key.of_hand_in(clone, "")


def test_one_letter_makes_another_key(tmp_path: Path) -> None:
    one, other = folder(tmp_path / "a", "x = 1\n"), folder(tmp_path / "b", "x = 2\n")
    assert key.of_hand_in(one, "") != key.of_hand_in(other, "")


def test_a_file_that_an_export_renamed_counts_by_the_name_that_it_had(tmp_path: Path) -> None:
    renamed, plain = tmp_path / "mueller_123_456_node.py", tmp_path / "node.py"
    for path in (renamed, plain):
        path.write_text("x = 1\n")
    assert key.of_hand_in(renamed, "node.py") == key.of_hand_in(plain, "")
    assert key.of_hand_in(renamed, "") != key.of_hand_in(plain, "")


def test_a_pipe_is_not_waited_for(tmp_path: Path) -> None:
    import os

    top = folder(tmp_path / "alice", "x = 1\n")
    if not hasattr(os, "mkfifo"):
        pytest.skip("no pipes with names")
    os.mkfifo(top / "pipe")
    assert key.of_hand_in(top, "") == key.of_hand_in(folder(tmp_path / "bob", "x = 1\n"), "")


def test_what_is_too_deep_for_a_run_is_too_deep_for_a_key(tmp_path: Path) -> None:
    alice, bob = (folder(tmp_path / name, "x = 1\n") for name in ("alice", "bob"))
    for top in (alice, bob):
        lay_too_deep(top)
    assert key.of_hand_in(alice, "") == key.of_hand_in(bob, "")
    (bob / "pkg" / "node.py").write_text("x = 2\n")
    assert key.of_hand_in(alice, "") != key.of_hand_in(bob, "")


def test_what_a_run_depends_on_is_in_its_key_and_the_rubric_is_not(tmp_path: Path) -> None:
    challenge = load_exercise("turtlesim_challenge")
    (tmp_path / "points.yaml").write_text("exercise: turtlesim_challenge\npoints: {moves: 6}\n")
    (tmp_path / "time.yaml").write_text("exercise: turtlesim_challenge\nlimits: {total_s: 99}\n")
    mine = key.of_run("ab", challenge, "virtual", None)
    assert key.of_run("ab", load_exercise(tmp_path / "points.yaml"), "virtual", None) == mine
    others = {
        key.of_run("ab", load_exercise(tmp_path / "time.yaml"), "virtual", None),
        key.of_run("ac", challenge, "virtual", None),
        key.of_run("ab", challenge, "real", None),
        key.of_run("ab", challenge, "virtual", 7),
    }
    assert len(others | {mine}) == 5
