"""What submissions send, hear and are told in the corners of messages and services.

The hashes, and the outputs in `messages/`, are those of the time when DDS still carried messages in
virtual time. Where it lost some, or the run could not be made, they are as they must be.
"""

import re
import sys
from pathlib import Path

import numpy as np
import pytest
import yaml

from grader.system import versions
from grader.text.message import msg
from tests.tiers import others_are_more

OUTPUTS = Path(__file__).parent / "messages"
RUNS = yaml.safe_load(Path(__file__).with_suffix(".yaml").read_text())

STALLED = msg("the node used {seconds} s of processor time without waiting for ROS", seconds="0")
UNREADABLE = msg("a message on {channel} could not be read", channel="topic /turtle1/cmd_vel")
ITS_OWN_CLOCK = msg("the parameter use_sim_time cannot be set: the run has a clock of its own")
FLAGS = {
    "hangs_after_command": (STALLED,),
    "hangs_while_driving": (STALLED,),
    "raw_messages": (UNREADABLE,),
    "follows_clock": (ITS_OWN_CLOCK,),
}
#: Services, actions, QoS, a graph that changes, threads, bytes, what dies and what hangs.
KEPT = (
    *("asks_the_dead", "endpoints_come_and_go", "own_action", "own_qos", "own_services"),
    *("raw_messages", "spawn_while_driving", "threads_publish"),
)
OTHERS = "one of each kind is kept"


@pytest.mark.parametrize(
    "name", others_are_more(OTHERS, RUNS, *KEPT, "dies_long_after_command", "lifecycle")
)
def test_messages_count_when_they_should(recorded, name):
    run = recorded(f"messages/{name}").run
    assert (run.time, run.flags) == ("virtual", FLAGS.get(name, ()))
    assert [run.outcome, run.exit_code, run.trace_sha256[:16]] == RUNS[name]


@pytest.mark.applies(
    versions.rclpy_version().startswith("7.")
    and sys.version_info[:2] == (3, 11)
    and np.__version__ >= "2",
    reason="recorded with the order of rclpy 7, Python 3.11, and numpy 2, which draws no number",
)
@pytest.mark.parametrize(
    "name", others_are_more(OTHERS, sorted(path.stem for path in OUTPUTS.glob("*.txt")), *KEPT)
)
def test_a_program_hears_and_is_told_what_it_should(recorded, name):
    output = recorded(f"messages/{name}").output
    assert _without_the_machine(output) == (OUTPUTS / f"{name}.txt").read_text()


def test_a_lifecycle_node_tells_of_its_states_on_a_topic_of_its_own(recorded):
    topics = [topic.topic for topic in recorded("messages/lifecycle").topics]
    assert topics == ["/driver/transition_event", "/turtle1/cmd_vel"]


def _without_the_machine(output: str) -> str:
    """Logged lines carry its time, tracebacks where its Python is, and which 3.11 that is."""
    output = re.sub(r"\[\d+\.\d{9}\]", "[when]", output)
    return re.sub(r'File "/\S*/lib/python3\.11/(\S+)", line \d+', r'File "\1", line N', output)
