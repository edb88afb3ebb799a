"""A class on a real dask cluster: whatever goes, each is graded, and as on one machine."""

from __future__ import annotations

import signal
from collections.abc import Iterator
from pathlib import Path

import psutil
import pytest

from grader.batch import cluster
from grader.batch.entry import entries
from grader.errors import UsageError
from tests.grader.batch.classes import DEADLINE_S, Class, told
from tests.grader.batch.clusters import Call, Cluster, held, kill

pytestmark = pytest.mark.timeout(600)


@pytest.fixture
def dask(tmp_path: Path) -> Iterator[Cluster]:
    (tmp_path / "dask").mkdir()
    with Cluster(tmp_path / "dask") as found:
        yield found


def call(small_class: Class, dask: Cluster, out: Path, *words: str) -> Call:
    words = ("--scheduler", dask.address, *words)
    return Call(small_class.command(out, *words), out.parent)


def test_the_tasks_of_a_worker_that_is_killed_are_done_by_another(
    small_class: Class, graded: Path, dask: Cluster, tmp_path: Path
) -> None:
    dask.start_scheduler()
    first = dask.start_worker()
    with call(small_class, dask, tmp_path / "out") as grading:
        process = held(first)
        kill(first)
        process.resume()
        # nobody is there to whom it could tell what came of it
        assert psutil.wait_procs([process], DEADLINE_S)[1] == []
        grading.wait_for("The scheduler has no worker.")
        dask.start_worker()
        dask.start_worker()
        assert grading.wait() == 0, grading.text()
    assert told(tmp_path / "out") == told(graded)


def test_a_scheduler_that_is_killed_and_comes_back_goes_on_with_what_was_underway(
    small_class: Class, graded: Path, dask: Cluster, tmp_path: Path
) -> None:
    scheduler = dask.start_scheduler()
    first = dask.start_worker()
    with call(small_class, dask, tmp_path / "out") as grading:
        held(first)
        kill(scheduler)
        grading.wait_for(f"The scheduler at {dask.address} is gone.")
        kill(first)
        dask.start_scheduler()
        dask.start_worker()
        assert grading.wait() == 0, grading.text()
    assert told(tmp_path / "out") == told(graded)


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


def test_ctrl_c_ends_it_and_the_same_call_goes_on(
    small_class: Class, graded: Path, dask: Cluster, tmp_path: Path
) -> None:
    dask.start_scheduler()
    first = dask.start_worker()
    with call(small_class, dask, tmp_path / "out") as grading:
        process = held(first)
        grading.process.send_signal(signal.SIGINT)
        assert grading.wait() == 130, grading.text()
        assert "Traceback" not in grading.text()
        process.resume()
    with call(small_class, dask, tmp_path / "out") as grading:
        assert grading.wait() == 0, grading.text()
        assert "1 hand-in of 5 graded before." in grading.text()
    assert told(tmp_path / "out") == told(graded)


def test_what_ends_every_worker_is_told_as_failed_and_nobody_pays(
    small_class: Class, dask: Cluster, tmp_path: Path
) -> None:
    dask.start_scheduler(DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES="0")
    first = dask.start_worker()
    with call(small_class, dask, tmp_path / "out") as grading:
        process = held(first)
        kill(first)
        process.resume()
        dask.start_worker()
        assert grading.wait() == 3, grading.text()
    failed = [entry for entry in entries(tmp_path / "out") if entry.state == "failed"]
    assert 1 <= len(failed) <= 3  # one, and what was waiting for the same worker
    assert {entry.message for entry in failed} == {"1 worker of the cluster ended while grading it"}
    assert {entry.score for entry in failed} == {None}


def test_what_is_no_address_is_told() -> None:
    with pytest.raises(UsageError, match="nonsense is no address of a scheduler"):
        list(cluster.work([], "nonsense", print))


def test_where_there_is_no_scheduler_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cluster, "FIRST_S", 0.5)
    with pytest.raises(UsageError, match=r"there is no scheduler at .*:9"):
        list(cluster.work([], "tcp://127.0.0.1:9", print))
