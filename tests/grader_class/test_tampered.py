"""The folder of a class that somebody has changed between two calls: what is bad is made anew."""

import json
import os
import shutil
from pathlib import Path

import pytest

from grader.errors import UsageError
from grader.exercise.result.result import Result
from grader.text.message import msg
from grader_class import export, pool
from grader_class.class_file import CLASS, ClassFile
from grader_class.entry import ENTRY, Entry, entries
from grader_class.page.thumb import THUMB, Thumb
from grader_class.pool import Answer
from grader_class.store import RECORDING, STUDENTS, Store
from tests.grader_class.classes import batch

#: More than any file of ours; none of it is on the disk [bytes].
HUGE = 2**33


def changed(path, change):
    """Write JSON anew that its own function changes; what is linked to the file stays."""
    data = json.loads(path.read_text(encoding="utf-8"))
    change(data)
    path.unlink()
    path.write_text(json.dumps(data), encoding="utf-8")


def replaced(path, make):
    path.unlink()
    make(path)


def is_huge(path):
    path.touch()
    os.truncate(path, HUGE)


def leads_to_an_endless_device(path):
    path.symlink_to("/dev/zero")


def earns_more(result):
    result["score"] += 1000
    result["verdicts"][0]["score"] += 1000


#: What is no file of ours.
NO_FILE = {
    "a pipe": os.mkfifo,
    "a folder": Path.mkdir,
    "huge": is_huge,
    "a link": leads_to_an_endless_device,
    "empty": Path.touch,
    "nested": lambda path: path.write_text("[" * 200_000),
    "no text": lambda path: path.write_bytes(b"\xff\xfe\x00"),
}
#: What in entry.json is not so.
NO_ENTRY = {
    "state": lambda entry: entry.update(state="wild"),
    "state is a list": lambda entry: entry.update(state=["judged"]),
    "points": lambda entry: entry.update(max_score="many"),
    "message": lambda entry: entry.update(message=5),
    "key leads out": lambda entry: entry.update(key="../../outside"),
    "key is a number": lambda entry: entry.update(key=7),
    "people": lambda entry: entry["hand_in"].update(people=[{"id": 5, "name": "", "columns": {}}]),
    "time without zone": lambda entry: entry["hand_in"].update(at="2026-11-01T12:00:00"),
    "id leads out": lambda entry: entry["hand_in"].update(id="../../outside"),
    "other exercise": lambda entry: entry.update(exercise_sha256="0" * 64),
}
#: What in result.json is not so.
NO_RESULT = {
    "more than all points": earns_more,
    "other hand-in": lambda result: result["handed_in"].update(id="twin"),
    "other exercise": lambda result: result["provenance"]["judged"].update(
        exercise_sha256="0" * 64
    ),
    "score is no number": lambda result: result.update(score=None),
}


@pytest.fixture
def folder(graded, tmp_path):
    copy = Path(shutil.copytree(Store(graded).student("right"), tmp_path / "right"))
    assert Entry.read(copy).state == "judged"
    return copy


@pytest.mark.parametrize("how", NO_FILE)
def test_what_is_no_file_of_ours_is_neither_waited_for_nor_read_whole(folder, how):
    for name in (Result.FILE, ENTRY):
        replaced(folder / name, NO_FILE[how])
        with pytest.raises(UsageError, match=name):
            Entry.read(folder)
    replaced(folder / THUMB, NO_FILE[how])
    assert Thumb.read(folder) is None


@pytest.mark.parametrize(
    ("name", "change"),
    [
        *((ENTRY, each) for each in NO_ENTRY.values()),
        *((Result.FILE, e) for e in NO_RESULT.values()),
    ],
    ids=[*NO_ENTRY, *NO_RESULT],
)
def test_an_entry_or_a_result_whose_values_cannot_be_is_none(folder, name, change):
    changed(folder / name, change)
    with pytest.raises(UsageError):
        Entry.read(folder)


@pytest.mark.parametrize(
    "values",
    [
        *({"hand_ins": "5"}, {"seed": "x"}, {"isolation": "wild"}),
        *({"hand_ins": "x"}, {"hand_ins": True}, {"exercise": {"a": 1}}, {"time": None}),
    ],
    ids=str,
)
def test_a_class_file_whose_values_cannot_be_is_named(graded, tmp_path, values):
    shutil.copy(graded / CLASS, tmp_path)
    changed(tmp_path / CLASS, lambda data: data.update(values))
    with pytest.raises(UsageError, match=r"class\.json is damaged: \w+"):
        ClassFile.read(tmp_path)


