"""Whether one way is the square that was asked for: its sides, corners, straightness, return.

What these findings say is a clause, without its full stop: several may stand in one sentence.
"""

from __future__ import annotations

from collections.abc import Callable

from grader.exercise.check import Tolerances
from grader.exercise.verdict import Evidence, Finding
from grader.exercises.square.way import Way
from grader.language.phrase import Phrase, joined, say, say_many

SIDES = 4


def judge_sides(way: Way, tolerances: Tolerances) -> Finding:
    """How many sides there are, and how long."""
    wanted, error = tolerances["side_m"], tolerances["side_error_m"]
    found = way.sides(tolerances)
    good = [abs(side.length_m - wanted) <= error for side in found]
    seen = say_many(
        "{n} straight side, {lengths} m long",
        "{n} straight sides, {lengths} m long",
        len(found),
        lengths=some([f"{side.length_m:.2f}" for side in found]),
    )
    near = {"seen": seen, "error_m": error, "wanted_m": wanted}
    if all(good) and len(found) == SIDES:
        return Finding(1, say("{seen}: four, within {error_m} m of {wanted_m} m", **near))
    return Finding(
        part(sum(good), len(found)),
        say(
            "{seen}; {right} of them within {error_m} m of {wanted_m} m. There should be {sides}",
            right=sum(good),
            sides=SIDES,
            **near,
        ),
        say(
            "How far a turtle gets is its speed times how long it drives. Which of your sides is "
            "too long, too short, missing, or too many?"
        ),
        tuple(
            way.evidence(
                side.last, say("here ends a side of {length_m:.2f} m", length_m=side.length_m)
            )
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
            say("The way has no corner"),
            say("The turtle has to stop going ahead, turn on the spot, and go on."),
            (way.evidence(-1, say("no corner up to here")),),
        )
    seen = say_many(
        "{n} corner, turning by {turns} degrees (+ is to the left)",
        "{n} corners, turning by {turns} degrees (+ is to the left)",
        len(found),
        turns=some([f"{corner.turn_deg:+.0f}" for corner in found]),
    )
    if all(good) and len(found) == SIDES:
        text = say("{seen}: four, within {error_deg} degrees of 90", seen=seen, error_deg=error)
        return Finding(1, text)
    return Finding(
        part(sum(good), len(found)),
        say(
            "{seen}; {right} of them within {error_deg} degrees of 90 to the same hand. There "
            "should be {corners}; the start counts as one if the way leads back to it",
            seen=seen,
            right=sum(good),
            error_deg=error,
            corners=SIDES,
        ),
        say(
            "How far a turtle turns is its angular speed times how long it turns, in radians. By "
            "how much does it have to turn in a corner of a square, and how often?"
        ),
        tuple(
            way.evidence(corner.index, say("a turn by {turn:+.0f} degrees", turn=corner.turn_deg))
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
            1,
            say(
                "The way lies at most {beside_m:.2f} m beside its sides; {limit_m} m is fine",
                beside_m=worst.crooked_m,
                limit_m=limit,
            ),
        )
    return Finding(
        1 - len(crooked) / len(found),
        say(
            "{crooked} of {sides} sides are crooked: the way lies up to {beside_m:.2f} m beside "
            "the straight line; {limit_m} m is fine",
            crooked=len(crooked),
            sides=len(found),
            beside_m=worst.crooked_m,
            limit_m=limit,
        ),
        say(
            "Does the turtle turn while it goes ahead? In the middle of a side it should not; in a "
            "corner the way may be a little round."
        ),
        tuple(
            way.evidence(
                side.crooked_at,
                say("{beside_m:.2f} m beside the straight line", beside_m=side.crooked_m),
            )
            for side in crooked
        )[:SIDES],
    )


def judge_returns(way: Way, tolerances: Tolerances) -> Finding:
    """Where it came to rest, and whether it had been there before."""
    lap_end = way.return_to_start(tolerances)
    if not way.rests(tolerances):
        return _never_at_rest(way, lap_end)
    gap = float(way.gap_m[-1])
    here = way.evidence(-1, say("here it came to rest, {gap_m:.2f} m from its start", gap_m=gap))
    seen = say(
        "turtle1 started at {start} and came to rest at {end}, {gap_m:.2f} m away",
        start=way.place(0),
        end=way.place(-1),
        gap_m=gap,
    )
    fine = say("{seen}; {limit_m} m is fine", seen=seen, limit_m=tolerances["return_m"])
    if gap > tolerances["return_m"]:
        near = gap <= tolerances["near_m"]
        return Finding(
            0.5 if near or lap_end is not None else 0,
            fine,
            say(
                "Errors in sides and corners add up. Which of the sides does not fit the one "
                "opposite?"
            ),
            (here,),
        )
    help_ = say("Once round is enough: how many sides does your node drive?")
    if lap_end is None:
        return Finding(0, say("{seen}, but it was never away", seen=seen), help_, (here,))
    further = way.length_from(lap_end)
    if further > tolerances["further_m"]:
        text = say(
            "{seen}, but it had been back and drove on for {further_m:.2f} m",
            seen=seen,
            further_m=further,
        )
        back = say("back for the first time, {further_m:.2f} m before the end", further_m=further)
        return Finding(0.5, text, help_, (way.evidence(lap_end, back), here))
    return Finding(1, fine, evidence=(here,))


def _never_at_rest(way: Way, lap_end: int | None) -> Finding:
    help_ = say("The square is done when the turtle is back: how does your node notice?")
    start = way.place(0)
    if lap_end is None:
        text = say(
            "turtle1 started at {start}, did not return to it, and never came to rest", start=start
        )
        return Finding(0, text, help_, (way.evidence(-1, say("did not return to it")),))
    text = say(
        "turtle1 started at {start}, returned to it and drove on, and never came to rest",
        start=start,
    )
    note = say("returned to it and drove on")
    return Finding(0.5, text, help_, (way.evidence(lap_end, note),))


def judge_square(way: Way, tolerances: Tolerances) -> tuple[float, str, list[Evidence]]:
    """All parts of a run from elsewhere: the share that is right, what is wrong, and where."""
    if way.moved_away:
        why = say("it does not count, because your node had the turtle put somewhere else first")
        return 0.0, why, [way.evidence(0, say("here it drove off"))]
    if way.length_m < tolerances["driven_m"]:
        return 0.0, say("it drove {way_m:.2f} m", way_m=way.length_m), []
    if way.broken_by:
        note = say("after this, {what}", what=way.broken_by)
        return 0.0, way.broken_by, [way.evidence(-1, note)]
    parts: list[Callable[[Way, Tolerances], Finding]]
    parts = [judge_sides, judge_corners, judge_returns]
    findings = [judge(way, tolerances) for judge in parts]
    if findings[1].share >= 1:
        findings.append(judge_straight(way, tolerances))
    wrong = [finding for finding in findings if finding.share < 1]
    share = sum(finding.share for finding in findings) / (len(parts) + 1)
    text = joined([finding.rationale for finding in wrong], say("; "))
    return share, text, [item for finding in wrong for item in finding.evidence[:1]]


def part(good: int, found: int) -> float:
    """The share for so many good ones out of so many, where four are wanted."""
    return min(good, SIDES) / max(found, SIDES)


def some(texts: list[str]) -> Phrase:
    """The first of many texts."""
    return joined([*texts[:8], *(["..."] if len(texts) > 8 else [])], ", ")
