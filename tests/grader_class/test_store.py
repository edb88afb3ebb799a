import os

import pytest

from grader.errors import UsageError
from grader.exercise.loading import load_exercise
from grader_class import store
from grader_class.store import RECORDING, RUN, STUDENTS, Store
from tests.files import lay, lay_too_deep


def made(store, text, *names):
    place = store.new_place()
    (place / RUN / RECORDING).mkdir(parents=True)
    (place / RUN / RECORDING / "bag").write_text(text)
    for name in names:
        (place / STUDENTS / name).mkdir(parents=True)
        (place / STUDENTS / name / "entry.json").write_text(text)
    return place


def test_a_run_and_all_who_share_it_come_to_their_places_and_the_last_one_stays(tmp_path):
    with Store.opened(tmp_path / "class") as store:
        for text in ("one", "two"):
            store.put("abcd", made(store, text, "alice", "bob"))
        (store.out / "class.json").touch()
        assert store.has("abcd")
        for folder in (store.run("abcd"), store.student("alice"), store.student("bob")):
            assert (folder / RECORDING / "bag").read_text() == "two"
    there = sorted(path.name for path in (tmp_path / "class").iterdir())
    assert there == ["class.json", "store", "submissions"]


def test_what_an_interrupted_call_left_is_gone_with_the_next(tmp_path):
    leftover = tmp_path / ".unfinished" / "x" / "students" / "alice"
    leftover.mkdir(parents=True)
    with Store.opened(tmp_path) as store:
        assert not leftover.exists()
        assert not store.student("alice").exists()


def test_a_folder_with_the_submissions_themselves_is_refused(tmp_path):
    alice = tmp_path / "submissions" / "alice" / "node.py"
    alice.parent.mkdir(parents=True)
    alice.write_text("x = 1\n")
    with (
        pytest.raises(UsageError, match=r"it is no folder of a class .* Nothing was changed"),
        Store.opened(tmp_path),
    ):
        pass
    assert [path.name for path in tmp_path.iterdir()] == ["submissions"]


def test_two_do_not_write_into_one_class(tmp_path):
    with (
        Store.opened(tmp_path),
        pytest.raises(UsageError, match="another grading writes into"),
        Store.opened(tmp_path),
    ):
        pass


@pytest.fixture
def alice_and_bob(tmp_path):
    return [lay(tmp_path / who, {"pkg/node.py": "x = 1\n"}) for who in ("alice", "bob")]


def keys(folders):
    return {store.of_hand_in(folder, "") for folder in folders}


def test_one_letter_makes_another_key_and_what_git_and_python_leave_beside_none(alice_and_bob):
    lay(alice_and_bob[1], {".git/file": "bob's", "__pycache__/file": "bob's"})
    os.mkfifo(alice_and_bob[0] / "pipe")  # is not waited for
    assert len(keys(alice_and_bob)) == 1
    lay(alice_and_bob[1], {"pkg/node.py": "x = 2\n"})
    assert len(keys(alice_and_bob)) == 2


def test_what_is_too_deep_for_a_run_is_too_deep_for_a_key(alice_and_bob):
    for top in alice_and_bob:
        lay_too_deep(top)
    assert len(keys(alice_and_bob)) == 1
    lay(alice_and_bob[1], {"pkg/node.py": "x = 2\n"})
    assert len(keys(alice_and_bob)) == 2


def test_a_file_that_an_export_renamed_counts_by_the_name_that_it_had(tmp_path):
    renamed, plain = tmp_path / "mueller_123_456_node.py", tmp_path / "node.py"
    for path in (renamed, plain):
        path.write_text("x = 1\n")
    assert store.of_hand_in(renamed, "node.py") == store.of_hand_in(plain, "")
    assert store.of_hand_in(renamed, "") != store.of_hand_in(plain, "")


def test_what_a_run_depends_on_is_in_its_key_and_the_rubric_is_not(tmp_path):
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
