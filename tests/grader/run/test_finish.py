"""How a run ended, and the recording that is made of it, once."""

from dataclasses import fields, replace
from typing import get_args

import pytest

from grader.recording.recording import Outcome, ProgramRun, PublishedTopic, Run
from grader.recording.subject import Start
from grader.run.finish import Ending, outcome, record
from grader.run.handover import Plan
from grader.scenes.scene import Limits, Reason
from grader.text.message import Message, msg
from tests.grader.driving import Spiral, drive

REASONS = get_args(Reason)
#: (why the simulator stopped, exit code of the submission's process or None) -> outcome
EXPECTED = {
    **{(reason, None): "time_limit" for reason in REASONS},
    **{(reason, 0): "exited" for reason in REASONS},
    **{(reason, code): "finished" for reason in ("rest", "seen") for code in (None, 0)},
    **{(reason, code): "crashed" for reason in REASONS for code in (1, 255)},
    **{(reason, code): "killed" for reason in REASONS for code in (-9, -11)},
}
A, B, C = msg("a"), Message.of("b"), msg("c {n}", n=1)
RUN = Run("virtual", "crashed", -11, wall_s=1.23456, isolation="ROS domain 77", flags=(A, B))
RUN = replace(RUN, programs=(ProgramRun("a-1", "b", "a", "crashed", -11),))
ENDING = Ending(RUN, "printed\n")
KNOWN = (Limits(1, 2, 3), Start(1.0, 2.0, 3.0), "turtlesim", 42, (C,), "turtlesim")
PLAN = Plan(*KNOWN, case="late", drawn={"a": 7})
TOPICS = (PublishedTopic("/a", "b/msg/C"),)


@pytest.mark.parametrize(("reason", "exit_code"), EXPECTED)
def test_the_outcome_follows_from_the_reason_and_the_exit_code(reason, exit_code):
    assert outcome(reason, exit_code) == EXPECTED[reason, exit_code]


def test_all_outcomes_but_two_come_of_them():
    assert set(EXPECTED.values()) == set(get_args(Outcome)) - {"stalled", "not_run"}


@pytest.fixture(scope="module")
def trace():
    return drive(Spiral(), ticks=100).trace


def test_a_recording_has_everything_about_its_run(trace):
    made = record(PLAN, trace, TOPICS, ENDING)
    assert made.trace is trace
    assert made.run == Run(
        time="virtual",
        outcome="crashed",
        exit_code=-11,
        ticks=100,
        simulated_s=1.6,
        wall_s=1.235,
        trace_sha256=trace.sha256(),
        isolation="ROS domain 77",
        flags=(A, B, C),
        seed=42,
        interfaces="turtlesim",
        case="late",
        drawn={"a": 7},
        programs=RUN.programs,
    )
    assert (made.topics, made.output) == (TOPICS, "printed\n")
    assert (made.start, made.scene) == (Start(1.0, 2.0, 3.0), "turtlesim")
    assert all(getattr(made.run, f.name) != getattr(Run(), f.name) for f in fields(Run))


def test_what_the_run_itself_says_stands_before_what_was_known_before(trace):
    repeated = replace(PLAN, flags=(A, B))
    made = record(repeated, trace, TOPICS, ENDING.with_flags(C))
    assert made.run.flags == (C, A, B)
