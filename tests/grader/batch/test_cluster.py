"""A class on a real dask cluster: whatever goes, each is graded, and as on one machine."""

from __future__ import annotations

import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import nullcontext
from pathlib import Path
from typing import Any

import psutil
import pytest
from distributed import KilledWorker

from grader.batch import cluster
from grader.batch.class_file import OfCluster
from grader.batch.entry import entries
from grader.batch.remote import Offer
from grader.batch.store import installed_versions
from grader.errors import UsageError
from grader.message import plain_text
from grader.run.processes import levels
from tests.grader.batch.classes import DEADLINE_S, ENV, ROOT, Class, told
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


@pytest.mark.more("a cluster of the tests' own proves the same")
def test_the_example_of_one_machine_grades_as_without_a_cluster(
    small_class: Class, graded: Path, tmp_path: Path
) -> None:
    script = ROOT / "examples" / "batch" / "one_machine.sh"
    words = [small_class.handed_in, "--out", tmp_path / "out", "--exercise", small_class.exercise]
    env = {**ENV, "PYTHON": sys.executable}
    done = subprocess.run(
        [script, *words], cwd=tmp_path, env=env, text=True, capture_output=True, timeout=DEADLINE_S
    )
    assert done.returncode == 0, done.stderr
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
    assert {str(entry.message) for entry in failed} == {
        "1 worker of the cluster ended while grading it"
    }
    assert {entry.score for entry in failed} == {None}


@pytest.mark.more("what a worker offers is asked without a cluster as well")
def test_a_worker_that_confines_less_well_is_named_and_the_others_grade(
    small_class: Class, graded: Path, dask: Cluster, tmp_path: Path
) -> None:
    if levels.here().level != "namespaces":
        pytest.skip("this system has no better level than such a worker")
    dask.start_scheduler()
    first = dask.start_worker()
    with call(small_class, dask, tmp_path / "out") as grading:
        process = dask.held(first)
        dask.start_worker(refused="namespaces")
        grading.wait_for("takes no hand-in: this class is graded with isolation by namespaces")
        process.resume()
        assert grading.wait() == 0, grading.text()
    assert told(tmp_path / "out") == told(graded)


class Fake:
    """A client of a cluster: what each of its workers offers."""

    status = "running"

    def __init__(self, *offers: dict[str, Any]) -> None:
        made = (Offer(**{"versions": installed_versions(), **offer}) for offer in offers)
        self.offers = {f"tcp://10.0.0.{n}:7": offer for n, offer in enumerate(made, 1)}

    def run(self, call: object, level: str, on_error: str) -> dict[str, Offer]:
        return self.offers

    def nthreads(self) -> dict[str, int]:
        return dict.fromkeys(self.offers, 1)


def session(fake: Fake, isolation: OfCluster | None = None) -> tuple[cluster._Session, list[str]]:
    said: list[str] = []
    isolation = isolation or OfCluster()
    return cluster._Session(fake, iter(()), isolation, said.append), said  # type: ignore[arg-type]


def test_a_cluster_with_other_versions_is_refused_before_anything_is_sent_to_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    fake = Fake({"versions": {**installed_versions(), "ros_distro": "rolling"}})
    monkeypatch.setattr(cluster, "_connected", lambda *_: nullcontext(fake))
    other = "the worker at tcp://10.0.0.1:7 has other versions: ros_distro rolling, and "
    with pytest.raises(UsageError, match=other):
        list(cluster.work([], "tcp://10.0.0.1:8", print, OfCluster()))


@pytest.mark.parametrize("told", [{"versions": 3}, "hello", None], ids=str)
def test_a_worker_that_says_something_else_of_itself_is_refused(told: object) -> None:
    fake = Fake()
    fake.run = lambda *_, **__: {"tcp://10.0.0.1:7": told}  # type: ignore[method-assign]
    found, _ = session(fake)
    with pytest.raises(UsageError, match=r"the worker at tcp://10\.0\.0\.1:7 cannot grade"):
        found._check_workers()


BEST = {"isolation": "namespaces"}
LESS = {"isolation": "landlock"}
CANNOT = {"why": plain_text("unshare (user, net): Operation not permitted")}
AT_PRESENT = {"why": plain_text("no network of its own could be made"), "again": True}


@pytest.mark.parametrize(
    ("offers", "begun_at", "level", "unfit"),
    [
        ([BEST, BEST], "", "namespaces", []),
        ([LESS, BEST, LESS], "", "namespaces", [1, 3]),
        ([LESS, AT_PRESENT], "", "landlock", []),  # it may be fit for the next task
        ([BEST, CANNOT], "namespaces", "namespaces", [2]),
    ],
)
def test_a_worker_that_does_not_offer_the_class_s_level_gets_no_task_and_is_named(
    offers: list[dict[str, Any]], begun_at: str, level: str, unfit: list[int]
) -> None:
    settled: list[str] = []
    isolation = OfCluster(begun_at, "", settled.append)
    found, said = session(Fake(*offers), isolation)
    found._check_workers()
    assert isolation.level == level
    assert settled == ([] if begun_at else [level])
    assert [f"tcp://10.0.0.{n}:7" for n in unfit] == list(found._unfit)
    assert len(said) == len(unfit)
    for n, text in zip(unfit, said, strict=True):
        why = offers[n - 1].get("why") or "the best there is 'landlock'"
        told = "takes no hand-in: this class is graded with isolation by namespaces"
        assert str(text) == f"The worker at tcp://10.0.0.{n}:7 {told} ({why!s})."


@pytest.mark.parametrize(
    ("offers", "isolation"),
    [
        ([LESS, LESS], OfCluster(least="namespaces")),
        ([CANNOT, CANNOT], OfCluster("namespaces")),
        ([CANNOT], OfCluster(least="namespaces")),
    ],
)
def test_where_no_worker_offers_the_level_nothing_is_graded(
    offers: list[dict[str, Any]], isolation: OfCluster
) -> None:
    found, _ = session(Fake(*offers), isolation)
    with pytest.raises(UsageError, match="no worker of the cluster offers isolation by namespaces"):
        found._check_workers()


def test_a_task_that_ended_its_workers_is_answered_as_failed() -> None:
    found, _ = session(Fake())
    ended = KilledWorker("task", None, 1)
    answer = found._failure(ended)
    told = "2 workers of the cluster ended while grading it"
    assert (answer.state, str(answer.message)) == ("failed", told)
    answer = found._failure(ValueError("x"))
    assert (answer.state, str(answer.message)) == ("failed", "a worker failed: ValueError: x")


def test_what_is_no_address_is_told() -> None:
    with pytest.raises(UsageError, match="nonsense is no address of a scheduler"):
        list(cluster.work([], "nonsense", print, OfCluster()))


def test_where_there_is_no_scheduler_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cluster, "FIRST_S", 0.5)
    with pytest.raises(UsageError, match=r"there is no scheduler at .*:9"):
        list(cluster.work([], "tcp://127.0.0.1:9", print, OfCluster()))
