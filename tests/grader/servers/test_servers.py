"""Servers that outlive a call: the same verdicts, nothing shared, and only for who may."""

from __future__ import annotations

import json
import os
import re
import secrets
import signal
import socket
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import SimpleNamespace

import psutil
import pytest

ROOT = Path(__file__).parents[3]
SUBMISSIONS = ROOT / "tests" / "submissions"
QUICK = SUBMISSIONS / "quick_spiral.py"
COLD = "The servers do not do this call: "
#: Draws what it does from hashes, from the order of a set and from addresses.
DRAWS = """
import rclpy
from geometry_msgs.msg import Twist

def main():
    rclpy.init()
    node = rclpy.create_node("draws")
    publisher = node.create_publisher(Twist, "/turtle1/cmd_vel", 10)
    words = {f"word {number}" for number in range(50)}
    drawn = [hash("a word") % 1000, *map(len, words), id(object()) % 7, hash(next(iter(words))) % 9]
    drawn += [hash(each) % 5 for each in words]
    count = 0
    def act():
        nonlocal count
        twist = Twist()
        twist.linear.x = (drawn[count % len(drawn)] % 100) / 50.0
        twist.angular.z = count / 10.0
        publisher.publish(twist)
        count += 1
        if count == 40:
            raise SystemExit
    node.create_timer(0.1, act)
    rclpy.spin(node)
"""


