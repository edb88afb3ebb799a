import tomllib
from importlib import import_module

import pytest

from tests.programs import ROOT, Program

SCRIPTS = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["scripts"]
PROGRAMS = sorted(set(SCRIPTS) - {"grader"})


@pytest.mark.parametrize("name", PROGRAMS)
@pytest.mark.parametrize("word", ["--help", "-h"])
def test_who_asks_for_help_gets_it_and_nothing_starts(name, word, monkeypatch, capsys):
    module, _, function = SCRIPTS[name].partition(":")
    main = getattr(import_module(module), function)
    monkeypatch.setattr("sys.argv", [name, "ignored", word])
    monkeypatch.setattr("rclpy.init", lambda **_: pytest.fail("ROS was started"))
    assert not main()
    said = capsys.readouterr().out
    assert said.startswith(f"usage: {name} ")
    about = said.partition("\n\n")[2]
    assert "turtle" in about or "robot" in about


def test_a_parameter_s_value_is_no_cry_for_help():
    words = ("--ros-args", "-r", "__ns:=/helped", "-p", "turtle_image:=-h")
    with Program("turtlesim_py.ros.node", *words) as program:
        assert program.wait() == 2
