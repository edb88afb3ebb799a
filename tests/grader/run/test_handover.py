"""What the simulator's process leaves is fetched whole; anything else is the grader's failure."""

import json
import os
import pickle
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from grader.errors import GraderFailure
from grader.recording import bag
from grader.recording.recording import PublishedTopic
from grader.run.handover import fetch, leave
from grader.scenes.scene import Scene, load_scene
from grader.scenes.turtlesim.trace import TurtleTrace
from tests.grader.driving import Spiral, drive
from tests.grader.scenes.turtlesim.traces import assert_same_trace

PUBLISHED = {"/ü": "", "/turtle1/cmd_vel": "geometry_msgs/msg/Twist"}
TOPICS = (PublishedTopic("/turtle1/cmd_vel", "geometry_msgs/msg/Twist"), PublishedTopic("/ü", ""))


@pytest.fixture(scope="module")
def trace():
    return TurtleTrace.of(drive(Spiral(), ticks=50).trace)


@pytest.fixture(scope="module")
def scene():
    return load_scene("turtlesim")


@pytest.fixture
def file():
    """A file without a name, as a run has one."""
    file = os.memfd_create("recording")
    yield file
    os.close(file)


@pytest.fixture
def left(file, scene, trace):
    """What lies in the file when it was left."""
    leave(Path(f"/proc/self/fd/{file}"), scene, trace, PUBLISHED)
    return os.pread(file, 100_000_000, 0)


def put(file: int, data: bytes) -> None:
    os.ftruncate(file, 0)
    os.pwrite(file, data, 0)


def failure(file: int, scene: Scene) -> str:
    with pytest.raises(GraderFailure, match="the simulator left no recording") as error:
        fetch(file, scene)
    return str(error.value)


def test_what_was_left_is_fetched(file, left, scene, trace):
    found, topics = fetch(file, scene)
    assert_same_trace(TurtleTrace.of(found), trace)
    assert topics == TOPICS


def test_it_can_be_fetched_again_and_the_file_stays_open(file, left, scene):
    os.lseek(file, 7, os.SEEK_SET)
    first, second = fetch(file, scene), fetch(file, scene)
    assert first[0].sha256() == second[0].sha256()
    assert os.fstat(file).st_size == len(left)


@pytest.mark.parametrize(("published", "topics"), [({}, ()), (PUBLISHED, TOPICS)])
def test_what_every_node_publishes_on_is_left_out(file, scene, trace, published, topics):
    every = {"/rosout": "rcl_interfaces/msg/Log", "/parameter_events": "x"}
    leave(Path(f"/proc/self/fd/{file}"), scene, trace, {**published, **every})
    assert fetch(file, scene)[1] == topics


class Trap:
    def __reduce__(self):
        return os._exit, (1,)


def test_what_is_none_is_a_failure_and_nothing_else(file, left, scene, trace):
    data, trap = bag.pack(trace, scene)[0], pickle.dumps(Trap())
    facts = json.loads(left.partition(b"\n")[0])
    others = [{"topics": value} for value in (3, [], {"/a": 3}, {"/a": [""]})]
    others += [{"duration_ns": value} for value in (None, "many", 3, 1.0)] + [{"sha256": "0"}]
    no_facts = (
        b"",
        b"{",
        b"3",
        b"\xff\xfe",
        b"[" * 100_000,
        b"[3]",
        b"{}",
        *(json.dumps({**facts, **other}).encode() for other in others),
    )
    for found in (
        *(left[: int(len(left) * part)] for part in (0.0, 0.00001, 0.01, 0.5, 0.99, 0.99999)),
        *(head + b"\n" + data for head in no_facts),
        *(trap, b"{}\n" + trap, trap + b"\n" + trap),
    ):
        put(file, found)
        failure(file, scene)


@given(data=st.binary(max_size=200))
def test_garbage_is_a_failure_and_nothing_else(file, scene, data):
    put(file, data)
    failure(file, scene)


def test_the_failure_does_not_repeat_the_file(file, scene):
    text = json.dumps(["x" * 100_000]).encode()
    put(file, text)
    assert len(failure(file, scene)) < 300
