"""What is in its place is whole; what was not finished goes."""

from pathlib import Path

import pytest

from grader.batch import store
from grader.batch.store import RECORDING, RUN, STUDENTS, Store
from grader.errors import UsageError
from grader.exercise.loading import load_exercise
from tests.files import lay_too_deep


def made(store: Store, text: str, *names: str) -> Path:
    place = store.new_place()
    (place / RUN / RECORDING).mkdir(parents=True)
    (place / RUN / RECORDING / "bag").write_text(text)
    for name in names:
        (place / STUDENTS / name).mkdir(parents=True)
        (place / STUDENTS / name / "entry.json").write_text(text)
    return place


def test_a_run_and_all_who_share_it_come_to_their_places(tmp_path: Path) -> None:
    with Store.opened(tmp_path / "class") as store:
        store.put("abcd", made(store, "one", "alice", "bob"))
        (store.out / "class.json").touch()
        assert store.has("abcd")
        assert (store.student("bob") / RECORDING / "bag").read_text() == "one"
    assert sorted(path.name for path in (tmp_path / "class").iterdir()) == [
        *("class.json", "store", "submissions")
    ]


def test_a_later_grading_takes_the_place_of_an_earlier_one(tmp_path: Path) -> None:
    with Store.opened(tmp_path) as store:
        for text in ("one", "two"):
            store.put("abcd", made(store, text, "alice"))
        assert (store.run("abcd") / RECORDING / "bag").read_text() == "two"
        assert (store.student("alice") / RECORDING / "bag").read_text() == "two"


def test_what_an_interrupted_call_left_is_gone_with_the_next(tmp_path: Path) -> None:
    leftover = tmp_path / ".unfinished" / "x" / "students" / "alice"
    leftover.mkdir(parents=True)
    with Store.opened(tmp_path) as store:
        assert not leftover.exists()
        assert not store.student("alice").exists()


def test_a_folder_with_the_submissions_themselves_is_refused(tmp_path: Path) -> None:
    alice = tmp_path / "submissions" / "alice" / "node.py"
    alice.parent.mkdir(parents=True)
    alice.write_text("x = 1\n")
    with (
        pytest.raises(UsageError, match=r"it is no folder of a class .* Nothing was changed"),
        Store.opened(tmp_path),
    ):
        pass
    assert [path.name for path in tmp_path.iterdir()] == ["submissions"]


def test_two_do_not_write_into_one_class(tmp_path: Path) -> None:
    with (
        Store.opened(tmp_path),
        pytest.raises(UsageError, match="another grading writes into"),
        Store.opened(tmp_path),
    ):
        pass


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
    assert store.of_hand_in(plain, "") == store.of_hand_in(clone, "")


def test_one_letter_makes_another_key(tmp_path: Path) -> None:
    one, other = folder(tmp_path / "a", "x = 1\n"), folder(tmp_path / "b", "x = 2\n")
    assert store.of_hand_in(one, "") != store.of_hand_in(other, "")


def test_a_file_that_an_export_renamed_counts_by_the_name_that_it_had(tmp_path: Path) -> None:
    renamed, plain = tmp_path / "mueller_123_456_node.py", tmp_path / "node.py"
    for path in (renamed, plain):
        path.write_text("x = 1\n")
    assert store.of_hand_in(renamed, "node.py") == store.of_hand_in(plain, "")
    assert store.of_hand_in(renamed, "") != store.of_hand_in(plain, "")


def test_a_pipe_is_not_waited_for(tmp_path: Path) -> None:
    import os

    top = folder(tmp_path / "alice", "x = 1\n")
    if not hasattr(os, "mkfifo"):
        pytest.skip("no pipes with names")
    os.mkfifo(top / "pipe")
    assert store.of_hand_in(top, "") == store.of_hand_in(folder(tmp_path / "bob", "x = 1\n"), "")


def test_what_is_too_deep_for_a_run_is_too_deep_for_a_key(tmp_path: Path) -> None:
    alice, bob = (folder(tmp_path / name, "x = 1\n") for name in ("alice", "bob"))
    for top in (alice, bob):
        lay_too_deep(top)
    assert store.of_hand_in(alice, "") == store.of_hand_in(bob, "")
    (bob / "pkg" / "node.py").write_text("x = 2\n")
    assert store.of_hand_in(alice, "") != store.of_hand_in(bob, "")


def test_what_a_run_depends_on_is_in_its_key_and_the_rubric_is_not(tmp_path: Path) -> None:
    challenge = load_exercise("turtlesim_challenge")
    (tmp_path / "points.yaml").write_text("exercise: turtlesim_challenge\npoints: {moves: 6}\n")
    (tmp_path / "time.yaml").write_text("exercise: turtlesim_challenge\nlimits: {total_s: 99}\n")
    mine = store.of_run("ab", challenge, "virtual", None)
    assert store.of_run("ab", load_exercise(tmp_path / "points.yaml"), "virtual", None) == mine
    others = {
        store.of_run("ab", load_exercise(tmp_path / "time.yaml"), "virtual", None),
        store.of_run("ac", challenge, "virtual", None),
        store.of_run("ab", challenge, "real", None),
        store.of_run("ab", challenge, "virtual", 7),
    }
    assert len(others | {mine}) == 5
