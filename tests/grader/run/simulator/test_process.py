"""What a simulator tells while it works: no faster than it is wanted, and never at its own cost."""

import json
import socket
import threading

import pytest

from grader.run.simulator import process
from grader.run.simulator.process import FeedWriter

TICK_NS = 16_000_000


@pytest.fixture
def ends():
    ours, theirs = socket.socketpair()
    with ours:
        yield ours, theirs.detach()


@pytest.fixture
def clock(monkeypatch, wall_clock):
    wall_clock.now_s = 100.0
    monkeypatch.setattr(process.time, "monotonic", wall_clock.monotonic)
    monkeypatch.setattr(process.time, "sleep", wall_clock.sleep)
    return wall_clock


def all_of(ours: socket.socket) -> bytes:
    return b"".join(iter(lambda: ours.recv(1 << 20), b""))


@pytest.mark.parametrize(("speed", "lasts_s"), [(1.0, 16.0), (5.0, 3.2), (None, 0.0)])
def test_ticks_come_at_the_speed_that_was_asked_for(ends, clock, speed, lasts_s):
    feed = FeedWriter(ends[1], speed)
    began_s = clock.now_s
    for _ in range(1001):
        feed.pace()
    assert clock.now_s - began_s == pytest.approx(lasts_s)
    feed.close()


def test_after_a_pause_nothing_is_hurried(ends, clock):
    feed = FeedWriter(ends[1], 1.0)
    for _ in range(2):
        feed.pace()
    clock.now_s += 30.0  # the submission computes
    began_s = clock.now_s
    for _ in range(11):
        feed.pace()
    assert clock.now_s - began_s == pytest.approx(0.16)
    feed.close()


def test_all_that_is_told_arrives_in_order_however_much_it_is(ends):
    ours, theirs = ends
    feed = FeedWriter(theirs, None)
    news = [{"tick": tick, "drawn": ["x" * 10_000]} for tick in range(300)]

    def write() -> None:
        for each in news:
            feed.write(each)
        feed.close()

    thread = threading.Thread(target=write)
    thread.start()
    told = [json.loads(line) for line in all_of(ours).splitlines()]
    assert told == [*news, process.END]
    thread.join()


def test_one_who_takes_nothing_is_waited_for_a_little_and_then_told_no_more(ends, monkeypatch):
    monkeypatch.setattr(process, "PATIENCE_S", 0.01)
    monkeypatch.setattr(process, "MOST_BYTES", 100_000)
    ours, theirs = ends
    feed = FeedWriter(theirs, None)
    for tick in range(200):
        feed.write({"tick": tick, "drawn": ["x" * 10_000]})
    feed.close()
    end = json.dumps(process.END, separators=(",", ":")).encode()
    assert not all_of(ours).endswith(end + b"\n")


def test_one_who_has_left_is_no_error(ends):
    ours, theirs = ends
    feed = FeedWriter(theirs, 1.0)
    ours.close()
    for tick in range(3):
        feed.write({"tick": tick})
    feed.close()
