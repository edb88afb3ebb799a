"""A task travels whole, what comes back is taken for nothing but what was asked for."""

from __future__ import annotations

import errno
import gzip
import io
import os
import pickle
import socket
import tarfile
import tracemalloc
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from grader.batch import parcel, remote
from grader.batch.hand_in import HandIn, Person
from grader.batch.parcel import Unfit
from grader.batch.task import Answer, Task
from grader.errors import UsageError
from tests.files import lay_too_deep

DONE = Answer("done")


@pytest.fixture
def task(tmp_path: Path) -> Task:
    """A task for a folder with all that a student may leave in one."""
    top = tmp_path / "handed in" / "zoë"
    (top / "pkg").mkdir(parents=True)
    (top / "pkg" / "node.py").write_text("x = 1\n")
    (top / "pkg" / "node.py").chmod(0o700)
    os.link(top / "pkg" / "node.py", top / "pkg" / "the_same.py")
    (top / "inside.py").symlink_to("pkg/node.py")
    (top / "outside.py").symlink_to("/etc/hostname")
    (top / "venv").mkdir()
    (top / "venv" / "pyvenv.cfg").touch()
    (top / ".git").mkdir()
    os.mkfifo(top / "pipe")
    into = tmp_path / "into"
    into.mkdir()
    zoe = HandIn("zoe", (Person("zoe"),))
    return Task("ab", (zoe,), top, "", "square", "virtual", 7, None, into)


@pytest.fixture
def done(monkeypatch: pytest.MonkeyPatch) -> Iterator[list[Task]]:
    """The tasks that a worker has done; what it makes is one file for each student."""
    seen = []

    class Process:
        def done(self, task: Task) -> Answer:
            seen.append(task)
            assert task.path.exists()
            listed.extend(sorted(f"{p.relative_to(task.path)}" for p in task.path.rglob("*")))
            for hand_in in task.hand_ins:
                folder = task.into / "students" / hand_in.id
                folder.mkdir(parents=True)
                (folder / "entry.json").write_text("{}")
            return DONE

    listed.clear()
    monkeypatch.setattr(remote, "_process", Process)
    yield seen


listed: list[str] = []


def test_what_was_handed_in_travels_and_what_was_made_comes_back(
    task: Task, done: list[Task]
) -> None:
    assert remote.unpack(remote.graded(remote.packed(task)), task) == DONE
    assert (task.into / "students" / "zoe" / "entry.json").read_text() == "{}"
    # links as links: a run sees to where they lead; no pipe, nothing hidden, nothing generated
    assert listed == ["inside.py", "outside.py", "pkg", "pkg/node.py", "pkg/the_same.py"]
    assert done[0].path.name == "zoë"
    sent = (done[0].key, done[0].hand_ins, done[0].exercise, done[0].seed, done[0].run)
    assert sent == ("ab", task.hand_ins, "square", 7, None)


def test_what_is_too_deep_for_a_run_stays_here(task: Task, done: list[Task]) -> None:
    assert task.path is not None
    lay_too_deep(task.path)
    assert remote.unpack(remote.graded(remote.packed(task)), task) == DONE
    assert "pkg/node.py" in listed
    assert not any(name.endswith("deep.py") for name in listed)


def test_an_edited_exercise_travels_with_the_folder_that_it_lies_in(
    task: Task, done: list[Task], small_class
) -> None:
    remote.graded(remote.packed(replace(task, exercise=str(small_class.exercise))))
    there = Path(done[0].exercise)
    assert there.parts[-3:] == ("exercise", "own_square", "quick.yaml")
    assert there != small_class.exercise


def test_a_run_that_was_made_before_travels_too(
    task: Task, done: list[Task], tmp_path: Path
) -> None:
    run = tmp_path / "store" / "ab"
    run.mkdir(parents=True)
    (run / "error.json").write_text("{}")
    remote.graded(remote.packed(replace(task, run=run)))
    assert done[0].run is not None
    assert done[0].run.name == "run"


def test_a_worker_with_other_versions_does_not_begin(
    task: Task, done: list[Task], monkeypatch: pytest.MonkeyPatch
) -> None:
    package = remote.packed(task)
    monkeypatch.setenv("ROS_DISTRO", "rolling")
    with pytest.raises(UsageError, match="other versions: ros_distro rolling"):
        remote.graded(package)
    assert done == []


