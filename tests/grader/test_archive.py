"""A right and a wrong hand-in of every exercise, run for real, leave the runs of the archive."""

import pytest

import grader
from grader.exercise.loading import load_exercise
from tests import archive


def hashes(result):
    return [run.trace_sha256 for run in (result.run, *result.varied_runs)]


def verdicts(result):
    return [(verdict.check, verdict.score, verdict.rationale) for verdict in result.verdicts]


@pytest.mark.parametrize("side", archive.SIDES)
@pytest.mark.parametrize("exercise", archive.EXERCISES)
def test_a_fresh_run_is_the_one_in_the_archive(exercise, side):
    loaded = load_exercise(exercise)
    with archive.hand_in(loaded, side) as path:
        fresh = grader.grade(path, loaded)
    kept = archive.result(exercise, side)
    assert (hashes(fresh), verdicts(fresh)) == (hashes(kept), verdicts(kept))
    assert (fresh.diagnosis and fresh.diagnosis.key) == (kept.diagnosis and kept.diagnosis.key)
    is_right = side == "right"
    assert (fresh.score == fresh.max_score, fresh.diagnosis is None) == (is_right, is_right)
