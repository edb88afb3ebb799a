"""No run hears another, and none leaves anything in shared memory."""

import errno
import os
import subprocess
import sys
from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from pathlib import Path

import pytest

from grader import scratch
from grader.errors import NotNow
from grader.run.processes import network, refusal
from grader.run.run_context import RunContext, open_context
from tests.tiers import others_are_more

#: Publishes on /x until its standard input ends, or says what it hears there; ends without cleaning
#: up, as a killed run does.
TALK = """
import os, select, sys, time
import rclpy
from std_msgs.msg import String
rclpy.init()
node = rclpy.create_node(sys.argv[1])
heard = []
if sys.argv[1] == "talker":
    publisher = node.create_publisher(String, "/x", 10)
else:
    node.create_subscription(String, "/x", lambda message: heard.append(message.data), 10)
print("up", flush=True)
until = time.monotonic() + float(sys.argv[2])
while time.monotonic() < until and not heard:
    rclpy.spin_once(node, timeout_sec=0.02)
    if sys.argv[1] == "talker":
        publisher.publish(String(data="hello"))
        if select.select([0], [], [], 0)[0]:
            break
print(*heard, flush=True)
print(sum("fastrtps" in line or "fastdds" in line
          for line in open("/proc/self/maps") if "/dev/shm" in line), flush=True)
os.kill(os.getpid(), 9)
"""
PIPES = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE}


DOMAIN = "ROS domain"


@pytest.fixture(
    params=others_are_more("the best way that there is here", ("the best", DOMAIN), "the best")
)
def kind(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> str:
    """How a run is kept apart."""
    if request.param == DOMAIN:
        monkeypatch.setattr(network, "_refused", {network._as_root, network._as_user})
    return DOMAIN if network.private_network() is None else "private network"


def inside(namespaces: Mapping[str, int]) -> list[str]:
    """The words before a command that is to run in these."""
    words = [f"--{kind}=/proc/{os.getpid()}/fd/{fd}" for kind, fd in namespaces.items()]
    return ["nsenter", "--preserve-credentials", *words, "--"] if words else []


def talk(context: RunContext, role: str, seconds: float) -> "subprocess.Popen[str]":
    words = [*inside(context.namespaces), sys.executable, "-c", TALK, role, str(seconds)]
    return subprocess.Popen(words, env=dict(context.env), text=True, **PIPES)


def test_the_two_of_a_run_hear_each_other_and_no_other_run(kind: str) -> None:
    with ExitStack() as stack:
        ours, other = (stack.enter_context(open_context()) for _ in range(2))
        assert kind in ours.isolation
        talker = stack.enter_context(talk(ours, "talker", 60.0))
        listener = stack.enter_context(talk(ours, "listener", 20.0))
        stranger = stack.enter_context(talk(other, "listener", 1.0))
        assert listener.communicate()[0].split() == ["up", "hello", "0"]
        assert stranger.communicate()[0].split() == ["up", "0"]
        assert talker.communicate()[0].split() == ["up", "0"]


@pytest.mark.more("which of them there are depends on the machine")
@pytest.mark.parametrize("way", [network._as_root, network._as_user])
def test_both_ways_to_a_private_network(way, tmp_path: Path) -> None:
    try:
        namespaces = way()
    except OSError:
        pytest.skip("this system does not allow it")
    shown = subprocess.run(
        [*inside(namespaces), "cat", "/proc/net/dev"],
        capture_output=True,
        text=True,
        check=True,
    )
    for namespace in namespaces.values():
        os.close(namespace)
    assert [line.split(":")[0].strip() for line in shown.stdout.splitlines()[2:]] == ["lo"]


@pytest.mark.parametrize(
    ("number", "asked_for"),
    [(errno.EPERM, [1, 0]), (errno.EMFILE, [refusal.TRIES, refusal.TRIES])],
)
def test_what_is_refused_for_good_is_not_asked_for_again_and_the_rest_is(
    monkeypatch: pytest.MonkeyPatch, number: int, asked_for: list[int]
) -> None:
    asked = [0]

    def refuse() -> network.Namespaces:
        asked[-1] += 1
        raise OSError(number, os.strerror(number), "unshare (net)")

    monkeypatch.setattr(network, "_as_root", refuse)
    monkeypatch.setattr(network, "_as_user", refuse)
    monkeypatch.setattr(network, "_refused", set())
    monkeypatch.setattr(refusal, "PAUSES_S", (0.0, 0.0))
    told = []
    for _ in range(2):
        try:
            assert network.private_network() is None
        except NotNow as error:
            told.append(str(error))
        asked.append(0)
    once = 1 if number == errno.EPERM else 2  # the same function twice
    assert asked[:2] == [each * once for each in asked_for]
    assert len(told) == (0 if number == errno.EPERM else 2)
    assert all(text.endswith("unshare (net): Too many open files") for text in told)


#: In a user namespace in which there may be so many networks, one of which is there already.
FEW_NETWORKS = """
import os, sys
from pathlib import Path
from grader.errors import NotNow
from grader import linux
from grader.run.processes import network, refusal
refusal.PAUSES_S = (0.0, 0.0)
user, group = os.getuid(), os.getgid()
linux.unshare(linux.CLONE_NEWUSER)
for name, text in ("setgroups", "deny"), ("uid_map", f"0 {user} 1"), ("gid_map", f"0 {group} 1"):
    Path("/proc/self", name).write_text(text)
linux.unshare(linux.CLONE_NEWNET)
Path("/proc/sys/user/max_net_namespaces").write_text(sys.argv[1])
try:
    print(network.private_network())
except NotNow as error:
    print(error.message)
"""


@pytest.mark.applies(network.private_network() is not None, reason="networks are to be had")
@pytest.mark.parametrize(
    ("most", "told"),
    [("0", "None"), ("1", "net): No space left on device"), ("9", "{'")],
)
def test_no_more_networks_for_now_is_not_the_same_as_none_at_all(most: str, told: str) -> None:
    done = subprocess.run(
        [sys.executable, "-c", FEW_NETWORKS, most],
        env={**os.environ, "PYTHONPATH": str(Path(__file__).parents[4])},
        capture_output=True,
        text=True,
        check=False,
    )
    assert told in done.stdout, done.stdout + done.stderr


def test_a_run_context_leaves_nothing(kind: str) -> None:
    fds = len(list(Path("/proc/self/fd").iterdir()))
    with open_context() as context:
        assert context.folder.is_dir()
    assert not context.folder.exists()
    assert len(list(Path("/proc/self/fd").iterdir())) == fds


def test_runs_that_start_together_do_not_clear_each_other_away() -> None:
    def make(_: int) -> bool:
        with scratch.make_folder() as path:
            (path / "tmp").mkdir()
            return path.is_dir()

    with ThreadPoolExecutor(8) as pool:
        assert all(pool.map(make, range(200)))
