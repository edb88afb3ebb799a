"""A class on a real Dask cluster: whoever dies, each is graded as on one machine."""

from __future__ import annotations

import gc
import json
import re
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from concurrent.futures import Future
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import TypeVar

import psutil
import pytest

from grader.batch import cluster, pool
from grader.batch.cluster import Terms
from grader.batch.pool import Answer, Task
from grader.errors import NotOffered, UsageError
from grader.run.processes import levels
from tests.grader.batch.classes import DEADLINE_S, ENV, ROOT, Class, told

Found = TypeVar("Found")


def until(look: Callable[[], Found | None]) -> Found:
    """What there is, as soon as there is something."""
    deadline = time.monotonic() + DEADLINE_S
    while not (found := look()):
        assert time.monotonic() < deadline, "it never came"
        time.sleep(0.02)
    return found


class Dask:
    """Its processes, which are killed at the end."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.processes: list[psutil.Popen] = []
        file = folder / "scheduler.json"
        words = ["--port", "0", "--no-dashboard", "--no-show", "--scheduler-file", str(file)]
        self._start("scheduler", *words)
        self.address = until(lambda: self._address(file))

    def start_worker(self) -> psutil.Popen:
        """Start one that grades one at a time."""
        words = ["--nthreads", "1", "--no-nanny", "--no-dashboard"]
        return self._start("worker", self.address, *words, "--local-directory", str(self.folder))

    def _start(self, what: str, *words: str) -> psutil.Popen:
        with (self.folder / f"{len(self.processes)}.{what}.log").open("wb") as log:
            process = psutil.Popen(
                [
                    sys.executable,
                    "-m",
                    f"distributed.cli.dask_{what}",
                    "--host",
                    "127.0.0.1",
                    *words,
                ],
                env={**ENV, "DASK_TEMPORARY_DIRECTORY": str(self.folder)},
                cwd=self.folder,
                stdout=log,
                stderr=log,
            )
        self.processes.append(process)
        return process

    def _address(self, file: Path) -> str:
        with suppress(OSError, ValueError):  # it is being written
            return str(json.loads(file.read_text())["address"])
        return ""


@pytest.fixture
def dask(tmp_path: Path) -> Iterator[Dask]:
    (tmp_path / "dask").mkdir()
    found = Dask(tmp_path / "dask")
    yield found
    for process in found.processes:
        process.kill()
        process.wait()


def grading(worker: psutil.Popen) -> psutil.Process | None:
    """The process that does a worker's task, as soon as there is one."""
    for child in worker.children():
        with suppress(psutil.Error):  # others come and go while a worker starts
            if any("grader.batch" in word for word in child.cmdline()):
                return child
    return None


@pytest.mark.timeout(600)
def test_two_workers_grade_as_one_machine_does_also_if_one_dies_in_the_middle(
    small_class: Class, graded: Path, dask: Dask, tmp_path: Path
) -> None:
    first = dask.start_worker()
    command = small_class.command(Path("out"), "--scheduler", dask.address)
    with subprocess.Popen(command, env=ENV, cwd=tmp_path, stderr=subprocess.PIPE) as call:
        until(lambda: grading(first) or call.poll() is not None)
        first.kill()
        dask.start_worker()
        dask.start_worker()
        said = call.communicate(timeout=DEADLINE_S)[1].decode()
    assert call.returncode == 0, said
    assert told(tmp_path / "out") == told(graded)
    assert list((tmp_path / "out").glob(".unfinished")) == []


@pytest.mark.more("a cluster of the tests' own proves the same")
@pytest.mark.timeout(600)
def test_the_example_of_one_machine_grades_as_without_a_cluster(
    small_class: Class, graded: Path, tmp_path: Path
) -> None:
    script = ROOT / "examples" / "batch" / "one_machine.sh"
    words = map(str, (small_class.handed_in, "--out", tmp_path / "out"))
    env = {**ENV, "PYTHON": sys.executable}
    done = subprocess.run(
        [script, *words, "--exercise", small_class.exercise],
        cwd=tmp_path,
        env=env,
        text=True,
        capture_output=True,
        timeout=DEADLINE_S,
    )
    assert done.returncode == 0, done.stderr
    assert told(tmp_path / "out") == told(graded)