def test_of_a_source_that_is_larger_than_any_nothing_is_shown_and_no_link_followed(folder):
    kept = folder / export.SOURCE
    (source,) = kept.iterdir()
    replaced(source, is_huge)
    (file,) = export.kept(kept)
    assert file.data == b""
    link = folder / "link"
    link.symlink_to(kept)
    assert export.kept(link) == []


def test_whatever_was_changed_in_a_class_the_same_call_ends_as_before(
    out, graded, small_class, in_process
):
    folders = {entry.id: entry.folder for entry in entries(out)}
    runs = {entry.id: Store(out).run(entry.key) for entry in entries(out) if entry.key}
    # its recording is cut off, and its result is gone
    (folders["right"] / ENTRY).unlink()
    os.truncate(runs["right"] / RECORDING / "recording.mcap", 1000)
    # the result of somebody else, and a picture that is waited for
    replaced(
        folders["twin"] / Result.FILE,
        lambda path: shutil.copy(folders["leaves"] / Result.FILE, path),
    )
    replaced(runs["twin"] / THUMB, os.mkfifo)
    # of its run nothing is there but why it could not be started, which is no file
    replaced(folders["crashes"] / ENTRY, os.mkfifo)
    shutil.rmtree(runs["crashes"])
    runs["crashes"].mkdir()
    os.mkfifo(runs["crashes"] / "error.json")
    # nothing was handed in, it says
    changed(folders["leaves"] / ENTRY, lambda entry: entry.update(state="nothing"))
    changed(folders["nobody"] / ENTRY, lambda entry: entry.update(max_score=1e300))
    code, said = batch(*small_class.words(out))
    assert code == 0, said
    for name in ("gradebook.csv", "gradebook.jsonl"):
        assert (out / name).read_bytes() == (graded / name).read_bytes(), name
    assert len(entries(out)) == len(folders)


def test_no_link_in_a_run_is_followed_into_a_student_s_folder(tmp_path):
    secret = tmp_path / "secret"
    secret.mkdir()
    (secret / "token.py").write_text("x = 1\n")
    with Store.opened(tmp_path / "class") as store:
        run = store.run("ab")
        (run / RECORDING).mkdir(parents=True)
        (run / RECORDING / "more").symlink_to(secret)
        (run / export.SOURCE).symlink_to(secret)
        (run / THUMB).symlink_to(secret / "token.py")
        place = store.new_place()
        (place / STUDENTS / "zoe").mkdir(parents=True)
        store.put("ab", place)
        zoe = store.student("zoe")
        assert [path.name for path in zoe.iterdir()] == [RECORDING]
        assert (zoe / RECORDING / "more").is_symlink()


@pytest.mark.parametrize("name", ["store", "submissions", "aside"])
def test_a_class_of_which_a_part_is_a_link_is_not_written_into(tmp_path, name):
    elsewhere, out = tmp_path / "elsewhere", tmp_path / "class"
    for folder in (elsewhere, out):
        folder.mkdir()
    (out / name).symlink_to(elsewhere)
    with (
        pytest.raises(UsageError, match=rf"cannot write .*{name}: it is a link"),
        Store.opened(out),
    ):
        pass
    assert list(elsewhere.iterdir()) == []


@pytest.mark.parametrize(
    ("answer", "why"),
    [
        (Answer("done"), "what a worker sent back cannot be used"),
        (Answer("unfit", msg("there is less here")), "there is less here"),
    ],
)
def test_a_worker_that_made_nothing_fails_for_its_hand_ins_and_nobody_else(
    small_class, tmp_path, monkeypatch, answer, why
):
    monkeypatch.setattr(pool, "work", lambda tasks, jobs: ((task, answer) for task in tasks))
    code, said = batch(*small_class.words(tmp_path / "class"))
    assert (code, why in said) == (3, True), said
    states = {entry.id: entry.state for entry in entries(tmp_path / "class")}
    failed = {"broken", "crashes", "leaves", "right", "twin"}
    assert states == {"nobody": "unusable", **dict.fromkeys(failed, "failed")}
