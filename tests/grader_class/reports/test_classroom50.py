import json
from decimal import ROUND_HALF_UP, Decimal

import pytest
from hypothesis import given
from hypothesis import strategies as st

from grader.errors import UsageError
from grader_class.reports import classroom50
from grader_class.reports.classroom50 import whole_points
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
    assert (found["score"], found["max-score"]) == (18, 40)
    draws = found["tests"][1]
    assert (draws["score"], draws["exact-score"], draws["passed"]) == (8, 8.33, False)
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


def whole(*pairs):
    verdicts = [
        samples.verdict(f"v{i}", "passed" if s == m else "failed", s, max_score=m)
        for i, (s, m) in enumerate(pairs)
    ]
    return whole_points(samples.report(*verdicts).verdicts)


def test_points_become_whole():
    assert whole((5, 5), (0, 25), (20, 20)) == ([5, 0, 20], [5, 25, 20])
    # 33.33 + 8.4 + 2.3 = 44.03: what rounding down loses goes where most was lost
    assert whole((33.33, 50), (8.4, 10), (2.3, 5))[0] == [33, 9, 2]
    assert sum(whole((12.5, 30), (70, 70))[0]) == 83
    assert sum(whole((12.49, 30), (70, 70))[0]) == 82
    # where checks are worth a fraction, everything is multiplied
    assert whole((2.5, 2.5), (1.25, 5)) == ([25, 13], [25, 50])
    assert whole_points([]) == ([], [])


@given(
    st.lists(
        st.tuples(st.sampled_from([0, 1, 5, 10, 2.5, 33.33]), st.floats(0, 1)),
        min_size=1,
        max_size=10,
    )
)
def test_parts_add_up_to_the_rounded_total_and_none_is_off_by_a_point(drawn):
    pairs = [(round(most * share, 2), most) for most, share in drawn]
    scores, max_scores = whole(*pairs)
    factor = sum(max_scores) / (sum(Decimal(str(most)) for _, most in pairs) or Decimal(1))
    exact = [Decimal(str(score)) * factor for score, _ in pairs]
    assert sum(scores) == int(sum(exact).to_integral_value(ROUND_HALF_UP))
    for got, want, most in zip(scores, exact, max_scores, strict=True):
        assert abs(got - want) < 1
        assert 0 <= got <= most