class Client:
    """A client of a cluster with these workers: what each offers, or raises."""

    def __init__(self, *offers: str | Exception) -> None:
        self.offers = {f"tcp://10.0.0.{n}:7": offer for n, offer in enumerate(offers, 1)}

    def nthreads(self) -> dict[str, int]:
        return dict.fromkeys(self.offers, 1)

    def submit(self, _: object, terms: Terms, workers: list[str], pure: bool) -> Future[str]:
        future: Future[str] = Future()
        offer = self.offers[workers[0]]
        if isinstance(offer, str):
            future.set_result(offer)
        else:
            future.set_exception(offer)
        return future


@pytest.fixture
def terms(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Terms:
    """Those of a class, for this process as a worker."""
    monkeypatch.setattr("distributed.get_worker", lambda: type("Worker", (), {"address": "box"}))
    monkeypatch.setattr(levels, "here", lambda level: levels.Level(level or "landlock"))
    (tmp_path / "place").mkdir()
    (tmp_path / "handed_in").mkdir()
    return Terms(tmp_path, tmp_path / "place", (tmp_path / "handed_in",))


def test_a_worker_that_can_grade_the_class_says_how_well_it_isolates(terms: Terms) -> None:
    assert cluster.offer(terms) == "landlock"
    assert cluster.offer(replace(terms, level="limits")) == "limits"


def test_a_worker_with_other_versions_is_refused(
    terms: Terms, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ROS_DISTRO", "rolling")
    with pytest.raises(UsageError, match="the worker at box has other versions: ros_distro roll"):
        cluster.offer(terms)


@pytest.mark.parametrize("missing", ["place", "handed_in"])
def test_a_worker_that_does_not_see_the_folder_is_refused(terms: Terms, missing: str) -> None:
    (terms.out / missing).rmdir()
    with pytest.raises(UsageError, match=rf"box cannot see .*/{missing}, or not write there\. Put"):
        cluster.offer(terms)


def test_a_worker_that_cannot_isolate_as_the_class_asks_is_refused(
    terms: Terms, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(_: str) -> levels.Level:
        raise NotOffered("no namespaces here")

    monkeypatch.setattr(levels, "here", refuse)
    with pytest.raises(UsageError, match=r"box cannot isolate .* asks: no namespaces here"):
        cluster.offer(terms)


def test_a_class_has_the_best_level_that_all_workers_offer(terms: Terms) -> None:
    workers = Client("namespaces", "landlock", "namespaces")
    assert cluster._agreed(workers, terms, "").level == "landlock"
    with pytest.raises(UsageError, match="a worker of the cluster offers isolation by landlock"):
        cluster._agreed(workers, terms, "namespaces")


def test_a_worker_without_the_grader_is_named(terms: Terms) -> None:
    missing = ModuleNotFoundError("No module named 'grader'")
    with pytest.raises(UsageError, match=r"worker at tcp://10\.0\.0\.2:7 cannot grade \(No modul"):
        cluster._agreed(Client("landlock", missing), terms, "")


def test_a_task_of_which_two_workers_died_is_not_tried_again(
    terms: Terms, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[Task] = []

    class Process:
        def done(self, task: Task) -> Answer:
            asked.append(task)
            return Answer("done")

    monkeypatch.setattr(pool, "Process", Process)
    monkeypatch.delattr(cluster._of_thread, "process", raising=False)
    task = Task("0", (), None, "", "square", "virtual", None, None, terms.place)
    terms = replace(terms, level="limits")
    answers = [cluster.graded(task, terms) for _ in range(3)]
    monkeypatch.delattr(cluster._of_thread, "process")
    assert [(each.into, each.isolation) for each in asked] == [
        (terms.place / "1", "limits"),
        (terms.place / "2", "limits"),
    ]
    assert [(answer.state, into.name) for answer, into in answers[:2]] == [
        ("done", "1"),
        ("done", "2"),
    ]
    told_so = "2 workers of the cluster ended while grading it"
    assert (answers[2][0].state, str(answers[2][0].message)) == ("failed", told_so)


def refusal(address: str, terms: Terms) -> str:
    """Why there is no cluster at an address."""
    told = ""
    try:
        list(cluster.work([], address, terms, print))
    except UsageError as error:
        told = str(error)
    # the client that could not start ends now: while another starts, Dask would wait for itself
    gc.collect()
    return told


def test_what_is_no_address_of_a_scheduler_is_told(
    terms: Terms, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cluster, "FIRST_S", 0.5)
    assert "nonsense is no address of a scheduler" in refusal("nonsense", terms)
    assert re.search(r"there is no scheduler at .*:9", refusal("tcp://127.0.0.1:9", terms))
