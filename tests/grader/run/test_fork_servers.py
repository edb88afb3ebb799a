"""Runs that are forked from servers are those that start from nothing, only sooner."""

import os
import re
import signal
import subprocess
import sys
import threading
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import psutil
import pytest
import yaml

from grader.errors import GraderFailure
from grader.recording.recording import Recording
from grader.run import fork_servers, real_time, virtual_time
from grader.run.handover import Plan
from grader.run.opening import open_submission
from grader.run.processes import levels, network
from grader.scenes.scene import Limits
from tests.tiers import others_are_more

TEXTS = yaml.safe_load(Path(__file__).with_suffix(".yaml").read_text())

ROOT = Path(__file__).parents[3]
PLAN = Plan(Limits(first_motion_s=0.5, rest_s=0.2, total_s=5))


@pytest.fixture(scope="module", autouse=True)
def ended_afterwards():
    yield
    fork_servers.close()


@pytest.fixture
def fresh():
    """No server is there, and none is afterwards."""
    fork_servers.close()
    yield
    fork_servers.close()


@pytest.fixture
def forgiven():
    """The servers that a test has killed are not there afterwards, and count for nothing."""
    yield
    for side, each in list(fork_servers._servers.items()):
        if each._process.poll() is not None:
            fork_servers._servers.pop(side).close()
    fork_servers._losses.clear()


def forks() -> tuple[int, int]:
    """How many processes the servers have given."""
    sides = fork_servers.server(fork_servers.STUDENT), fork_servers.server(fork_servers.SIMULATOR)
    student, simulator = (0 if side is None else side.forks for side in sides)
    return student, simulator


def graded(text: str, folder: Path) -> Recording:
    script = folder / "submitted.py"
    script.write_text(text)
    with open_submission(script) as submission:
        return virtual_time.run(submission, PLAN)


def lines(recording: Recording) -> list[str]:
    """What it has printed; lines that rclpy's C++ logs carry the time of the machine."""
    return re.sub(r"\[\d+\.\d{9}\]", "[when]", recording.output).splitlines()


