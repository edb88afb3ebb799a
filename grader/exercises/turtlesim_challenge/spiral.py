"""Judges whether the path is the spiral that was asked for, and what part of it is."""

from __future__ import annotations

from collections.abc import Mapping

from grader.exercise.check import Tolerances
from grader.exercise.verdict import Evidence, Finding
from grader.exercises.turtlesim_challenge import shape
from grader.exercises.turtlesim_challenge.commands import why_no_wider, why_so_few_turns
from grader.exercises.turtlesim_challenge.path import Path
from grader.text.message import NOTHING, Message, chained, joined, msg


def judge_spiral(path: Path, tolerances: Tolerances) -> Finding:
    """Judge the start, the turns and the growth, each for its points."""
    parts = {
        "start": (tolerances["share_start"], *_start(path, tolerances)),
        "turns": (tolerances["share_turns"], *_turns(path, tolerances)),
    }
    rest = 1 - tolerances["share_start"] - tolerances["share_turns"]
    parts["growth"] = (rest, *_growth(path, tolerances))
    missed = [text for _, text, _ in parts.values() if text]
    if not missed:
        return Finding(1, _all_right(path))
    cause = None
    if parts["growth"][1]:
        few = shape.turns(path)[0] < tolerances["turns"]
        cause = why_so_few_turns(path) if few else why_no_wider(path)
    if cause is not None:
        missed.insert(0, cause.text)
    good = {name: share for name, (share, text, _) in parts.items() if not text}
    return Finding(
        sum(good.values()),
        joined([*missed, _earned(good)], " "),
        cause.help
        if cause is not None
        else msg(
            "A constant angular velocity with a slowly growing linear velocity makes a spiral."
        ),
        tuple(item for _, _, evidence in parts.values() for item in evidence),
    )


def _all_right(path: Path) -> Message:
    turns, _ = shape.turns(path)
    growth = shape.growth(path)
    sizes = msg(
        "{growth_min:.2f} to {growth_max:.2f} m", growth_min=growth.min(), growth_max=growth.max()
    )
    return msg(
        "{turns:.1f} turns from the centre, each wider by {sizes}.", turns=turns, sizes=sizes
    )


def _earned(good: Mapping[str, float]) -> Message:
    """Say what the parts that are right have earned."""
    if not good:
        return msg("It earned no points.")
    earned = [
        msg("{share:.0f} % {part}", share=100 * share, part=_FOR[name])
        for name, share in good.items()
    ]
    return msg("It earned {parts}.", parts=chained(earned))


_FOR = {
    "start": msg("for the start"),
    "turns": msg("for the turns"),
    "growth": msg("for the growth"),
}
#: The fault of a part, if any, and where to see it.
Part = tuple[Message, tuple[Evidence, ...]]


def _start(path: Path, tolerances: Tolerances) -> Part:
    start_m = float(path.distance[path.first])
    if start_m <= tolerances["start_m"]:
        return NOTHING, ()
    evidence = path.at(int(path.ticks[path.first]), msg("the start"))
    text = msg(
        "The path starts {start_m:.2f} m from the centre; {limit_m:g} m is fine.",
        start_m=start_m,
        limit_m=tolerances["start_m"],
    )
    return text, (evidence,)


def _turns(path: Path, tolerances: Tolerances) -> Part:
    turns, other_way = shape.turns(path)
    wanted = msg(
        "at least {turns:g} turns in one direction are asked for.", turns=tolerances["turns"]
    )
    if other_way > tolerances["wrong_way_share"]:
        return (
            msg(
                "It made {turns:.1f} turns, with {other_way:.0f} % of the turning the "
                "other way; {wanted}",
                turns=turns,
                other_way=100 * other_way,
                wanted=wanted,
            )
        ), ()
    if turns < tolerances["turns"]:
        return msg("It made {turns:.1f} turns; {wanted}", turns=turns, wanted=wanted), ()
    rounds = shape.loops(path).rounds
    if rounds < tolerances["turns"] - shape.BEHIND_TURNS:
        return (
            msg(
                "The turtle turned {turns:.1f} times, but its path goes only "
                "{rounds:.1f} times round any centre; at least {wanted:g} times are "
                "asked for.",
                turns=turns,
                rounds=rounds,
                wanted=tolerances["turns"],
            )
        ), ()
    return NOTHING, ()


def _growth(path: Path, tolerances: Tolerances) -> Part:
    growth = shape.growth(path)
    if not len(growth):
        return msg("With fewer than two turns nobody can tell whether they grow."), ()
    if growth.min() < tolerances["growth_m"]:
        least = round(float(growth.min()), 2)
        changed = (
            msg("it changed by {least:+.2f} m", least=least) if least else msg("it stayed the same")
        )
        return (
            msg(
                "Its mean distance from the centre must grow with each turn; from one "
                "turn to the next {changed}.",
                changed=changed,
            )
        ), ()
    loops = shape.loops(path)
    goes_round = loops.rounds >= tolerances["turns"] - shape.BEHIND_TURNS
    if not goes_round or loops.outside < shape.MOSTLY:
        return msg("Going round, its path does not stay outside of what it has drawn before."), ()
    if loops.straight_out > shape.HALFWAY:
        return (
            msg(
                "It grows by driving straight outwards from one circle to the next; a "
                "spiral grows while it goes round."
            )
        ), ()
    if loops.farthest_m > tolerances["gentle_m"]:
        return msg(
            "It came away from its last turn by {farthest_m:.2f} m.", farthest_m=loops.farthest_m
        ), ()
    if growth.max() > tolerances["gentle_m"]:
        return msg(
            "Its distance from the centre jumped by {growth_max:.2f} m in one turn.",
            growth_max=growth.max(),
        ), ()
    return NOTHING, ()
