"""The figures are those of the formulas, and absent where a formula has none."""

from __future__ import annotations

import math
import statistics

import pytest

from grader.batch.page.figures import BINS, LEAST, distribution, items
from tests.grader.batch.page.classes import result

POINTS = {"a": 10.0, "b": 10.0, "c": 10.0}


def of(*rows):
    """What comes out for students with so many points of a, b, c."""
    results = [result(dict(zip(POINTS, row, strict=True))) for row in rows]
    return {item.check: item for item in items(results, POINTS)}


def test_scores_are_spread_as_counted_by_hand():
    spread = distribution([0, 10, 10, 20, 35, 100], 100)
    assert (spread.mean, spread.median, spread.lowest, spread.highest) == (175 / 6, 15, 0, 100)
    assert spread.spread == pytest.approx(36.66, abs=0.01)
    assert spread.quartiles == (10, 31.25)
    assert [bar.count for bar in spread.bars] == [1, 2, 1, 1, 0, 0, 0, 0, 0, 1]
    assert (spread.full, spread.most, len(spread.bars)) == (1, 2, BINS)


def test_every_score_is_in_one_bar():
    scores = [k / 10 for k in range(1001)]
    assert sum(bar.count for bar in distribution(scores, 100).bars) == 1001


def test_one_score_has_no_spread_and_no_score_no_distribution():
    assert distribution([7], 10).spread == 0
    assert distribution([], 10) is None
    assert distribution([0], 0).bars[0].count == 1


def test_a_check_is_counted_by_what_became_of_it():
    item = of((10, 0, 0), (10, 0, 0), (4, 0, 0), (0, 0, 0), (-1, 0, 0))["a"]
    assert (item.count, item.passed, item.partial, item.failed, item.not_judged) == (5, 2, 1, 1, 1)
    assert item.difficulty == pytest.approx(2.4 / 5)


def test_discrimination_is_the_correlation_with_all_other_points():
    rows = [(10, 10, 3), (10, 4, 10), (0, 0, 5), (10, 7, 7), (0, 3, 0)] * 3
    found = of(*rows)["b"].discrimination
    assert found == pytest.approx(
        statistics.correlation([b for _, b, _ in rows], [a + c for a, _, c in rows])
    )


def test_of_all_or_nothing_it_is_the_point_biserial_correlation():
    rows = [(10, 10, 8), (10, 6, 6), (0, 5, 2), (10, 1, 9), (0, 0, 0), (0, 7, 3)] * 2
    rest = [b + c for _, b, c in rows]
    passed = [r for (a, _, _), r in zip(rows, rest, strict=True) if a]
    failed = [r for (a, _, _), r in zip(rows, rest, strict=True) if not a]
    p = len(passed) / len(rows)
    means = statistics.fmean(passed) - statistics.fmean(failed)
    by_hand = means / statistics.pstdev(rest) * math.sqrt(p * (1 - p))
    assert of(*rows)["a"].discrimination == pytest.approx(by_hand)


@pytest.mark.parametrize(
    ("rows", "why"),
    [
        ([(10, k % 11, 0) for k in range(20)], "all have the same points here"),
        ([(k % 11, 10, 0.1) for k in range(20)], "all have the same points elsewhere"),
        ([(k, k, k) for k in range(LEAST - 1)], "too few"),
    ],
)
def test_where_there_is_nothing_to_compare_it_says_so(rows, why):
    item = of(*rows)["a"]
    assert item.discrimination is None
    assert why in item.words


@pytest.mark.parametrize(
    ("rows", "words"),
    [
        ([(10, 10, 10), (0, 0, 0)] * 10, "very well"),
        ([(10, 0, 0), (0, 10, 10)] * 10, "look at what it asks for"),
        ([(10, 0, 0), (0, 0, 0), (10, 10, 10), (0, 10, 10)] * 5, "hardly"),
    ],
)
def test_a_figure_is_also_told_in_words(rows, words):
    assert words in of(*rows)["a"].words


def test_checks_stand_in_the_order_of_the_exercise_and_others_after_them():
    results = [result({"new": 1.0, "b": 10.0, "a": 0.0})] * 2
    assert [item.check for item in items(results, POINTS)] == ["a", "b", "new"]
