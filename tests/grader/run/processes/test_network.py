"""No run hears another, and none leaves anything in shared memory."""

import errno
import os
import subprocess
import sys
from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from pathlib import Path

import pytest
import yaml

from grader.errors import NotNow
from grader.run.processes import network, refusal
from grader.run.run_context import RunContext, open_context
from grader.system import scratch
from tests.programs import ran
from tests.tiers import others_are_more, that_apply

TEXTS = yaml.safe_load(Path(__file__).with_suffix(".yaml").read_text())

PIPES = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE}
DOMAIN = "ROS domain"


def is_private(way: Callable[[], network.Namespaces | None] = network.private_network) -> bool:
    """Whether a run has a network of its own here."""
    try:
        namespaces = way()
    except OSError:
        return False
    for namespace in (namespaces or {}).values():
        os.close(namespace)
    return namespaces is not None


WAYS = {way: is_private(way) for way in (network._as_root, network._as_user)}


@pytest.fixture(
    params=others_are_more("the best way that there is here", ("the best", DOMAIN), "the best")
)
def kind(request, monkeypatch):
    """How a run is kept apart."""
    if request.param == DOMAIN:
        monkeypatch.setattr(network, "_refused", {network._as_root, network._as_user})
    return "private network" if is_private() else DOMAIN


def inside(namespaces: Mapping[str, int]) -> list[str]:
    """The words before a command that is to run in these."""
    words = [f"--{kind}=/proc/{os.getpid()}/fd/{fd}" for kind, fd in namespaces.items()]
    return ["nsenter", "--preserve-credentials", *words, "--"] if words else []


def talk(context: RunContext, role: str, seconds: float) -> "subprocess.Popen[str]":
    words = [*inside(context.namespaces), sys.executable, "-c", TEXTS["talk"], role, str(seconds)]
    return subprocess.Popen(words, env=dict(context.env), text=True, **PIPES)


def test_the_two_of_a_run_hear_each_other_and_no_other_run(kind):
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
@pytest.mark.parametrize("way", that_apply("this system allows it", WAYS))
def test_both_ways_to_a_private_network(way):
    namespaces = way()
    shown = ran([*inside(namespaces), "cat", "/proc/net/dev"], check=True)
    for namespace in namespaces.values():
        os.close(namespace)
    assert [line.split(":")[0].strip() for line in shown.stdout.splitlines()[2:]] == ["lo"]


@pytest.mark.parametrize(
    ("number", "asked_for"),
    [(errno.EPERM, [1, 0]), (errno.EMFILE, [refusal.TRIES, refusal.TRIES])],
)
def test_what_is_refused_for_good_is_not_asked_for_again_and_the_rest_is(
    monkeypatch, number, asked_for
):
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


@pytest.mark.applies(is_private(), reason="networks are to be had")
@pytest.mark.parametrize(
    ("most", "told"),
    [("0", "None"), ("1", "net): No space left on device"), ("9", "{'")],
)
def test_no_more_networks_for_now_is_not_the_same_as_none_at_all(most, told):
    done = ran(
        [sys.executable, "-c", TEXTS["few_networks"], most],
        env={**os.environ, "PYTHONPATH": str(Path(__file__).parents[4])},
    )
    assert told in done.stdout, done.stdout + done.stderr


def test_a_run_context_leaves_nothing(kind):
    fds = len(list(Path("/proc/self/fd").iterdir()))
    with open_context() as context:
        assert context.folder.is_dir()
    assert not context.folder.exists()
    assert len(list(Path("/proc/self/fd").iterdir())) == fds


def test_runs_that_start_together_do_not_clear_each_other_away():
    def make(_: int) -> bool:
        with scratch.make_folder() as path:
            (path / "tmp").mkdir()
            return path.is_dir()

    with ThreadPoolExecutor(8) as pool:
        assert all(pool.map(make, range(200)))
