"""The reference controller takes the messages that the ROS release has."""

import runpy
import sys

import pytest

from tests.hand_ins import REFERENCE


@pytest.mark.parametrize(
    ("missing", "expected"), [("turtlesim_msgs", "turtlesim"), ("turtlesim", "turtlesim_msgs")]
)
def test_the_reference_takes_the_messages_that_are_there(monkeypatch, missing, expected):
    pytest.importorskip(expected)
    for name in (missing, f"{missing}.msg", f"{missing}.srv"):
        monkeypatch.setitem(sys.modules, name, None)
    module = runpy.run_path(str(REFERENCE))
    for name in ("Pose", "SetPen"):
        assert module[name].__module__.partition(".")[0] == expected
