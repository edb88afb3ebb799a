"""A class on a Dask cluster: what is asked of workers, and whoever dies, each is graded."""

import gc
import json
import subprocess
import sys
import time
from concurrent.futures import Future
from contextlib import ExitStack
from dataclasses import replace

import psutil
import pytest

from grader.errors import NotOffered, UsageError
from grader.run.processes import levels
from grader_class import class_file, cluster, pool
from grader_class.cluster import Terms
from grader_class.pool import Answer, Task
from tests.grader_class.classes import DEADLINE_S, ENV, command, told
from tests.programs import ROOT


def start(what, folder, *words):
    """Start a scheduler, or a worker that grades one at a time."""
    module = (sys.executable, "-m", f"distributed.cli.dask_{what}", "--host", "127.0.0.1")
    with (folder / "log.txt").open("ab") as log:
        return psutil.Popen(
            [*module, "--no-dashboard", *words],
            env={**ENV, "DASK_TEMPORARY_DIRECTORY": str(folder)},
            cwd=folder,
            stdout=log,
            stderr=log,
        )


def is_grading(worker):
    try:
        return any("grader_class" in word for p in worker.children() for word in p.cmdline())
    except psutil.Error:  # others come and go while a worker starts
        return False


@pytest.mark.more("a scheduler in this process stands for it, and units for workers that die")
@pytest.mark.timeout(600)
def test_two_workers_grade_as_one_machine_does_also_if_one_dies_in_the_middle(
    small_class, graded, tmp_path
):
    file = tmp_path / "scheduler.json"
    with ExitStack() as stack:

        def started(what, *words):
            process = start(what, tmp_path, "--scheduler-file", str(file), *words)
            stack.callback(process.wait)
            stack.callback(process.kill)
            return process

        started("scheduler", "--port", "0", "--no-show")
        while not file.exists() or not file.read_text().endswith("}"):
            time.sleep(0.02)
        own = ("--nthreads", "1", "--no-nanny")
        first = started("worker", *own)
        words = (*small_class.words(tmp_path / "out"), "--scheduler")
        address = json.loads(file.read_text())["address"]
        call = subprocess.Popen(command(*words, address), env=ENV, stderr=subprocess.PIPE)
        with call:
            while not is_grading(first) and call.poll() is None:
                time.sleep(0.02)
            first.kill()
            for _ in range(2):
                started("worker", *own)
            said = call.communicate(timeout=DEADLINE_S)[1].decode()
    assert call.returncode == 0, said
    assert told(tmp_path / "out") == told(graded)
    assert list((tmp_path / "out").glob(".unfinished")) == []


@pytest.mark.more("a cluster of the tests' own proves the same")
@pytest.mark.timeout(600)
def test_the_example_of_one_machine_grades_as_without_a_cluster(small_class, graded, tmp_path):
    script = ROOT / "examples" / "batch" / "one_machine.sh"
    done = subprocess.run(
        [script, *map(str, small_class.words(tmp_path / "out"))],
        cwd=tmp_path,
        env={**ENV, "PYTHON": sys.executable},
        text=True,
        capture_output=True,
        timeout=DEADLINE_S,
    )
    assert done.returncode == 0, done.stderr
    assert told(tmp_path / "out") == told(graded)


class Client:
    def __init__(self, *offers):
        self.offers = {f"tcp://10.0.0.{n}:7": offer for n, offer in enumerate(offers, 1)}

    def nthreads(self):
        return dict.fromkeys(self.offers, 1)

    def submit(self, _, terms, workers, pure):
        future = Future()
        offer = self.offers[workers[0]]
        if isinstance(offer, str):
            future.set_result(offer)
        else:
            future.set_exception(offer)
        return future


@pytest.fixture
def terms(tmp_path, monkeypatch):
    monkeypatch.setattr("distributed.get_worker", lambda: type("Worker", (), {"address": "box"}))
    monkeypatch.setattr(levels, "here", lambda level: levels.Level(level or "landlock"))
    (tmp_path / "place").mkdir()
    (tmp_path / "handed_in").mkdir()
    return Terms(tmp_path, tmp_path / "place", (tmp_path / "handed_in",))


def test_a_worker_that_can_grade_the_class_says_how_well_it_isolates(terms):
    assert cluster.offer(terms) == "landlock"
    assert cluster.offer(replace(terms, level="limits")) == "limits"


