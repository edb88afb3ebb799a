"""multisim.launch.py. PyPI has no launch, so this looks only at what it would start."""

import runpy
import sys
from types import ModuleType

from tests.programs import ROOT


def test_it_starts_the_simulator_in_the_originals_two_namespaces(monkeypatch):
    for name, attribute, value in [
        ("launch", "LaunchDescription", list),
        ("launch_ros", "actions", None),
        ("launch_ros.actions", "Node", dict),
    ]:
        module = ModuleType(name)
        setattr(module, attribute, value)
        monkeypatch.setitem(sys.modules, name, module)
    described = runpy.run_path(str(ROOT / "launch" / "multisim.launch.py"))
    nodes = described["generate_launch_description"]()
    assert [node["namespace"] for node in nodes] == ["turtlesim1", "turtlesim2"]
    assert {node["executable"] for node in nodes} == {"turtlesim_node"}
