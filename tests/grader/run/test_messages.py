"""What submissions send, hear and are told in the corners of messages and services.

The hashes, and the outputs in `messages/`, are those of the time when DDS still carried messages in
virtual time. Where it lost some, or the run could not be made, they are as they must be.
"""

import re
import sys
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import pytest

from grader.message import msg
from grader.recording.recording import Recording
from grader.run.clock import executor
from tests.tiers import others_are_more

OUTPUTS = Path(__file__).parent / "messages"

Recorded = Callable[..., Recording]


class Expected(NamedTuple):
    """How a run ends, and the beginning of the hash of its trace."""

    trace: str
    outcome: str = "finished"
    exit_code: int | None = 0


AS_WITH_DDS = {
    "computes": Expected("a1c202d7e6700053", "finished", None),
    "destroyed_things": Expected("aa8e8f0f16a3435c"),
    "dies_after_command": Expected("25f3c57ec48b32db", "crashed", 3),
    "dies_in_sleep": Expected("4985d85eeec38f7d", "crashed", 5),
    "dies_long_after_command": Expected("e64397ea98234dc0", "killed", -9),
    "endpoints_come_and_go": Expected("7ff035e428c9800e"),
    "event_of_gone": Expected("b222e0a41fc7873a"),
    "floods_now_and_then": Expected("d50a3b187509d48f", "finished", None),
    "graph_changes": Expected("ff4993249cfd6203"),
    "hangs_after_command": Expected("6d825b5b79d68b21", "stalled", None),
    "hangs_while_driving": Expected("56c2693433c1493e", "stalled", None),
    "lifecycle": Expected("e26a3a4ea39227b4", "finished", None),
    "many_calls": Expected("7ff6f7efc2bdb23a"),
    "names": Expected("90b115683adfb659"),
    "own_action": Expected("e5e9a9f47e916c01"),
    "own_qos": Expected("dc9b68e92a574794"),
    "own_services": Expected("12657c7c2a6f60ce", "finished", None),
    "parameter_clients": Expected("bde670058b9d25fe"),
    "pictures": Expected("12fb4dc2e5b13f1d"),
    "publishes_on_color": Expected("8232fd9bb16dc203", "finished", None),
    "qos_warnings": Expected("4b331a210d8e7860"),
    "spawn_while_driving": Expected("a84aad7d6351c0b7"),
    "thread_raises": Expected("1d33d9438bfbf95e"),
    "threads_publish": Expected("3f3e26b06fc2e1e0"),
}
NOT_WITH_DDS = {
    "asks_the_dead": Expected("e469489ae5957b4f", "finished", None),
    "contexts": Expected("b50b12face28d192"),
    "follows_clock": Expected("58fb7d999da9fc97"),
    "made_classes": Expected("8bed1e70f80ddea8", "exited"),
    "raw_messages": Expected("940c4e79b5f151a1", "finished", None),
    "rotates_on": Expected("57c51c00a6ba3742"),
}
RUNS = AS_WITH_DDS | NOT_WITH_DDS

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
def test_messages_count_when_they_should(recorded: Recorded, name: str) -> None:
    run = recorded(f"messages/{name}").run
    expected = RUNS[name]
    assert (run.time, run.flags) == ("virtual", FLAGS.get(name, ()))
    assert (run.outcome, run.exit_code) == (expected.outcome, expected.exit_code)
    assert run.trace_sha256[:16] == expected.trace


@pytest.mark.applies(
    executor.known() is reversed and sys.version_info[:2] == (3, 11),
    reason="recorded with the order of rclpy 7 and with Python 3.11, which tell some milliseconds",
)
@pytest.mark.parametrize(
    "name", others_are_more(OTHERS, sorted(path.stem for path in OUTPUTS.glob("*.txt")), *KEPT)
)
def test_a_program_hears_and_is_told_what_it_should(recorded: Recorded, name: str) -> None:
    output = recorded(f"messages/{name}").output
    assert _without_the_machine(output) == (OUTPUTS / f"{name}.txt").read_text()


def test_a_lifecycle_node_tells_of_its_states_on_a_topic_of_its_own(recorded: Recorded) -> None:
    topics = [topic.topic for topic in recorded("messages/lifecycle").topics]
    assert topics == ["/driver/transition_event", "/turtle1/cmd_vel"]


def _without_the_machine(output: str) -> str:
    """Logged lines carry its time, tracebacks where its Python is, and which 3.11 that is."""
    output = re.sub(r"\[\d+\.\d{9}\]", "[when]", output)
    return re.sub(r'File "/\S*/lib/python3\.11/(\S+)", line \d+', r'File "\1", line N', output)
