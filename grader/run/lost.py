"""A run whose simulator ended too early: repeated once, and then judged by what is there, nothing.

A simulator that ends beside one submission, whenever that runs, ends because of it: whoever could
have the grader fail at will would get "not the submission's fault" for a wrong solution. Where it
ends before the submission has said anything to it, the grader has failed.
"""

from __future__ import annotations

from grader.errors import GraderFailure
from grader.recording.recording import Recording
from grader.run.finish import Ending, record
from grader.run.plan import Plan
from grader.scenes import load_scene
from grader.text import without_controls

#: For the result, with how it ended and its last line.
TWICE = (
    "the simulator ended while the node was running, in both tries, and nothing was recorded: {}. "
    "What only drives cannot do that; if this node does nothing else, the grader is wrong"
)
LONGEST_WORDS = 200


class SimulatorLost(GraderFailure):
    """The simulator's process ended, or left nothing to be read, beside a submission's.

    Attributes:
        ending: what is known of the run.
    """

    def __init__(self, failure: GraderFailure, ending: Ending) -> None:
        super().__init__(failure.message)
        self.ending = ending


def judged_all_the_same(plan: Plan, lost: SimulatorLost) -> Recording:
    """The recording of a run that was lost twice: nothing has happened in it."""
    how, _, last_words = lost.message.partition(" Its last words:\n")
    # what stands in brackets is ROS's log, and has the submission's words in it
    lines = [line for line in last_words.splitlines() if line and not line.startswith("[")]
    told = [without_controls(text, "?")[:LONGEST_WORDS] for text in (how.rstrip("."), *lines[-1:])]
    flag = TWICE.format("; ".join(told))
    trace = load_scene(plan.scene).untouched(plan.start)
    ending = lost.ending
    return record(plan, trace, (), Ending(**{**vars(ending), "flags": (*ending.flags, flag)}))
