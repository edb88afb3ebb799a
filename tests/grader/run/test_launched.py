"""A package whose launch file starts two of its nodes is run so, as two processes."""

from pathlib import Path

from grader.run import virtual_time
from grader.run.handover import Plan
from grader.run.opening import open_submission
from grader.scenes.scene import Limits
from turtlesim_py.world.events import CmdVel, SetPen

TWO_NODES = Path(__file__).parents[2] / "submissions" / "launched" / "spiral"
PLAN = Plan(Limits(first_motion_s=20, rest_s=0.3, total_s=6))


def test_both_nodes_run_with_what_the_launch_file_gives_them() -> None:
    with open_submission(TWO_NODES) as submission:
        recording = virtual_time.run(submission, PLAN)
    assert (recording.run.time, recording.run.flags) == ("virtual", ())
    events = recording.trace.events
    assert any(isinstance(event, CmdVel) for event in events), recording.output
    assert {event.width for event in events if isinstance(event, SetPen)} == {5}