class User:
    """Somebody who calls `grader` in a shell, with a place for the servers that nobody else has."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.place = folder / f"turtlesim-grader-{os.getuid()}" / "servers"
        self.env = {**os.environ, "TMPDIR": str(folder), "PYTHONPATH": str(ROOT)}
        self.command = [sys.executable, "-P", "-m", "grader"]

    def __call__(self, *words: str | Path, **env: str) -> subprocess.CompletedProcess[str]:
        command = [*self.command, *map(str, words)]
        options = {"cwd": self.folder, "env": {**self.env, **env}}
        return subprocess.run(command, capture_output=True, text=True, **options)

    def begins(self, *words: str | Path) -> subprocess.Popen[str]:
        command = [*self.command, *map(str, words)]
        pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
        return subprocess.Popen(command, cwd=self.folder, env=self.env, text=True, **pipes)

    def graded(self, submission: Path, *words: str) -> SimpleNamespace:
        """Grade, and return what is the same in each grading."""
        out = self.folder / f"out-{secrets.token_hex(4)}"
        done = self("run", submission, "--out", out, *words)
        assert done.returncode == 0, done.stderr
        result = json.loads((out / "result.json").read_text())
        runs = [result["run"], *result["varied_runs"]]
        said = done.stdout.replace(str(out), "OUT")
        return SimpleNamespace(
            hashes=[run["trace_sha256"] for run in runs],
            verdicts=[(each["check"], each["score"]) for each in result["verdicts"]],
            isolation=result["run"]["isolation"],
            said=[line for line in said.splitlines() if not line.startswith("Run: ")],
            is_cold=COLD in done.stderr,
        )

    def calls(self) -> int:
        """So many the servers have done."""
        status = self("servers", "status")
        assert status.returncode == 0, status.stdout + status.stderr
        return int(re.findall(r"Calls so far: (\d+)", status.stdout)[0])

    def pid(self) -> int:
        """The process id of the servers."""
        return int(re.findall(r"process (\d+)", self("servers", "status").stdout)[0])


@contextmanager
def started(folder: Path, *words: str, **env: str) -> Iterator[User]:
    """Start servers, and stop them."""
    user = User(folder)
    user.env.update(env)
    done = user("servers", "start", *words)
    assert done.returncode == 0, done.stderr
    try:
        yield user
    finally:
        user("servers", "stop")
        gone_within(user.place)


def gone_within(place: Path) -> None:
    """Wait until the servers have ended: their folder goes last."""
    lock = place.parent / "servers.lock"
    subprocess.run(["flock", str(lock), "true"], timeout=90, check=True)
    assert not list(place.glob("*"))


@pytest.fixture(scope="module")
def user(tmp_path_factory: pytest.TempPathFactory) -> Iterator[User]:
    with started(tmp_path_factory.mktemp("s")) as made:
        yield made


def test_first_second_and_later_verdicts_are_those_of_a_call_without_servers(user, tmp_path):
    draws = tmp_path / "draws.py"
    draws.write_text(DRAWS)
    before = user.calls()
    for submission in (QUICK, draws):
        cold = cold_of(user, submission)
        first = user.graded(submission)
        user.graded(SUBMISSIONS / "styles" / "timer.py")
        second = user.graded(submission)
        assert first == second == cold
        assert first.hashes
        assert not first.is_cold
    assert user.calls() == before + 6


def cold_of(user: User, submission: Path) -> SimpleNamespace:
    """Grade without the servers."""
    alone = User(user.folder)
    alone.env["GRADER_SERVERS"] = "off"
    return alone.graded(submission)


@pytest.mark.parametrize(
    ("words", "code"),
    [
        (("run", QUICK, "--fail-under", "101"), 1),
        (("run", "not_there.py"), 2),
        (("run", QUICK, "--nonsense"), 2),
        (("check", "not_there"), 2),
    ],
)
def test_a_call_has_the_exit_code_and_the_words_that_it_has_alone(user, words, code):
    done, alone = user(*words), user(*words, GRADER_SERVERS="off")
    assert done.returncode == alone.returncode == code
    assert done.stderr.splitlines()[-1:] == alone.stderr.splitlines()[-1:]


def test_a_call_has_its_own_folder_umask_variables_and_input(user, tmp_path):
    (tmp_path / "spiral.py").write_bytes(QUICK.read_bytes())
    script = 'umask 077; cd "$1"; shift; "$@" 2>said </dev/null >printed'
    words = ["sh", "-c", script, "sh", str(tmp_path), *user.command, "run", "spiral.py"]
    subprocess.run(words, env={**user.env, "LANGUAGE": "fr"}, check=True)
    assert "100 sur 100" in (tmp_path / "printed").read_text()
    result = tmp_path / "graded" / "spiral.py" / "result.json"
    assert result.stat().st_mode & 0o777 == 0o600


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGKILL])
def test_who_ends_a_call_ends_what_it_has_begun(user, number):
    submission = user.folder / "endless.py"
    submission.write_text("while True:\n    pass\n")
    server = psutil.Process(user.pid())
    before = set(server.children())
    process = user.begins("run", submission, "--time", "real")
    assert process.stderr is not None
    while "Running it" not in process.stderr.readline():
        pass
    (call,) = set(server.children()) - before
    process.send_signal(number)
    process.communicate(timeout=90)
    assert process.returncode == (-signal.SIGKILL if number == signal.SIGKILL else 130)
    psutil.wait_procs([call], timeout=90)
    assert not call.is_running()
    assert user.graded(QUICK).verdicts


def test_help_is_that_of_a_call_alone(user):
    done, alone = user("run", "--help"), user("run", "--help", GRADER_SERVERS="off")
    assert (done.returncode, done.stdout, done.stderr) == (0, alone.stdout, "")


def test_a_call_with_a_closed_stream_or_other_limits_is_graded_without_them(user, tmp_path):
    before = user.calls()
    closed = ["sh", "-c", 'exec "$@" 0<&-', "sh", *user.command]
    limited = ["sh", "-c", 'ulimit -n 200; nice -n 1 "$@"', "sh", *user.command]
    for name, command in (("closed", closed), ("limited", limited)):
        words = [*command, "run", str(QUICK), "--out", str(tmp_path / name)]
        done = subprocess.run(words, env=user.env, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        assert (COLD + "they were started with another" in done.stderr) == (name == "limited")
        assert "100 of 100" in done.stdout
    assert user.calls() == before


def test_several_calls_at_once_are_graded_as_one(user):
    alone = user.graded(QUICK)
    outs = [user.folder / f"at-once-{number}" for number in range(3)]
    calls = [user.begins("run", QUICK, "--out", out) for out in outs]
    assert [call.communicate() and call.returncode for call in calls] == [0, 0, 0]
    for out in outs:
        result = json.loads((out / "result.json").read_text())
        assert result["run"]["trace_sha256"] == alone.hashes[0]


@pytest.mark.parametrize("value", ["off", "0", "No"])
def test_servers_are_off_where_that_is_set(user, value):
    before = user.calls()
    assert user("run", "not_there.py", GRADER_SERVERS=value).returncode == 2
    assert user.calls() == before
    assert user("servers", "start", GRADER_SERVERS=value).returncode == 2


def test_a_call_in_another_environment_is_cold_and_says_so(user):
    done = user("run", QUICK, "--fail-under", "100", ROS_DISTRO="")
    assert f"{COLD}they were started with another ROS_DISTRO" in done.stderr
    assert done.returncode == 0


def test_others_are_not_started_beside_them(user):
    done = user("servers", "start")
    assert done.returncode == 2
    assert "there are servers already" in done.stderr


def test_who_has_no_token_gets_nothing(user):
    before = user.calls()
    folder = os.open(user.place, os.O_RDONLY)
    for request in (b"", b"{", b"[]", b'{"token": "0", "ask": "stop"}', b'{"ask": "stop"}'):
        with socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET) as peer:
            peer.connect(f"/proc/self/fd/{folder}/socket")
            file = os.memfd_create("request")
            os.write(file, request)
            socket.send_fds(peer, [b"request"], [file])
            os.close(file)
            answer = peer.recv(4096)
            assert not answer or "refused" in json.loads(answer)
    reading, writing = os.pipe()  # which would be read for ever
    silent = [socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET) for _ in range(20)]
    for peer in silent:
        peer.connect(f"/proc/self/fd/{folder}/socket")
    socket.send_fds(silent[-1], [b"request"], [reading])
    assert silent[-1].recv(4096) == b""
    assert user.calls() == before
    for peer in silent:
        peer.close()
    for fd in (reading, writing, folder):
        os.close(fd)


def test_their_files_are_this_users_alone(user):
    assert user.place.stat().st_mode & 0o777 == 0o700
    assert {each.name: each.stat().st_mode & 0o777 for each in user.place.iterdir()} == {
        "socket": 0o600,
        "token": 0o600,
    }


def test_a_change_of_what_they_have_loaded_ends_them(tmp_path):
    library = tmp_path / "library"
    library.mkdir()
    with started(tmp_path, PYTHONPATH=f"{ROOT}:{library}") as user:
        assert not user.graded(QUICK).is_cold
        for name in (".cache", "graded"):  # nothing that Python would import
            (library / name).mkdir()
        (library / "notes.txt").touch()
        assert not user.graded(QUICK).is_cold
        (library / "new.py").touch()
        assert f"{library} has changed" in user("servers", "status").stdout
        assert user.graded(QUICK).is_cold
        gone_within(user.place)
        assert not user.graded(QUICK).is_cold  # nobody claims to be there
        assert user("servers", "status").returncode == 1


def test_they_end_when_nobody_calls(tmp_path):
    with started(tmp_path, "--idle", "0.01") as user:
        gone_within(user.place)
        assert user("servers", "status").stdout == "No servers run.\n"


def test_stop_waits_for_the_calls_that_go_on(tmp_path):
    with started(tmp_path) as user:
        call = user.begins("run", QUICK, "--out", tmp_path / "out")
        assert call.stderr is not None
        while "Running it" not in call.stderr.readline():
            pass
        assert "that go on: 1." in user("servers", "stop").stdout
        assert "going on: 1" in user("servers", "status").stdout
        assert f"{COLD}they are ending" in user("run", "not_there.py").stderr
        assert "100 of 100" in call.communicate()[0]
        assert call.returncode == 0
        gone_within(user.place)


def test_stop_returns_when_they_have_ended(tmp_path):
    with started(tmp_path) as user:
        server = psutil.Process(user.pid())
        family = [server, *server.children()]
        assert user("servers", "stop").stdout == "They have ended.\n"
        zombie = psutil.STATUS_ZOMBIE
        assert all(not each.is_running() or each.status() == zombie for each in family)
        assert user("servers", "stop").stdout == "No servers run.\n"


def test_where_they_are_killed_the_next_call_is_cold(tmp_path):
    with started(tmp_path) as user:
        server = psutil.Process(user.pid())
        family = [server, *server.children(recursive=True)]
        server.kill()
        psutil.wait_procs(family, timeout=90)
        assert not any(each.is_running() for each in family)
        assert user.graded(QUICK).verdicts
        assert user("servers", "start").returncode == 0


def test_a_call_that_is_lost_with_them_says_so(tmp_path):
    with started(tmp_path) as user:
        call = user.begins("run", QUICK, "--time", "real")
        assert call.stderr is not None
        while "Running it" not in call.stderr.readline():
            pass
        psutil.Process(user.pid()).kill()
        said = call.communicate()[1]
        assert call.returncode == 3
        assert "the servers, or the process of this call, were ended; call again" in said
        assert user("servers", "start").returncode == 0  # what was left is no hindrance


def test_servers_whose_socket_was_removed_end_by_themselves(tmp_path):
    with started(tmp_path) as user:
        (user.place / "socket").unlink()
        assert user("servers", "status").stdout == "No servers run.\n"
        gone_within(user.place)
        assert user("servers", "start").returncode == 0


def test_a_lost_fork_server_ends_them_and_costs_nothing_else(tmp_path):
    with started(tmp_path) as user:
        for child in psutil.Process(user.pid()).children():
            child.kill()
        assert user.graded(QUICK).is_cold
        gone_within(user.place)


def open_to_others(place: Path) -> None:
    place.mkdir()
    place.chmod(0o755)


def link_to_a_folder(place: Path) -> None:
    other = place.with_name("other")
    other.mkdir(mode=0o700)
    place.symlink_to(other)


def of_another_user(place: Path) -> None:
    place.mkdir(mode=0o700)
    os.chown(place, 4711, 4711)


@pytest.mark.parametrize(
    "occupied",
    [
        open_to_others,
        link_to_a_folder,
        pytest.param(
            of_another_user,
            marks=pytest.mark.applies(os.getuid() == 0, reason="nobody else can give it away"),
        ),
    ],
)
def test_what_another_could_have_put_in_their_place_is_not_used(occupied, tmp_path):
    user = User(tmp_path)
    user.place.parent.mkdir(mode=0o700)
    occupied(user.place)
    listener = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    folder = os.open(user.place, os.O_RDONLY)
    listener.bind(f"/proc/self/fd/{folder}/socket")
    listener.listen()
    (user.place / "token").write_text("0")
    assert user.graded(QUICK).is_cold
    listener.setblocking(False)
    with pytest.raises(BlockingIOError):
        listener.accept()
    listener.close()
    os.close(folder)
    done = user("servers", "start")
    assert done.returncode == 2
    assert str(user.place) in done.stderr


def test_where_there_is_no_place_for_servers_a_call_is_what_it_was(tmp_path):
    user = User(tmp_path)
    user.place.parent.symlink_to(tmp_path)
    home = tmp_path / "no-folder"
    home.touch()
    places = {"XDG_RUNTIME_DIR": str(home), "HOME": str(home)}
    done, alone = (
        user("check", "not_there", **places),
        user("check", "not_there", GRADER_SERVERS="off", **places),
    )
    assert (done.returncode, done.stderr) == (alone.returncode, alone.stderr)
    assert done.returncode == 2
