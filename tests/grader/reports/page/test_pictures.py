import math

from grader.reports.page.pictures import RADIUS_PX, pins
from tests.grader.reports import samples
from tests.grader.reports.samples import evidence, verdict


def test_pins_of_one_place_do_not_hide_each_other_and_stay_inside():
    crowd = [evidence(x=11.0, y=0.1) for _ in range(6)]
    placed = pins(samples.report(verdict("a", evidence=crowd)), 0)
    heads = [(pin.head_x, pin.head_y) for pin in placed]
    assert all(RADIUS_PX <= c <= 500 - RADIUS_PX for head in heads for c in head)
    for i, one in enumerate(heads):
        assert all(math.dist(one, other) >= 2 * RADIUS_PX for other in heads[:i])


def test_pins_stand_in_order_and_in_their_run_only():
    report = samples.report(
        verdict("a", evidence=[evidence(), evidence(run=1)]),
        verdict("b", "failed", 0, evidence=[evidence()]),
    )
    assert [(p.point.number, p.status) for p in pins(report, 0)] == [(1, "passed"), (3, "failed")]
    assert [p.point.number for p in pins(report, 1)] == [2]


def test_a_place_that_is_nowhere_has_no_pin_and_one_outside_is_at_the_edge():
    report = samples.report(
        verdict("a", evidence=[evidence(x=float("nan")), evidence(x=99.0, y=-5.0)])
    )
    (pin,) = pins(report, 0)
    assert (pin.x, pin.y) == (500, 500)
