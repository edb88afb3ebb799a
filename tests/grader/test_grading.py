"""Grading from a program: nothing of its process changes, and nothing is left behind."""

import asyncio
import os
import subprocess
import sys
import threading
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from pathlib import Path

import psutil
import pytest

import grader
from grader.errors import ExerciseError, GraderFailure, UsageError
from grader.run import fork_servers
from grader.system import content
from tests.tiers import others_are_more

ROOT = Path(__file__).parents[2]
TIMES = others_are_more("in real time the same is said", ("virtual", "real"), "virtual")
DRIVES = """
import rclpy
from geometry_msgs.msg import Twist
rclpy.init()
node = rclpy.create_node("node")
pub = node.create_publisher(Twist, "/turtle1/cmd_vel", 10)
twist = Twist()
twist.linear.x = 1.0
pub.publish(twist)
rclpy.spin(node)
"""
SHORT = """
exercise: turtlesim_challenge
limits: {first_motion_s: 2, rest_s: 0.5, total_s: 5}
varied_runs: {count: 0}
points: {moves: 5}
"""
#: What a process is before and after it grades.
WATCHES = """
import ctypes, json, os, signal, sys, threading
import grader
from grader.run import fork_servers
from grader.run.processes import started_process

def state():
    adopts = ctypes.c_int()
    ctypes.CDLL(None).prctl(37, ctypes.byref(adopts))  # PR_GET_CHILD_SUBREAPER
    handlers = [str(signal.getsignal(number)) for number in signal.valid_signals()]
    masked = sorted(signal.pthread_sigmask(signal.SIG_BLOCK, []))
    cores = sorted(os.sched_getaffinity(0))
    return [adopts.value, handlers, masked, os.getcwd(), dict(os.environ), sys.path, cores,
            sys.dont_write_bytecode, sorted(os.listdir("/proc/self/fd"))]

before = state()
result = []
grade = lambda: result.append(grader.grade(sys.argv[1], sys.argv[2]))
thread = threading.Thread(target=grade)
thread.start()
grade()
thread.join()
fork_servers.close()  # which wait for the next grading
assert state() == before, (before, state())
print(len(result))
"""


@pytest.fixture
def short(tmp_path):
    """An exercise whose runs are short, with one run each."""
    path = tmp_path / "short.yaml"
    path.write_text(SHORT)
    return path


@pytest.fixture
def drives(tmp_path):
    path = tmp_path / "drives.py"
    path.write_text(DRIVES)
    return path


def test_grading_changes_nothing_of_the_process_that_asks_for_it(short, drives, tmp_path):
    done = subprocess.run(
        [sys.executable, "-c", WATCHES, drives, short],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(ROOT), "PYTHONSAFEPATH": "1"},
        capture_output=True,
        text=True,
    )
    assert done.stdout == "2\n", done.stderr


def test_it_works_under_asyncio(short, drives):
    async def both() -> list[grader.Result]:
        gradings = [asyncio.to_thread(grader.grade, drives, short) for _ in range(2)]
        return await asyncio.gather(*gradings)

    first, second = asyncio.run(both())
    assert first.verdicts == second.verdicts
    assert first.run.trace_sha256 == second.run.trace_sha256


def test_recordings_can_be_had_kept_and_judged_again(short, drives, tmp_path):
    with grader.open_submission(drives) as submission:  # it may be open already
        recordings = grader.record(submission, short, time="virtual")
    result = grader.judge(recordings, short, submission="drives.py")
    assert (result.score, result.submission) == (5, "drives.py")
    grader.save_recordings(recordings, tmp_path / "kept")
    again = grader.judge(grader.load_recordings(tmp_path / "kept"), grader.load_exercise(short))
    assert again.verdicts == result.verdicts
    recorded = again.provenance.recorded
    assert recorded == result.provenance.recorded == recordings.nominal.provenance
    assert recorded.submission_sha256 == content.of_files({"drives.py": content.of_file(drives)})
    assert (recorded.submission, recorded.seed) == ("drives.py", None)
    assert recorded.exercise_sha256 == again.provenance.judged.exercise_sha256
    assert recorded.conditions["limits.total_s"] == 5


def test_what_cannot_be_used_is_told(drives, short):
    with pytest.raises(grader.GraderError):
        grader.grade("no/such/file.py")
    with pytest.raises(ExerciseError):
        grader.grade(drives, "chess")
    with pytest.raises(UsageError, match="time: expected one of"):
        grader.grade(drives, short, time="slow")  # type: ignore[arg-type]
    for seed in ("a", 1.5, True):
        with pytest.raises(UsageError, match="seed: expected a whole number"):
            grader.grade(drives, seed=seed)  # type: ignore[arg-type]


@pytest.mark.parametrize("time", TIMES)
def test_a_path_in_an_error_is_that_of_what_was_handed_in(short, tmp_path, time):
    path = tmp_path / "reads.py"
    path.write_text("from pathlib import Path\nopen(Path(__file__).with_name('gains.yaml'))\n")
    diagnosis = grader.grade(path, short, time=time).diagnosis
    assert diagnosis is not None
    assert f"{tmp_path}/gains.yaml" in str(diagnosis.cause)


@pytest.mark.parametrize("time", ["virtual", "real"])
def test_nothing_outlives_a_grading_whose_simulator_dies(short, tmp_path, time):
    seconds = str(780_000 + os.getpid() % 1000)
    path = tmp_path / "hides.py"
    path.write_text(
        "import subprocess, time\n"
        f"subprocess.Popen(['sleep', '{seconds}'], start_new_session=True)\n"
        "while True: time.sleep(1)\n"
    )
    before = set(psutil.Process().children(recursive=True))
    over = threading.Event()

    def graded() -> None:
        try:
            grader.grade(path, short, time=time)
        finally:
            over.set()

    with ThreadPoolExecutor(1) as pool:
        task = pool.submit(graded)
        while not over.is_set():
            for process in psutil.Process().children(recursive=True):
                if any("grader.run.simulator" in word for word in words(process)):
                    with suppress(psutil.NoSuchProcess):  # it has ended by itself
                        process.kill()
        with pytest.raises(GraderFailure, match="the simulator"):
            task.result()
    assert not [p for p in psutil.process_iter() if words(p) == ["sleep", seconds]]
    fork_servers.close()  # which wait for the next grading
    assert set(psutil.Process().children(recursive=True)) <= before


def words(process: psutil.Process) -> list[str]:
    try:
        return process.cmdline()
    except psutil.Error:
        return []


LAZY = """
import sys
import grader
assert not {"numpy", "yaml", "psutil", "rich"} & set(sys.modules), sorted(sys.modules)
from grader import *
assert all(name in globals() for name in grader.__all__)
try:
    grader.nonsense
except AttributeError:
    print("well")
"""


def test_importing_it_costs_nothing_until_something_is_asked_for():
    env = {**os.environ, "PYTHONPATH": str(ROOT)}
    done = subprocess.run([sys.executable, "-c", LAZY], env=env, capture_output=True, text=True)
    assert done.stdout == "well\n", done.stderr


#: Prints whether a run's thread finds the modules that the look at the package needs as well.
LOADED = """
import sys
from grader import grading
from grader.run.handover import Plan

def run(submission, plan, progress=None):
    print("grader.submission.subject" in sys.modules)

with grading.start(None, [Plan(None, scene="robot", looks_at_package=True)], run):
    pass
"""


def test_what_two_threads_need_is_imported_before_they_begin():
    done = subprocess.run(
        [sys.executable, "-c", LOADED], capture_output=True, text=True, check=True, timeout=60
    )
    assert done.stdout == "True\n"
