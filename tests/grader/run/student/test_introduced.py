"""In real time, what drives the scene is connected when a submission gets it."""

from __future__ import annotations

import types

import pytest

from grader.run.student import main


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> types.SimpleNamespace:
    """A clock that only sleeping moves."""
    clock = types.SimpleNamespace(now_s=0.0)
    clock.monotonic = lambda: clock.now_s

    def sleep(seconds: float) -> None:
        clock.now_s += seconds

    clock.sleep = sleep
    monkeypatch.setattr(main, "time", clock)
    return clock


def patched(clock: types.SimpleNamespace, connected_s: float) -> type:
    """A node class whose publishers are connected at a time [s]."""

    class Node:
        def create_publisher(self, kind: object, name: str) -> types.SimpleNamespace:
            count = lambda: int(clock.now_s >= connected_s)  # noqa: E731
            return types.SimpleNamespace(topic_name=name, get_subscription_count=count)

        def create_client(self, kind: object, name: str) -> None:
            raise AssertionError

    main.Introduced(["/turtle1/cmd_vel"], []).patch(types.SimpleNamespace(Node=Node))
    return Node


@pytest.mark.parametrize(
    ("name", "waited_s"), [("/turtle1/cmd_vel", 8), ("/turtle/cmd_vel", 4), ("/other", 0)]
)
def test_a_name_that_is_there_is_waited_for_longer_than_one_that_may_be_wrong(
    clock: types.SimpleNamespace, name: str, waited_s: float
) -> None:
    patched(clock, connected_s=8.0)().create_publisher(object, name)
    assert clock.now_s == pytest.approx(waited_s, abs=0.1)


def test_names_that_may_be_wrong_are_waited_for_together(clock: types.SimpleNamespace) -> None:
    node = patched(clock, connected_s=1000.0)()
    for _ in range(10):
        node.create_publisher(object, "/turtle/cmd_vel")
    assert clock.now_s == pytest.approx(4.0, abs=0.1)
