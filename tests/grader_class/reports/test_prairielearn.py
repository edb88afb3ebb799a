import json
from dataclasses import replace

import numpy as np
import pytest

from grader.reports import read as read_report
from grader_class.reports import prairielearn
from tests.grader.driving import Spiral, drive
from tests.grader.reports import readers, samples
from tests.grader.reports.samples import verdict


def test_picture_and_output_are_in_it_and_still_fit_where_they_are_noise_and_a_flood(tmp_path):
    noise = np.random.default_rng(1).integers(0, 256, (500, 500, 3), dtype=np.uint8)
    drawn = drive(Spiral(), ticks=200)
    recording = replace(drawn, trace=replace(drawn.trace, window=noise))
    path = samples.graded(tmp_path, drawn, output="printed")
    found = json.loads(prairielearn.render(read_report(path)))
    assert found["images"][0]["url"].startswith("data:image/png;base64,")
    assert found["output"] == "printed"
    path = samples.graded(tmp_path, recording, output="x" * 3_000_000)
    content = prairielearn.render(read_report(path))
    readers.prairielearn(content)
    assert json.loads(content)["images"]


def test_if_all_else_fails_the_points_remain():
    many = [verdict(f"v{i}", "failed", 1, rationale="🐢" * 2000) for i in range(400)]
    content = prairielearn.render(samples.report(*many))
    assert readers.prairielearn(content) == 400


def test_the_score_is_a_share_and_without_points_all_or_nothing():
    found = json.loads(prairielearn.render(samples.report()))
    assert (found["score"], found["gradable"]) == (pytest.approx(18.33 / 40), True)
    passed = prairielearn.render(samples.report(verdict("a", score=0, max_score=0)))
    failed = prairielearn.render(samples.report(verdict("a", "failed", 0, max_score=0)))
    assert (json.loads(passed)["score"], json.loads(failed)["score"]) == (1, 0)