def test_a_worker_that_cannot_grade_the_class_is_refused(terms, monkeypatch):
    for place in (terms.place, *terms.inputs):
        place.rmdir()
        with pytest.raises(UsageError, match=rf"box cannot see {place}, or not write there\. Put"):
            cluster.offer(terms)
        place.mkdir()

    def refuse(_):
        raise NotOffered("no namespaces here")

    monkeypatch.setattr(levels, "here", refuse)
    with pytest.raises(UsageError, match=r"box cannot isolate .* asks: no namespaces here"):
        cluster.offer(terms)
    monkeypatch.setenv("ROS_DISTRO", "rolling")
    with pytest.raises(UsageError, match="the worker at box has other versions: ros_distro roll"):
        cluster.offer(terms)


def test_a_class_has_the_best_level_that_all_workers_offer_or_the_worker_is_named(terms):
    workers = Client("namespaces", "landlock", "namespaces")
    assert cluster._agreed(workers, terms, "").level == "landlock"
    with pytest.raises(UsageError, match="a worker of the cluster offers isolation by landlock"):
        cluster._agreed(workers, terms, "namespaces")
    missing = ModuleNotFoundError("No module named 'grader'")
    with pytest.raises(UsageError, match=r"worker at tcp://10\.0\.0\.2:7 cannot grade \(No modul"):
        cluster._agreed(Client("landlock", missing), terms, "")


@pytest.fixture
def asked(monkeypatch):
    """What the process of a worker is asked, and does at once, but for the task `broken`."""
    tasks = []

    class Process:
        def done(self, task):
            tasks.append(task)
            if task.key == "broken":
                raise RuntimeError("boom")
            return Answer("done")

    monkeypatch.setattr(pool, "Process", Process)
    monkeypatch.delattr(cluster._of_thread, "process", raising=False)
    yield tasks
    monkeypatch.delattr(cluster._of_thread, "process", raising=False)


def a_task(terms, key="0"):
    (terms.place / key).mkdir()
    return Task(key, (), "square", "virtual", None, None, into=terms.place / key)


def test_a_task_of_which_two_workers_died_is_not_tried_again(terms, asked):
    task, terms = a_task(terms), replace(terms, level="limits")
    answers = [cluster.graded(task, terms) for _ in range(3)]
    places = [task.into / "1", task.into / "2"]
    assert [(each.into, each.isolation) for each in asked] == [(p, "limits") for p in places]
    assert answers[:2] == [(Answer("done"), place) for place in places]
    told_so = "2 workers of the cluster ended while grading it"
    assert (answers[2][0].state, str(answers[2][0].message)) == ("failed", told_so)


@pytest.mark.filterwarnings("ignore::ResourceWarning", "ignore::DeprecationWarning")
def test_each_task_comes_back_with_the_folder_that_its_worker_has_filled(terms, asked, monkeypatch):
    import dask
    from distributed import LocalCluster

    noted = []
    monkeypatch.setattr(class_file, "note", lambda _, level: noted.append(level))
    tasks = [a_task(terms, key) for key in ("a", "b", "broken")]
    one = {"n_workers": 1, "threads_per_worker": 1}
    with (
        dask.config.set({"temporary-directory": str(terms.out)}),
        LocalCluster(processes=False, dashboard_address=None, **one) as there,
    ):
        done = list(cluster.work(tasks, there.scheduler_address, terms, print))
    answers = {task.key: (task.into.name, answer.state) for task, answer in done}
    assert answers == {"a": ("1", "done"), "b": ("1", "done"), "broken": ("broken", "failed")}
    assert {each.isolation for each in asked} == {"landlock"} == {*noted}
    (why,) = (str(answer.message) for _, answer in done if answer.state == "failed")
    assert why == "a worker failed: RuntimeError: boom"


def test_what_is_no_address_of_a_scheduler_is_told(terms, monkeypatch):
    monkeypatch.setattr(cluster, "FIRST_S", 0.5)
    for address, why in (
        ("nonsense", "nonsense is no address of a scheduler"),
        ("tcp://127.0.0.1:9", r"there is no scheduler at .*:9"),
    ):
        with pytest.raises(UsageError, match=why) as error:
            list(cluster.work([], address, terms, print))
        # the client that could not start ends now: while another starts, Dask would wait for itself
        del error
        gc.collect()
