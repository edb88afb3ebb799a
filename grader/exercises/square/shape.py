"""Whether one way is the square that was asked for: its sides, corners, straightness, return."""

from __future__ import annotations

from collections.abc import Callable

from grader.exercise.check import Tolerances
from grader.exercise.sentences import counted
from grader.exercise.verdict import Evidence, Finding
from grader.exercises.square.way import Way

SIDES = 4


def judge_sides(way: Way, tolerances: Tolerances) -> Finding:
    """How many sides there are, and how long."""
    wanted, error = tolerances["side_m"], tolerances["side_error_m"]
    found = way.sides(tolerances)
    good = [abs(side.length_m - wanted) <= error for side in found]
    lengths = some([f"{side.length_m:.2f}" for side in found])
    seen = f"{counted(len(found), 'straight side')}, {lengths} m long"
    if all(good) and len(found) == SIDES:
        return Finding(1, f"{seen}: four, within {error} m of {wanted} m.")
    return Finding(
        part(sum(good), len(found)),
        f"{seen}; {sum(good)} of them within {error} m of {wanted} m. There should be {SIDES}.",
        "How far a turtle gets is its speed times how long it drives. Which of your sides is "
        "too long, too short, missing, or too many?",
        tuple(
            way.evidence(side.last, f"here ends a side of {side.length_m:.2f} m")
            for side, is_good in zip(found, good, strict=True)
            if not is_good
        )[:SIDES],
    )


def judge_corners(way: Way, tolerances: Tolerances) -> Finding:
    """How many corners there are, and how sharp."""
    error = tolerances["corner_error_deg"]
    found = way.corners(tolerances)
    left = sum(corner.turn_deg > 0 for corner in found) * 2 >= len(found)
    good = [abs((c.turn_deg if left else -c.turn_deg) - 90.0) <= error for c in found]
    if not found:
        return Finding(
            0,
            "The way has no corner.",
            "The turtle has to stop going ahead, turn on the spot, and go on.",
            (way.evidence(-1, "no corner up to here"),),
        )
    turns = some([f"{corner.turn_deg:+.0f}" for corner in found])
    seen = f"{counted(len(found), 'corner')}, turning by {turns} degrees (+ is to the left)"
    if all(good) and len(found) == SIDES:
        return Finding(1, f"{seen}: four, within {error} degrees of 90.")
    return Finding(
        part(sum(good), len(found)),
        f"{seen}; {sum(good)} of them within {error} degrees of 90 to the same hand. "
        f"There should be {SIDES}; the start counts as one if the way leads back to it.",
        "How far a turtle turns is its angular speed times how long it turns, in radians. By how "
        "much does it have to turn in a corner of a square, and how often?",
        tuple(
            way.evidence(corner.index, f"a turn by {corner.turn_deg:+.0f} degrees")
            for corner, is_good in zip(found, good, strict=True)
            if not is_good
        )[:SIDES],
    )


def judge_straight(way: Way, tolerances: Tolerances) -> Finding:
    """How far the way lies beside the straight lines between its corners."""
    limit = tolerances["crooked_m"]
    found = way.sides(tolerances)
    crooked = [side for side in found if side.crooked_m > limit]
    worst = max(found, key=lambda side: side.crooked_m)
    if not crooked:
        return Finding(
            1, f"The way lies at most {worst.crooked_m:.2f} m beside its sides; {limit} m is fine."
        )
    return Finding(
        1 - len(crooked) / len(found),
        f"{len(crooked)} of {len(found)} sides are crooked: the way lies up to "
        f"{worst.crooked_m:.2f} m beside the straight line; {limit} m is fine.",
        "Does the turtle turn while it goes ahead? In the middle of a side it should not; in a "
        "corner the way may be a little round.",
        tuple(
            way.evidence(side.crooked_at, f"{side.crooked_m:.2f} m beside the straight line")
            for side in crooked
        )[:SIDES],
    )


def judge_returns(way: Way, tolerances: Tolerances) -> Finding:
    """Where it came to rest, and whether it had been there before."""
    lap_end = way.return_to_start(tolerances)
    if not way.rests(tolerances):
        seen = "did not return to it" if lap_end is None else "returned to it and drove on"
        return Finding(
            0 if lap_end is None else 0.5,
            f"turtle1 started at {way.place(0)}, {seen}, and never came to rest.",
            "The square is done when the turtle is back: how does your node notice?",
            (way.evidence(-1 if lap_end is None else lap_end, seen),),
        )
    gap = float(way.gap_m[-1])
    here = way.evidence(-1, f"here it came to rest, {gap:.2f} m from its start")
    seen = (
        f"turtle1 started at {way.place(0)} and came to rest at {way.place(-1)}, {gap:.2f} m away"
    )
    if gap > tolerances["return_m"]:
        near = gap <= tolerances["near_m"]
        return Finding(
            0.5 if near or lap_end is not None else 0,
            f"{seen}; {tolerances['return_m']} m is fine.",
            "Errors in sides and corners add up. Which of the sides does not fit the one opposite?",
            (here,),
        )
    further = 0.0 if lap_end is None else way.length_from(lap_end)
    if lap_end is None or further > tolerances["further_m"]:
        what = (
            "was never away"
            if lap_end is None
            else f"had been back and drove on for {further:.2f} m"
        )
        return Finding(
            0 if lap_end is None else 0.5,
            f"{seen}, but it {what}.",
            "Once round is enough: how many sides does your node drive?",
            (here,)
            if lap_end is None
            else (
                way.evidence(lap_end, f"back for the first time, {further:.2f} m before the end"),
                here,
            ),
        )
    return Finding(1, f"{seen}; {tolerances['return_m']} m is fine.", evidence=(here,))


def judge_square(way: Way, tolerances: Tolerances) -> tuple[float, str, list[Evidence]]:
    """All parts of a run from elsewhere: the share that is right, what is wrong, and where."""
    if way.moved_away:
        why = "it does not count, because your node had the turtle put somewhere else first"
        return 0.0, why, [way.evidence(0, "here it drove off")]
    if way.length_m < tolerances["driven_m"]:
        return 0.0, f"it drove {way.length_m:.2f} m", []
    if way.broken_by:
        return 0.0, way.broken_by, [way.evidence(-1, f"after this, {way.broken_by}")]
    parts: list[Callable[[Way, Tolerances], Finding]]
    parts = [judge_sides, judge_corners, judge_returns]
    findings = [judge(way, tolerances) for judge in parts]
    if findings[1].share >= 1:
        findings.append(judge_straight(way, tolerances))
    wrong = [finding for finding in findings if finding.share < 1]
    share = sum(finding.share for finding in findings) / (len(parts) + 1)
    text = "; ".join(finding.rationale.rstrip(".") for finding in wrong)
    return share, text, [item for finding in wrong for item in finding.evidence[:1]]


def part(good: int, found: int) -> float:
    """The share for so many good ones out of so many, where four are wanted."""
    return min(good, SIDES) / max(found, SIDES)


def some(texts: list[str]) -> str:
    """The first of many texts."""
    return ", ".join(texts[:8]) + (", ..." if len(texts) > 8 else "")