def test_a_worker_that_cannot_confine_as_asked_says_which_it_is(
    task: Task, monkeypatch: pytest.MonkeyPatch
) -> None:
    class Process:
        def done(self, task: Task) -> Answer:
            return Answer("unfit", f"isolation by {task.isolation} is not to be had here")

    monkeypatch.setattr(remote, "_process", Process)
    monkeypatch.setattr(remote, "_address", lambda: "tcp://10.0.0.1:7")
    with pytest.raises(remote.Declined, match="isolation by namespaces is not to be") as raised:
        remote.graded(remote.packed(replace(task, isolation="namespaces")))
    again = pickle.loads(pickle.dumps(raised.value))  # as dask sends it
    assert (again.address, again.message) == ("tcp://10.0.0.1:7", raised.value.message)


def test_what_is_too_large_for_a_parcel_is_refused(
    task: Task, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(parcel, "MOST_MEMBERS", 4)
    with pytest.raises(Unfit, match="more than 4 files"):
        remote.packed(task)


def tarred(name: str, kind: bytes = tarfile.REGTYPE, link: str = "") -> bytes:
    """An answer with one more member."""
    buffer = io.BytesIO()
    with tarfile.open(fileobj=buffer, mode="w:gz") as tar:
        answer, more = tarfile.TarInfo(remote.ANSWER), tarfile.TarInfo(name)
        answer.size = len(DONE.to_line())
        more.type, more.linkname = kind, link
        tar.addfile(answer, io.BytesIO(DONE.to_line()))
        tar.addfile(more)
    return buffer.getvalue()


@pytest.mark.parametrize(
    "package",
    [
        b"",
        b"\x80\x04no pickle is read\x94.",
        tarred("../outside"),
        tarred("students/../../outside"),
        tarred("students/zoe/link", tarfile.SYMTYPE, "/etc"),
        tarred("students/zoe/device", tarfile.CHRTYPE),
        tarred("students/bob/entry.json"),
        tarred("submissions/zoe/entry.json"),
        tarred("run/../students/bob/entry.json"),
        tarred("students/" + "n" * 300),
        "no bytes",
        None,
    ],
)
def test_what_nobody_asked_for_is_told_as_failed(task: Task, package: object) -> None:
    assert remote.unpack(package, task).state == "failed"
    assert not (task.into.parent / "outside").exists()
    assert not any(path.is_symlink() for path in task.into.rglob("*"))


def test_a_bomb_is_not_unpacked(task: Task, monkeypatch: pytest.MonkeyPatch) -> None:
    package = parcel.pack({}, {"run": task.path / "pkg"})
    monkeypatch.setattr(parcel, "MOST_BYTES", 3)
    assert "more than" in remote.unpack(package, task).message


def test_of_a_head_that_says_it_has_gigabytes_no_more_is_unpacked_than_a_parcel_holds(
    task: Task, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(parcel, "MOST_BYTES", 100_000)
    monkeypatch.setattr(parcel, "MOST_MEMBERS", 10)
    head = tarfile.TarInfo("././@PaxHeader")
    head.type, head.size = tarfile.XHDTYPE, 2**26
    package = gzip.compress(head.tobuf(tarfile.USTAR_FORMAT) + bytes(head.size))
    tracemalloc.start()
    try:
        assert remote.unpack(package, task).state == "failed"
        assert tracemalloc.get_traced_memory()[1] < 2**24
    finally:
        tracemalloc.stop()


def test_a_worker_without_room_is_named(task: Task, monkeypatch: pytest.MonkeyPatch) -> None:
    package, unpack = remote.packed(task), parcel.unpack

    def full(data: bytes, folder: Path, trust: parcel.Trust = "data") -> dict[str, bytes]:
        if trust == "tar":
            raise OSError(errno.ENOSPC, "No space left on device")
        return unpack(data, folder, trust)

    monkeypatch.setattr(parcel, "unpack", full)
    answer = remote.unpack(remote.graded(package), task)
    assert answer.state == "failed"
    name = socket.gethostname()
    assert answer.message == f"the worker {name} has no room for it: No space left on device"
