"""Nothing that a submission starts outlives its run."""

import os
import signal
import subprocess
import sys
import threading
import time
from ctypes import CDLL
from pathlib import Path

import psutil
import pytest
import yaml

from grader.run.processes import supervisor
from grader.run.processes.started_process import await_ends
from grader.system import linux, scratch
from tests.children import in_child
from tests.grader.run.processes.conftest import ROOT, UNPRIVILEGED
from tests.programs import ran

TEXTS = yaml.safe_load(Path(__file__).with_suffix(".yaml").read_text())


def sleeper(seconds: int) -> list[psutil.Process]:
    """The processes that sleep so long: the number tells whose they are."""
    found = psutil.process_iter(["cmdline"])
    return [p for p in found if p.info["cmdline"] == ["sleep", str(seconds)]]


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_a_signal_ends_a_grader_with_all_that_it_has(number):
    grader, student, folder, seconds = graded(700 + number)
    grader.send_signal(number)
    grader.communicate(timeout=20)
    assert not student.is_running()
    assert not sleeper(seconds)
    assert not folder.exists()


@pytest.mark.parametrize("prefix", [(), UNPRIVILEGED])
def test_a_killed_grader_takes_its_submission_along(prefix):
    grader, _, folder, seconds = graded(774, prefix)
    family = psutil.Process(grader.pid).children(recursive=True)
    grader.kill()
    grader.communicate()
    assert not await_ends(family, 20.0)
    assert not sleeper(seconds)
    with scratch.make_folder():  # the next run
        assert not folder.exists()


def graded(
    number: int, prefix: tuple[str, ...] = ()
) -> tuple[subprocess.Popen[str], psutil.Process, Path, int]:
    """A grader in the middle of its work; its submission, its folder, its hidden sleeper."""
    seconds = number * 1000 + os.getpid() % 1000
    grader = subprocess.Popen(
        [*prefix, sys.executable, "-c", TEXTS["grader"], TEXTS["hides"], str(seconds), "1000"],
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
        cwd=ROOT,
    )
    pid, folder = grader.stdout.readline().split()
    for _ in range(2000):
        if sleeper(seconds):
            break
    return grader, psutil.Process(int(pid)), Path(folder), seconds


def _walkers_are_ended() -> None:
    linux.control(linux.PR_SET_CHILD_SUBREAPER, 1)
    linux.signal_at_parents_death(signal.SIGKILL)
    for _ in range(10):
        if not os.fork():
            os.setsid()
            while True:
                if os.fork():
                    os._exit(0)
    supervisor.end_descendants()
    with pytest.raises(ChildProcessError):  # who is left would be our child
        os.waitpid(-1, os.WNOHANG)


def test_who_forks_and_ends_all_the_time_is_ended_as_well():
    in_child(_walkers_are_ended)


def _one_without_its_first_thread_is_ended() -> None:
    linux.signal_at_parents_death(signal.SIGKILL)
    child = os.fork()
    if not child:
        threading.Thread(target=time.sleep, args=(1000,)).start()
        CDLL(None).pthread_exit(None)
    while psutil.Process(child).status() != psutil.STATUS_ZOMBIE:
        time.sleep(0.001)
    supervisor.end_descendants()
    with pytest.raises(ChildProcessError):
        os.waitpid(-1, os.WNOHANG)


@pytest.mark.timeout(30)
def test_who_looks_like_one_that_is_over_is_ended_as_well():
    in_child(_one_without_its_first_thread_is_ended)


def test_a_process_whose_end_nobody_has_asked_for_has_ended():
    # a long patience: it ends with the process and not with that
    with subprocess.Popen(["true"]) as child:
        os.waitid(os.P_PID, child.pid, os.WEXITED | os.WNOWAIT)
        assert not await_ends([psutil.Process(child.pid)], 1000.0)


def test_what_it_held_is_given_back_at_its_end():
    looks = """
import gc, os, sys, threading
from grader.run.processes.fork_server_main import ProcessCommand
from grader.run.processes.started_process import SubmissionProcess
gc.disable()  # what knows itself would be found only by a search for garbage
for _ in range(2):
    before = set(os.listdir("/proc/self/fd"))
    SubmissionProcess(ProcessCommand([sys.executable, "-c", "pass"], os.environ)).end()
    for thread in set(threading.enumerate()) - {threading.main_thread()}:
        thread.join()  # who reads its output sees the end of it in its own time
print(set(os.listdir("/proc/self/fd")) - before)
"""
    words = [sys.executable, "-c", looks]
    done = ran(words, cwd=ROOT, check=True)
    assert done.stdout == "set()\n"
