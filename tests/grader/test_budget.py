"""The processor time of a whole grading is bounded: what it has reached is judged, and no more."""

from __future__ import annotations

import math
import subprocess
import sys
from pathlib import Path

import pytest

import grader
from grader.run.limits import CpuBudget

EXERCISE = """\
exercise: everywhere
title: Drive from wherever you start
cpu_s: 3
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


@pytest.fixture
def exercise(tmp_path: Path) -> Path:
    folder = tmp_path / "everywhere"
    folder.mkdir()
    (folder / "exercise.yaml").write_text(EXERCISE)
    (folder / "checks.py").write_text(CHECKS)
    return folder


def test_what_a_grading_has_reached_within_its_budget_is_judged(exercise, tmp_path):
    (tmp_path / "computes.py").write_text(COMPUTES)
    spent = "the whole grading used more than 3 s of processor time"
    done = subprocess.run(
        [
            *(sys.executable, "-m", "grader", "run", tmp_path / "computes.py"),
            *("--exercise", exercise, "--out", tmp_path / "out"),
        ],
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    result = grader.Result.read(tmp_path / "out" / "result.json")
    runs = [result.run, *result.varied_runs]
    assert {run.outcome for run in runs} == {"killed", "not_run"}
    assert (runs[0].outcome, runs[-1].outcome) == ("killed", "not_run")
    assert all(spent in map(str, run.flags) for run in runs)
    drives, everywhere, turns = result.verdicts
    assert (drives.status, drives.score) == ("passed", 1)
    assert (everywhere.status, str(everywhere.rationale)) == (
        "not_judged",
        f"Not judged: {spent}.",
    )
    assert turns.status == "not_judged"
    assert spent in str(result.diagnosis.cause).lower()
    again = grader.judge(grader.load_recordings(tmp_path / "out" / "recording"), exercise)
    assert again.verdicts == result.verdicts


def test_a_budget_is_spent_when_more_was_taken_than_there_was():
    budget = CpuBudget(2.0)
    budget.spend(1.5)
    assert not budget.is_spent
    budget.spend(1.0)
    assert budget.is_spent
    assert not CpuBudget(math.inf).is_spent
