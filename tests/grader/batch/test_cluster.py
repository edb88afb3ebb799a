"""A class on a real dask cluster: whatever goes, each is graded, and as on one machine."""

from __future__ import annotations

import signal
from collections.abc import Callable, Iterator
from contextlib import nullcontext
from pathlib import Path

import psutil
import pytest
from distributed import KilledWorker

from grader.batch import cluster
from grader.batch.entry import entries
from grader.errors import UsageError
from tests.grader.batch.classes import DEADLINE_S, Class, told
from tests.grader.batch.clusters import Call, Cluster, kill

pytestmark = pytest.mark.timeout(600)


@pytest.fixture
def dask(tmp_path: Path) -> Iterator[Cluster]:
    (tmp_path / "dask").mkdir()
    with Cluster(tmp_path / "dask") as found:
        yield found


def call(small_class: Class, dask: Cluster, out: Path, *words: str) -> Call:
    words = ("--scheduler", dask.address, *words)
    return Call(small_class.command(out, *words), out.parent)


def test_whatever_goes_a_worker_or_the_scheduler_each_is_graded_as_on_one_machine(
    small_class: Class, graded: Path, dask: Cluster, tmp_path: Path
) -> None:
    scheduler = dask.start_scheduler()
    first = dask.start_worker()
    with call(small_class, dask, tmp_path / "out") as grading:
        process = dask.held(first)
        kill(first)
        process.resume()
        # nobody is there to whom it could tell what came of it
        assert psutil.wait_procs([process], DEADLINE_S)[1] == []
        grading.wait_for("The scheduler has no worker.")
        second = dask.start_worker()
        dask.held(second)
        kill(scheduler)
        grading.wait_for(f"The scheduler at {dask.address} is gone.")
        kill(second)
        dask.start_scheduler()
        dask.start_worker()
        assert grading.wait() == 0, grading.text()
    assert told(tmp_path / "out") == told(graded)


@pytest.mark.more("a client of its own proves the refusal")
def test_a_worker_with_other_versions_is_refused(
    small_class: Class, dask: Cluster, tmp_path: Path
) -> None:
    dask.start_scheduler()
    dask.start_worker(ROS_DISTRO="rolling")
    with call(small_class, dask, tmp_path / "out") as grading:
        assert grading.wait() == 2
        assert "other versions: ros_distro rolling, and " in grading.text()
    # who handed in nothing needs no worker
    assert [entry.id for entry in entries(tmp_path / "out")] == ["nobody"]


@pytest.mark.more("an interrupted call goes on without a cluster as well: test_batch")
def test_ctrl_c_ends_it_and_the_same_call_goes_on(
    small_class: Class, graded: Path, dask: Cluster, tmp_path: Path
) -> None:
    dask.start_scheduler()
    first = dask.start_worker()
    with call(small_class, dask, tmp_path / "out") as grading:
        process = dask.held(first)
        grading.process.send_signal(signal.SIGINT)
        assert grading.wait() == 130, grading.text()
        assert "Traceback" not in grading.text()
        process.resume()
    with call(small_class, dask, tmp_path / "out") as grading:
        assert grading.wait() == 0, grading.text()
        assert "1 hand-in of 5 graded before." in grading.text()
    assert told(tmp_path / "out") == told(graded)


@pytest.mark.more("the answer to what ended its workers is proven without any")
def test_what_ends_every_worker_is_told_as_failed_and_nobody_pays(
    small_class: Class, dask: Cluster, tmp_path: Path
) -> None:
    dask.start_scheduler(DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES="0")
    first = dask.start_worker()
    with call(small_class, dask, tmp_path / "out") as grading:
        process = dask.held(first)
        kill(first)
        process.resume()
        dask.start_worker()
        assert grading.wait() == 3, grading.text()
    failed = [entry for entry in entries(tmp_path / "out") if entry.state == "failed"]
    assert 1 <= len(failed) <= 3  # one, and what was waiting for the same worker
    assert {entry.message for entry in failed} == {"1 worker of the cluster ended while grading it"}
    assert {entry.score for entry in failed} == {None}


class Fake:
    """A client of a cluster whose only worker has another ROS."""

    status = "running"

    def run(self, call: Callable[[], dict[str, str]], on_error: str) -> dict[str, dict[str, str]]:
        return {"tcp://10.0.0.1:7": {**call(), "ros_distro": "rolling"}}


def test_a_cluster_with_other_versions_is_refused_before_anything_is_sent_to_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(cluster, "_connected", lambda *_: nullcontext(Fake()))
    other = "the worker at tcp://10.0.0.1:7 has other versions: ros_distro rolling, and "
    with pytest.raises(UsageError, match=other):
        list(cluster.work([], "tcp://10.0.0.1:8", print))


def test_a_task_that_ended_its_workers_is_answered_as_failed() -> None:
    session = cluster._Session(Fake(), iter(()), "", print)  # type: ignore[arg-type]
    ended = KilledWorker("task", None, 1)
    answer = session._failure(ended)
    told = "2 workers of the cluster ended while grading it"
    assert (answer.state, answer.message) == ("failed", told)
    answer = session._failure(ValueError("x"))
    assert (answer.state, answer.message) == ("failed", "a worker failed: ValueError: x")


def test_what_is_no_address_is_told() -> None:
    with pytest.raises(UsageError, match="nonsense is no address of a scheduler"):
        list(cluster.work([], "nonsense", print))


def test_where_there_is_no_scheduler_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cluster, "FIRST_S", 0.5)
    with pytest.raises(UsageError, match=r"there is no scheduler at .*:9"):
        list(cluster.work([], "tcp://127.0.0.1:9", print))
