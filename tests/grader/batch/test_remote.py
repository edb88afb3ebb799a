"""A task travels whole, what comes back is taken for nothing but what was asked for."""

from __future__ import annotations

import errno
import os
import pickle
import socket
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from grader.batch import remote
from grader.batch.entry import HandIn, Person
from grader.batch.pool import Answer, Task
from grader.batch.remote import Returned, Shipped, Unfit
from grader.errors import UsageError
from grader.message import msg
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
            return Answer(
                "unfit", msg("isolation by {level} is not to be had here", level=task.isolation)
            )

    monkeypatch.setattr(remote, "_process", Process)
    monkeypatch.setattr(remote, "_address", lambda: "tcp://10.0.0.1:7")
    returned = remote.graded(remote.packed(replace(task, isolation="namespaces")))
    again = pickle.loads(pickle.dumps(returned))  # as dask sends it
    why = "isolation by namespaces is not to be had here"
    assert (again.unfit, str(again.answer.message)) == ("tcp://10.0.0.1:7", why)


def test_what_is_too_large_to_travel_is_refused(
    task: Task, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(remote, "MOST_ENTRIES", 4)
    with pytest.raises(Unfit, match="more than 4 files"):
        remote.packed(task)


OUTSIDE = Shipped("file", b"x")


@pytest.mark.parametrize(
    "returned",
    [
        b"",
        "no answer",
        None,
        Returned(DONE, {"../outside": OUTSIDE}),
        Returned(DONE, {"students/../../outside": OUTSIDE}),
        Returned(DONE, {"/tmp/outside": OUTSIDE}),
        Returned(DONE, {"students/zoe/link": Shipped("link", b"/etc")}),
        Returned(DONE, {"students/bob/entry.json": OUTSIDE}),
        Returned(DONE, {"submissions/zoe/entry.json": OUTSIDE}),
        Returned(DONE, {"run/../students/bob/entry.json": OUTSIDE}),
    ],
)
def test_what_nobody_asked_for_is_told_as_failed(task: Task, returned: object) -> None:
    assert remote.unpack(returned, task).state == "failed"
    assert list(task.into.iterdir()) == []
    assert not (task.into.parent / "outside").exists()


def test_what_comes_of_a_task_and_is_too_large_to_travel_is_told(
    task: Task, done: list[Task], monkeypatch: pytest.MonkeyPatch
) -> None:
    package = remote.packed(task)
    monkeypatch.setattr(remote, "MOST_BYTES", 1)
    answer = remote.unpack(remote.graded(package), task)
    assert answer.state == "failed"
    assert "what came of it cannot be sent: it has more than" in str(answer.message)


def test_a_worker_without_room_is_named(
    task: Task, done: list[Task], monkeypatch: pytest.MonkeyPatch
) -> None:
    package = remote.packed(task)

    def full(self: Path, data: bytes) -> int:
        raise OSError(errno.ENOSPC, "No space left on device")

    with monkeypatch.context() as there:
        there.setattr(Path, "write_bytes", full)
        returned = remote.graded(package)
    answer = remote.unpack(returned, task)
    assert answer.state == "failed"
    name = socket.gethostname()
    assert str(answer.message) == f"the worker {name} has no room for it: No space left on device"
