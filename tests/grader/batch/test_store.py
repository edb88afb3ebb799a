"""What is in its place is whole; what was not finished goes."""

from pathlib import Path

import pytest

from grader.batch.store import RECORDING, RUN, STUDENTS, Store
from grader.errors import UsageError


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
