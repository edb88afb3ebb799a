"""Whole runs in virtual time: every style of waiting, every service, and those who misbehave."""

import os
import re

import pytest

from grader.recording.subject import Start
from grader.run import virtual_time
from grader.run.handover import Plan
from grader.run.limits import Patience
from grader.run.opening import open_submission
from grader.run.simulator.link import NONSENSE
from grader.scenes.scene import Limits
from grader.text.message import msg
from tests import runs
from tests.hand_ins import SUBMISSIONS
from tests.tiers import others_are_more
from turtlesim_py.world.events import CmdVel

STYLES = sorted(p.stem for p in (SUBMISSIONS / "styles").glob("*.py"))

#: Threads, processor time, other loops: where a second run may differ.
TWICE = ("asyncio_loop", "busy_polling", "events_executor", "multi_threaded", "queues_and_timers")
DIFFERENT = "three as different as can be stand for the others"


@pytest.mark.parametrize(
    "style", others_are_more(DIFFERENT, STYLES, "timer", "busy_polling", "multi_threaded")
)
def test_every_style_of_waiting_is_followed(recorded, style):
    recording = recorded(f"styles/{style}")
    run = recording.run
    assert (run.time, run.outcome, run.flags) == ("virtual", "finished", ())
    assert len(recording.trace.of_kind(CmdVel)) > 10


def test_a_file_that_python_cannot_read_is_run_in_virtual_time_and_is_no_fault_of_ours():
    path = runs.written("import rclpy\ndef main(:\n    pass\n")
    run = runs.recorded(path, Plan(Limits(1, 1, 1))).run
    assert (run.time, run.outcome, run.flags) == ("virtual", "crashed", ())


@pytest.mark.parametrize("style", others_are_more("one stands for them", TWICE, "multi_threaded"))
def test_every_style_of_waiting_gives_the_same_run_twice(recorded, style):
    first, second = recorded(f"styles/{style}"), recorded(f"styles/{style}", 2)
    assert first.run.trace_sha256 == second.run.trace_sha256
    assert first.topics == second.topics


SAME = ("events_executor", "call_in_callback", "broadcasts_tf")


@pytest.mark.parametrize("style", others_are_more("one stands for them", SAME, "broadcasts_tf"))
def test_styles_that_mean_the_same_draw_the_same(recorded, style):
    hashes = [recorded(f"styles/{name}").run.trace_sha256 for name in ("timer", style)]
    assert hashes[0] == hashes[1]


def test_transforms_are_sent_heard_and_looked_up_in_virtual_time(recorded):
    lines = recorded("styles/broadcasts_tf").output.splitlines()
    assert lines[0].startswith("carrot at ")
    assert "ExtrapolationException: Lookup would require extrapolation into the future." in lines[1]
    assert len(lines) > 3


SERVICES = ("all_services", "rotate", "graph")


@pytest.mark.parametrize("name", others_are_more("actions stand for them", SERVICES, "rotate"))
def test_what_services_actions_and_the_graph_tell_is_the_same_every_time(recorded, name):
    first, second = recorded(f"services/{name}"), recorded(f"services/{name}", 2)
    assert (first.run.exit_code, first.run.flags) == (0, ())
    assert first.output == second.output
    assert first.trace.events == second.trace.events


def test_rotation_goals_end_as_in_the_original(recorded):
    lines = recorded("services/rotate").output.splitlines()
    # 62 ticks of 0.016 rad from 0 towards 1.0, first feedback in the tick of acceptance
    assert lines[1].startswith("1.008 4 turtlesim.action.RotateAbsolute_Result(delta=-0.99199998")
    statuses = [int(line.split()[1]) for line in lines if "Result" in line]
    assert statuses == [4, 5, 6, 6, 4]  # succeeded, cancelled, aborted twice, succeeded


def test_a_burst_of_commands_is_consumed_one_a_tick_and_only_the_last_seven(recorded):
    commands = recorded("services/burst").trace.of_kind(CmdVel)
    assert [(command.tick, command.linear[0]) for command in commands] == [
        (tick, tick + 13.0) for tick in range(1, 8)
    ]


def test_a_run_may_start_elsewhere():
    plan = Plan(Limits(3, 1, 60), Start(2.0, 3.0, 1.0))
    with open_submission(SUBMISSIONS / "misbehaving/exits.py") as submission:
        recording = virtual_time.run(submission, plan)
    way = recording.trace.trajectory()
    assert (way.x[0], way.y[0], way.theta[0]) == pytest.approx((2.0, 3.0, 1.0), abs=0.02)
    assert recording.start == Start(2.0, 3.0, 1.0)


