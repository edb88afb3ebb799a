"""What is taken for granted of rclpy's inside, and what happens where it does not hold."""

import os
import shlex
import sys
from typing import Any

import pytest
import rclpy.executors
import rclpy.task
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy

from grader.run import virtual_time
from grader.run.handover import Plan
from grader.run.lockstep import contract
from grader.run.opening import open_submission
from grader.run.processes import levels
from grader.scenes.scene import Limits
from grader.system import versions as system
from grader.text.message import NOTHING, msg
from tests.hand_ins import SUBMISSIONS
from tests.tiers import others_are_more

GROUPS = (contract.ENTITIES, contract.PROGRAM)


def test_the_installed_rclpy_keeps_the_contract():
    assert contract.broken(*GROUPS) == NOTHING


def documented(doc: str) -> type:
    def init(self: Any) -> None: ...

    init.__doc__ = doc
    return type("Changed", (), {"__init__": init})


@pytest.mark.parametrize(
    ("owner", "name", "value", "line"),
    [
        (rclpy.task.Future, "done", None, "Future has no done"),
        (_rclpy, "Subscription", None, "there is no Subscription"),
        (_rclpy.Subscription, "take_message", None, "Subscription has no take_message"),
        (
            *(_rclpy, "Client"),
            documented("__init__(self: Client, arg0: Node, arg1: tuple[int, str]) -> None"),
            "Client() takes 2 arguments instead of 4",
        ),
        (
            *(_rclpy, "Service", documented("in another form")),
            "Service.__init__: ValueError('no signature that we can read')",
        ),
    ],
)
def test_one_line_says_what_does_not_hold(monkeypatch, owner, name, value, line):
    if value is None:
        monkeypatch.delattr(owner, name)
    else:
        monkeypatch.setattr(owner, name, value)
    found = contract.broken(*GROUPS)
    assert str(found) == f"virtual time does not fit rclpy {system.rclpy_version()}: {line}"


def test_what_constructors_get_beyond_the_known_is_no_breach(monkeypatch):
    more = "__init__(self: Node, node: N, type: object, topic: str, qos: object, filter: object)"
    kind = documented(more + " -> None")
    for name in ("take_message", "get_publisher_count", "get_topic_name", "pointer"):
        setattr(kind, name, getattr(_rclpy.Subscription, name))
    kind.destroy_when_not_in_use = _rclpy.Subscription.destroy_when_not_in_use
    monkeypatch.setattr(_rclpy, "Subscription", kind)
    assert contract.broken(*GROUPS) == NOTHING


#: Run by every Python that a run starts, before anything else.
CHANGED = """
import sys
if {marker!r} in " ".join(sys.orig_argv):
    from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
    del _rclpy.{name}
"""


@pytest.fixture
def changed_rclpy(tmp_path, monkeypatch):
    """Take something away from the rclpy of a run's processes whose command holds a text."""

    def change(marker: str, name: str) -> None:
        text = CHANGED.format(marker=marker, name=name)
        (tmp_path / "sitecustomize.py").write_text(text, encoding="utf-8")
        python = tmp_path / "python"
        path = f"{tmp_path}{os.pathsep}${{PYTHONPATH:-}}"
        python.write_text(
            f'#!/bin/sh\nPYTHONPATH="{path}" exec {shlex.quote(sys.executable)} "$@"\n'
        )
        python.chmod(0o755)
        monkeypatch.setattr(sys, "executable", str(python))

    return change


SIDES = ("simulator.virtual", "virtual_main.py")


@pytest.mark.parametrize("side", others_are_more("one side", SIDES, "simulator.virtual"))
def test_a_broken_contract_on_either_side_is_why_there_is_no_run_in_virtual_time(
    changed_rclpy, side, monkeypatch
):
    changed_rclpy(side, "ClockType.STEADY_TIME")
    # a submission that is confined does not see the folder with the change
    monkeypatch.setattr(levels, "best", lambda isolated: levels.Level("limits"))
    with open_submission(SUBMISSIONS / "misbehaving/exits.py") as submission:
        plan = Plan(Limits(1, 0.2, 5))
        found = virtual_time._try(submission, plan, virtual_time.PATIENCE, None)
    fault = {"version": system.rclpy_version(), "fault": "ClockType has no STEADY_TIME"}
    why = msg("virtual time does not fit rclpy {version}: {fault}", **fault)
    assert found == (None, why)