def cold(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(fork_servers, "server", lambda side: None)


#: Where these are refused, a run is kept apart by less.
REFUSED = [
    ("the best", set()),
    ("user namespace", {network._as_root}),
    ("ROS domain", {network._as_root, network._as_user}),
]


@pytest.mark.parametrize(
    ("apart", "refused"),
    others_are_more("keeping apart is tested in test_network", REFUSED, "the best"),
)
def test_a_forked_submission_finds_all_that_a_started_one_does(
    tmp_path, monkeypatch, apart, refused
):
    monkeypatch.setattr(network, "_refused", set(refused))
    monkeypatch.setattr(levels, "_found", {})
    # the same for both runs, and none that any other grader takes
    monkeypatch.setattr(network, "DOMAINS", (39,))
    before = forks()
    forked = graded(TEXTS["portrait"], tmp_path)
    assert [now - then for now, then in zip(forks(), before, strict=True)] == [1, 1]
    cold(monkeypatch)
    started = graded(TEXTS["portrait"], tmp_path)
    assert started.run.exit_code == 0, started.output
    assert lines(forked) == lines(started)
    assert forked.run.trace_sha256 == started.run.trace_sha256
    assert (forked.run.time, forked.run.flags) == ("virtual", ())
    assert forked.run.isolation == started.run.isolation


OWN = ("numpy.py", "std_msgs/__init__.py", "geometry_msgs.py", "zlib.py", "lib/std_srvs.py")


@pytest.mark.parametrize(
    "own", others_are_more("a package stands for the others", OWN, "std_msgs/__init__.py")
)
def test_a_submission_s_own_module_is_what_it_imports(tmp_path, monkeypatch, own):
    folder = tmp_path / "submission"
    (folder / own).parent.mkdir(parents=True, exist_ok=True)
    (folder / own).write_text("MINE = 'mine'\n")
    name = own.partition("/")[0].removesuffix(".py") if "lib/" not in own else "std_srvs"
    (folder / "main.py").write_text(
        "import os, sys; sys.path.insert(0, os.path.join(os.path.dirname(__file__), 'lib'))\n"
        f"import {name}; print(getattr({name}, 'MINE', 'installed'))\n"
    )
    # rclpy has loaded numpy before, however it was started
    expected = "installed\n" if name == "numpy" else "mine\n"
    with open_submission(folder, "main") as submission:
        assert virtual_time.run(submission, PLAN).output == expected
        if name == "numpy":
            cold(monkeypatch)
            assert virtual_time.run(submission, PLAN).output == expected


def test_runs_side_by_side_share_the_servers(tmp_path, fresh):
    def one(number: int) -> str:
        folder = tmp_path / str(number)
        folder.mkdir()
        return graded(f"print({number})", folder).output

    with ThreadPoolExecutor(3) as pool:
        assert list(pool.map(one, range(3))) == ["0\n", "1\n", "2\n"]
    assert forks() == (3, 3)
    # those who have asked first are gone
    assert graded("print(4)", tmp_path).output == "4\n"
    assert forks() == (4, 4)


SIDES = (fork_servers.STUDENT, fork_servers.SIMULATOR)


@pytest.mark.parametrize("side", others_are_more("as the student's", SIDES, fork_servers.STUDENT))
def test_a_server_that_dies_costs_a_start_and_nothing_else(tmp_path, forgiven, side):
    fork_servers.warm()
    first = fork_servers._servers[side]
    first.preloaded()
    os.kill(first.pid, signal.SIGKILL)
    first._process.wait()
    assert graded("print('here')", tmp_path).output == "here\n"
    assert graded("print('again')", tmp_path).output == "again\n"
    second = fork_servers._servers[side]
    assert second is not first
    assert second.forks >= 1


@pytest.mark.parametrize("side", others_are_more("as the student's", SIDES, fork_servers.STUDENT))
def test_a_server_that_dies_in_the_middle_of_a_run_is_the_grader_s_failure(
    tmp_path, monkeypatch, forgiven, side
):
    # what is confined better does not reach the pipe
    monkeypatch.setattr(levels, "best", lambda isolated: levels.Level("limits"))
    pipe = tmp_path / "up"
    os.mkfifo(pipe)
    # in virtual time it wakes up when the simulator is there
    text = f"import time; time.sleep(0.1); open({str(pipe)!r}, 'w').close()\nwhile True: pass"
    with ThreadPoolExecutor(1) as pool:
        run = pool.submit(graded, text, tmp_path)
        pipe.read_bytes()
        os.kill(fork_servers._servers[side].pid, signal.SIGKILL)
        with pytest.raises(GraderFailure):
            run.result()


@pytest.mark.more("test_fork_server has one that never comes up")
@pytest.mark.parametrize("side", SIDES)
def test_a_server_that_never_comes_up_is_given_up(tmp_path, monkeypatch, fresh, side):
    started = []
    original = fork_servers.ForkServer

    def broken(command: list[str], env: dict[str, str], *more: str) -> object:
        if (command == fork_servers.command(side)) is False:
            return original(command, env, *more)
        started.append(1)
        return original([sys.executable, "-S", "-c", "raise SystemExit(1)"], env)

    monkeypatch.setattr(fork_servers, "MOST_LOSSES", 1)
    monkeypatch.setattr(fork_servers, "ForkServer", broken)
    for number in range(fork_servers.MOST_LOSSES + 1):
        assert graded(f"print({number})", tmp_path).output == f"{number}\n"
    assert len(started) == fork_servers.MOST_LOSSES
    assert fork_servers.server(side) is None


def test_a_changed_environment_is_another_server_s(tmp_path, monkeypatch, fresh):
    says = "import os; print(os.environ.get('TZ'))"
    monkeypatch.delenv("TZ", raising=False)
    assert graded(says, tmp_path).output == "None\n"
    before = list(fork_servers._servers.values())
    monkeypatch.setenv("MY_OWN", "1")  # which no run would see
    assert graded(says, tmp_path).output == "None\n"
    assert list(fork_servers._servers.values()) == before
    monkeypatch.setenv("TZ", "Asia/Tokyo")
    assert graded(says, tmp_path).output == "Asia/Tokyo\n"
    assert not set(before) & set(fork_servers._servers.values())
    for each in before:
        each._process.wait(20)


@pytest.mark.parametrize("path", ["relative:/opt/ros", ":/opt/ros"])
def test_there_is_none_where_the_import_path_depends_on_the_folder(monkeypatch, path):
    monkeypatch.setenv("ROS_DISTRO", "jazzy")
    monkeypatch.setenv("PYTHONPATH", path)
    assert fork_servers.server(fork_servers.STUDENT) is None


def printed(code: str) -> str:
    """What a program prints that has the servers' module as `servers`."""
    head = f"import os, sys, threading\nsys.path.insert(0, {str(ROOT)!r})\n"
    head += "from grader.run import fork_servers as servers\n"
    words = [sys.executable, "-c", head + code]
    return subprocess.run(words, stdout=subprocess.PIPE, check=True, cwd=ROOT, text=True).stdout


def test_a_fork_of_the_grader_has_servers_of_its_own():
    printed("""
servers.warm()
ours = {side.pid for side in servers._servers.values()}
child = os.fork()
if not child:
    assert not servers._servers
    theirs = {servers.server(side).pid for side in ("student", "simulator")}
    assert servers.server("student").preloaded()
    servers.close()
    os._exit(bool(ours & theirs))
assert os.waitpid(child, 0)[1] == 0
assert servers.server("student").preloaded()
assert {side.pid for side in servers._servers.values()} == ours
""")


def test_servers_end_with_the_program_that_has_graded_and_import_nothing_heavy_into_it():
    pids, heavy = printed("""
thread = threading.Thread(target=servers.warm)
thread.start()
thread.join()
print(*(side.pid for side in servers._servers.values()))
print(*sorted({"numpy", "backports", "rclpy", "PIL", "yaml", "rich"} & set(sys.modules)))
""").splitlines()
    assert len(pids.split()) == 2
    assert not any(psutil.pid_exists(int(pid)) for pid in pids.split())
    assert heavy == ""


@pytest.mark.more("a run in real time")
def test_in_real_time_the_simulator_alone_is_forked(tmp_path):
    fork_servers.warm()
    before = forks()
    (tmp_path / "submitted.py").write_text("print('here')")
    with open_submission(tmp_path / "submitted.py") as submission:
        assert real_time.run(submission, PLAN).output == "here\n"
    assert forks() == (before[0], before[1] + 1)


def test_no_thread_of_ours_stays_behind(tmp_path):
    graded("print(1)", tmp_path)
    before = threading.active_count()
    graded("print(1)", tmp_path)
    assert threading.active_count() <= before
