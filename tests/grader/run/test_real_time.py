"""Whole runs in real time: nothing is lost at the start."""

from pathlib import Path

import pytest
import yaml

from grader.recording.recording import Recording
from grader.run import real_time
from grader.run.handover import Plan
from grader.run.opening import open_submission
from grader.scenes.scene import Limits
from tests import runs
from tests.tiers import others_are_more
from turtlesim_py.world.events import CmdVel, SetPen

TEXTS = yaml.safe_load(Path(__file__).with_suffix(".yaml").read_text())


def recorded(name: str, later_s: float = 0.0) -> Recording:
    text = f"import time; time.sleep({later_s})\n{TEXTS[name]}"
    plan = Plan(Limits(first_motion_s=5, rest_s=0.2, total_s=60))
    return runs.recorded(runs.written(text, f"{name}.py"), plan, time="real")


@pytest.mark.parametrize("later_s", others_are_more("it waits", (0.0, 5.1), 0.0))
def test_the_first_command_arrives(later_s):
    assert len(recorded("commands_at_once", later_s).trace.of_kind(CmdVel)) == 1


@pytest.mark.more("the first command stands for it")
def test_the_first_call_of_a_service_arrives():
    assert len(recorded("calls_at_once").trace.of_kind(SetPen)) == 1


@pytest.mark.more("it waits for a node")
def test_without_a_node_the_clock_of_the_run_starts_as_well(tmp_path, monkeypatch):
    monkeypatch.setattr(real_time, "FIRST_NODE_S", 0.3)
    (tmp_path / "sleeps.py").write_text("import time; time.sleep(60)\n")
    plan = Plan(Limits(first_motion_s=0.3, rest_s=0.2, total_s=60))
    with open_submission(tmp_path / "sleeps.py") as submission:
        run = real_time.run(submission, plan).run
    assert (run.outcome, run.simulated_s) == ("time_limit", pytest.approx(0.3, abs=0.1))
