from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

from grader.reports import prairielearn
from grader.reports import read as read_report
from tests.grader.driving import Spiral, drive
from tests.grader.reports import readers, samples
from tests.grader.reports.samples import verdict


def test_the_score_is_a_share():
    found = json.loads(prairielearn.render(samples.report()))
    assert found["score"] == pytest.approx(18.33 / 40)
    assert found["gradable"] is True


def test_the_picture_is_in_it(tmp_path):
    path = samples.graded(tmp_path, drive(Spiral(), ticks=200), output="printed")
    content = prairielearn.render(read_report(path))
    readers.prairielearn(content)
    found = json.loads(content)
    assert found["images"][0]["url"].startswith("data:image/png;base64,")
    assert found["output"] == "printed"


def test_a_picture_of_noise_and_a_flood_of_output_still_fit(tmp_path):
    noise = np.random.default_rng(1).integers(0, 256, (500, 500, 3), dtype=np.uint8)
    drawn = drive(Spiral(), ticks=200)
    recording = replace(drawn, trace=replace(drawn.trace, window=noise))
    path = samples.graded(tmp_path, recording, output="x" * 3_000_000)
    content = prairielearn.render(read_report(path))
    readers.prairielearn(content)
    assert json.loads(content)["images"]


def test_if_all_else_fails_the_points_remain():
    many = [verdict(f"v{i}", "failed", 1, rationale="🐢" * 2000) for i in range(400)]
    content = prairielearn.render(samples.report(*many))
    assert readers.prairielearn(content) == 400


def test_an_exercise_without_points_is_all_or_nothing():
    passed = prairielearn.render(samples.report(verdict("a", score=0, max_score=0)))
    failed = prairielearn.render(samples.report(verdict("a", "failed", 0, max_score=0)))
    assert (json.loads(passed)["score"], json.loads(failed)["score"]) == (1, 0)
