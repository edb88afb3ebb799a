"""The processor time of a whole grading is bounded: what it has reached is judged, and no more."""

import math

import grader
from grader.run.limits import CpuBudget
from tests.files import lay

EXERCISE = """\
exercise: everywhere
title: Drive from wherever you start
cpu_s: 1.5
limits: {first_motion_s: 10, rest_s: 5, total_s: 60}
varied_runs: {count: 3, seed: 1, nearest_m: 1.0, farthest_m: 2.0}
points: {drives: 1, drives_everywhere: 2, turns: 3}
"""
CHECKS = '''\
from grader import Checks, Finding

checks = Checks()

@checks()
def drives(recordings, tolerances):
    """It drives."""
    return Finding(float(recordings.nominal.trace.ticks > 0), "it drove")

@checks()
def drives_everywhere(recordings, tolerances):
    """It drives wherever it starts."""
    return Finding(float(all(run.trace.ticks for run in recordings)), "it drove")

@checks(after=("drives_everywhere",))
def turns(recordings, tolerances):
    """It turns."""
    return Finding(1.0, "it turned")
'''
#: Drives, and then computes for longer than any run may.
COMPUTES = """\
import rclpy
from geometry_msgs.msg import Twist

rclpy.init()
node = rclpy.create_node("computes")
velocity = node.create_publisher(Twist, "/turtle1/cmd_vel", 10)


def compute():
    velocity.publish(Twist())
    for _ in range(2_000_000):
        pass


node.create_timer(0.01, compute)
rclpy.spin(node)
"""


def test_what_a_grading_has_reached_within_its_budget_is_judged(tmp_path):
    exercise = lay(tmp_path / "everywhere", {"exercise.yaml": EXERCISE, "checks.py": CHECKS})
    (tmp_path / "computes.py").write_text(COMPUTES)
    spent = "the whole grading used more than 1.5 s of processor time"
    recordings = grader.record(tmp_path / "computes.py", exercise)
    grader.save_recordings(recordings, tmp_path / "kept")
    result = grader.judge(recordings, exercise)
    runs = [result.run, *result.varied_runs]
    assert {run.outcome for run in runs} == {"killed", "not_run"}
    assert (runs[0].outcome, runs[-1].outcome) == ("killed", "not_run")
    assert all(spent in map(str, run.flags) for run in runs)
    drives, everywhere, turns = result.verdicts
    assert (drives.status, drives.score) == ("passed", 1)
    assert (everywhere.status, str(everywhere.rationale)) == ("not_judged", f"Not judged: {spent}.")
    assert turns.status == "not_judged"
    assert spent in str(result.diagnosis.cause).lower()
    again = grader.judge(grader.load_recordings(tmp_path / "kept"), exercise)
    assert again.verdicts == result.verdicts


def test_a_budget_is_spent_when_more_was_taken_than_there_was():
    budget = CpuBudget(2.0)
    budget.spend(1.5)
    assert not budget.is_spent
    budget.spend(1.0)
    assert budget.is_spent
    assert not CpuBudget(math.inf).is_spent
