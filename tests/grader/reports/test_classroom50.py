from __future__ import annotations

import json

import pytest

from grader.errors import UsageError
from grader.reports import classroom50
from tests.grader.reports import readers, samples


@pytest.fixture
def environment(monkeypatch):
    for name in ("USERNAME", *samples.CLASSROOM50):
        monkeypatch.delenv(name, raising=False)

    def use(**changes):
        for name, value in (samples.CLASSROOM50 | changes).items():
            monkeypatch.setenv(name, value) if value else monkeypatch.delenv(name, raising=False)

    return use


def document():
    content = classroom50.render(samples.report())
    readers.classroom50(content)
    return json.loads(content)


def test_who_and_what_come_from_the_environment(environment):
    environment()
    found = document()
    assert (found["classroom"], found["assignment"], found["owner"]) == ("ros-1", "spiral", "ada")
    assert found["submission"] == samples.CLASSROOM50["SUBMISSION_TAG"]
    assert found["commit"] == samples.CLASSROOM50["COMMIT_URL"]
    assert found["review"] == samples.CLASSROOM50["REVIEW_URL"]


def test_points_are_whole_and_the_exact_ones_stand_beside_them(environment):
    environment()
    found = document()
    assert (found["score"], found["max-score"]) == (18, 40)
    draws = found["tests"][1]
    assert (draws["score"], draws["exact-score"], draws["passed"]) == (8, 8.33, False)


def test_the_owner_can_come_as_username_and_the_review_as_the_commit(environment):
    environment(OWNER="", USERNAME="grace", REVIEW_URL="", ASSIGNMENT_TYPE="")
    found = document()
    assert (found["owner"], found["assignment_type"]) == ("grace", "individual")
    assert found["review"] == found["commit"]


def test_elsewhere_it_says_what_is_missing(environment):
    environment(CLASSROOM="", OWNER="")
    with pytest.raises(UsageError, match=r"not set: CLASSROOM, OWNER \(or USERNAME\)"):
        document()


@pytest.mark.parametrize(("name", "value"), [("SUBMISSION_TAG", "v1"), ("ASSIGNMENT_TYPE", "pair")])
def test_what_the_schema_would_refuse_is_refused_with_its_value(environment, name, value):
    environment(**{name: value})
    with pytest.raises(UsageError, match=f"{name} is '{value}'"):
        document()
