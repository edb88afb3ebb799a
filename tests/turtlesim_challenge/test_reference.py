"""The reference controller takes the messages that the ROS release has."""

import runpy
import sys

import pytest

from tests.hand_ins import REFERENCE
from tests.tiers import that_apply
from turtlesim_py.ros.interfaces import NAMES, installed


@pytest.mark.parametrize(
    "expected", that_apply("it is installed", {name: name in installed() for name in NAMES})
)
def test_the_reference_takes_the_messages_that_are_there(monkeypatch, expected):
    (missing,) = {*NAMES} - {expected}
    for name in (missing, f"{missing}.msg", f"{missing}.srv"):
        monkeypatch.setitem(sys.modules, name, None)
    module = runpy.run_path(str(REFERENCE))
    for name in ("Pose", "SetPen"):
        assert module[name].__module__.partition(".")[0] == expected
