"""The graph for viewers is left in good order, whatever goes on in it."""

from __future__ import annotations

import threading

from turtlesim_py.live.graph import Graph


def test_what_still_runs_when_it_is_closed_comes_to_its_end(ros, monkeypatch):
    graph = Graph()
    failures, heard = [], []
    monkeypatch.setattr(threading, "excepthook", failures.append)
    has_begun, is_waited_for = threading.Event(), threading.Event()
    join = graph._thread.join

    def waited_for(timeout_s: float) -> None:
        is_waited_for.set()
        join(timeout_s)

    def work() -> None:
        has_begun.set()
        is_waited_for.wait()

    monkeypatch.setattr(graph._thread, "join", waited_for)
    running = graph._executor.create_task(work)
    running.add_done_callback(heard.append)
    has_begun.wait()
    graph.close()
    assert running.done()
    assert not failures