STUCK = r"(?s)Your node is stuck here.*"
#: How each ends, its exit code, and what is shown of it: where it is stuck, or the last words.
MISBEHAVIOUR = {
    "busy_for_ever": ("stalled", None, ""),
    "calls_in_callback": ("stalled", None, STUCK + r"self\.pen\.call\(SetPen\.Request\(r=255, "),
    "calls_without_spinning": ("stalled", None, STUCK + r"pen\.call\(SetPen\.Request\(r=255, "),
    "exits": ("crashed", 3, ""),
    "floods": ("time_limit", None, ""),
    "floods_without_end": ("time_limit", None, ""),
    "interrupts_itself": ("finished", 0, ""),
    "kills_itself": ("killed", -9, ""),
    "never_spins": ("stalled", None, ""),
    "prints_a_million": ("finished", None, ""),
    "publishes_after_shutdown": ("crashed", 1, r"(RCLError|InvalidHandle): .*\s*$"),
    "publishes_wrong_type": (
        *("crashed", 1),
        r"TypeError: Expected <class 'geometry_msgs.msg._twist.Twist'>.*\s*$",
    ),
    "raises_in_callback": ("crashed", 1, r"AttributeError: 'Pose' object has no .* 'z'\s*$"),
    "releases_twice": ("finished", 0, r"RuntimeError: release unlocked lock\s*$"),
    "sleeps_backwards": ("crashed", 1, r"ValueError: sleep length must be non-negative\s*$"),
    "sleeps_for_ever": ("finished", None, ""),
    "ticks_backwards": ("crashed", 1, r"RCLError: .* timer period must be non-negative.*\s*$"),
    "spins_in_callback": ("stalled", None, STUCK + r"rclpy\.spin_until_future_complete\(self, an"),
}
OF_EACH_END = (
    *("busy_for_ever", "exits", "interrupts_itself", "kills_itself"),
    *("raises_in_callback", "sleeps_backwards", "spins_in_callback"),
)


@pytest.mark.parametrize(
    "name", others_are_more("some of each end are kept", MISBEHAVIOUR, *OF_EACH_END)
)
def test_misbehaviour_ends_by_itself_and_is_named_and_shown_as_at_a_desk(recorded, name):
    outcome, exit_code, shown = MISBEHAVIOUR[name]
    recording = recorded(f"misbehaving/{name}")
    run = recording.run
    assert (run.time, run.outcome, run.exit_code) == ("virtual", outcome, exit_code)
    assert re.search(shown, recording.output)
    assert (f"{name}.py" in recording.output) >= bool(shown)
    assert recording.output.count("Your node is stuck here") <= 1
    assert "grader/run" not in recording.output


@pytest.mark.more("a run in each time; test_faults tells whose an exception is")
def test_a_mistake_of_ours_is_never_the_submission_s_even_where_that_catches_everything(recorded):
    recording = recorded("misbehaving/breaks_the_grader")
    assert recording.run.time == "real"
    assert re.fullmatch(
        r"graded in real time, because virtual time itself failed "
        r"\(TypeError in link\.py, line \d+\)",
        str(recording.run.flags[-1]),
    )
    assert (recording.run.outcome, len(recording.trace.of_kind(CmdVel))) == ("finished", 2)


def test_what_virtual_time_cannot_follow_runs_in_real_time(recorded):
    recording = recorded("misbehaving/starts_a_program")
    assert recording.run.time == "real"
    does = msg("starts another program ({program})", program="sleep")
    why = msg("the submission {does}", does=does)
    assert recording.run.flags == (msg("graded in real time, because {why}", why=why),)


def test_who_waits_in_c_cannot_be_followed():
    plan, patience = Plan(Limits(0.5, 0.5, 5)), Patience(asleep_s=0.2)
    with open_submission(SUBMISSIONS / "misbehaving/blocks_in_c.py") as submission:
        recording, why = virtual_time._try(submission, plan, patience, None)
    assert recording is None
    assert "waits for something outside of Python's and ROS's own waiting" in str(why)


def test_who_stops_his_process_does_not_stop_the_grader(recorded):
    run = recorded("misbehaving/stops_itself").run
    assert (run.time, run.outcome, run.flags) == ("virtual", "stalled", (virtual_time.STOPPED,))


@pytest.mark.applies(hasattr(os, "sched_setaffinity"), reason="a process can choose its core")
def test_all_threads_of_a_run_share_one_core(recorded):
    recording = recorded("misbehaving/shows_its_cores")
    assert (recording.run.time, recording.run.exit_code) == ("virtual", 0)
    assert re.fullmatch(r"(\d+\n)(\1)+", recording.output)


def test_who_lies_to_the_simulator_spoils_his_own_run(recorded):
    recording = recorded("misbehaving/attacks_link")
    assert (recording.run.time, recording.run.outcome) == ("virtual", "killed")
    assert recording.run.flags == (NONSENSE,)
    assert len(recording.trace.of_kind(CmdVel)) == 1
