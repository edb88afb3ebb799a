"""Whether the path is the spiral that was asked for, and what part of it is."""

from __future__ import annotations

from grader.exercise.check import Tolerances
from grader.exercise.verdict import Evidence, Finding
from grader.exercises.turtlesim_challenge import shape
from grader.exercises.turtlesim_challenge.commands import why_no_wider, why_so_few_turns
from grader.exercises.turtlesim_challenge.path import Path


def judge_spiral(path: Path, tolerances: Tolerances) -> Finding:
    """Its start, its turns and its growth earn points each."""
    parts = {
        "start": (tolerances["share_start"], *_start(path, tolerances)),
        "turns": (tolerances["share_turns"], *_turns(path, tolerances)),
    }
    rest = 1 - tolerances["share_start"] - tolerances["share_turns"]
    parts["growth"] = (rest, *_growth(path, tolerances))
    missed = [text for _, text, _ in parts.values() if text]
    if not missed:
        turns, _ = shape.turns(path)
        growth = shape.growth(path)
        sizes = f"{growth.min():.2f} to {growth.max():.2f} m"
        return Finding(1, f"{turns:.1f} turns from the centre, each wider by {sizes}.")
    cause = None
    if parts["growth"][1]:
        few = shape.turns(path)[0] < tolerances["turns"]
        cause = why_so_few_turns(path) if few else why_no_wider(path)
    if cause is not None:
        missed.insert(0, cause.text)
    good = {name: share for name, (share, text, _) in parts.items() if not text}
    earned = [f"{100 * share:.0f} % for the {name}" for name, share in good.items()]
    told = " and ".join(earned) if earned else "nothing"
    return Finding(
        sum(good.values()),
        f"{' '.join(missed)} Of the points it earned {told}.",
        cause.help
        if cause is not None
        else "A constant angular velocity with a slowly growing linear velocity makes a spiral.",
        tuple(item for _, _, evidence in parts.values() for item in evidence),
    )


#: What is wrong with a part, '' for nothing, and where to see it.
Part = tuple[str, tuple[Evidence, ...]]


def _start(path: Path, tolerances: Tolerances) -> Part:
    start_m = float(path.distance[path.first])
    if start_m <= tolerances["start_m"]:
        return "", ()
    evidence = path.at(int(path.ticks[path.first]), "the start")
    text = f"The path starts {start_m:.2f} m from the centre; {tolerances['start_m']:g} m is fine."
    return text, (evidence,)


def _turns(path: Path, tolerances: Tolerances) -> Part:
    turns, other_way = shape.turns(path)
    wanted = f"at least {tolerances['turns']:g} turns in one direction are asked for."
    if other_way > tolerances["wrong_way_share"]:
        return (
            f"It made {turns:.1f} turns, with {100 * other_way:.0f} % of the turning the other "
            f"way; {wanted}"
        ), ()
    if turns < tolerances["turns"]:
        return f"It made {turns:.1f} turns; {wanted}", ()
    rounds = shape.loops(path).rounds
    if rounds < tolerances["turns"] - shape.BEHIND_TURNS:
        return (
            f"The turtle turned {turns:.1f} times, but its path goes only {rounds:.1f} times "
            f"round any centre; at least {tolerances['turns']:g} times are asked for."
        ), ()
    return "", ()


def _growth(path: Path, tolerances: Tolerances) -> Part:
    growth = shape.growth(path)
    if not len(growth):
        return "With fewer than two turns nobody can tell whether they grow.", ()
    if growth.min() < tolerances["growth_m"]:
        least = round(float(growth.min()), 2)
        changed = f"it changed by {least:+.2f} m" if least else "it stayed the same"
        return (
            "Its mean distance from the centre must grow with each turn; from one turn to the "
            f"next {changed}."
        ), ()
    loops = shape.loops(path)
    goes_round = loops.rounds >= tolerances["turns"] - shape.BEHIND_TURNS
    if not goes_round or loops.outside < shape.MOSTLY:
        return "Going round, its path does not stay outside of what it has drawn before.", ()
    if loops.straight_out > shape.HALFWAY:
        return (
            "It grows by driving straight outwards from one circle to the next; a spiral grows "
            "while it goes round."
        ), ()
    if loops.farthest_m > tolerances["gentle_m"]:
        return f"It came away from its last turn by {loops.farthest_m:.2f} m.", ()
    if growth.max() > tolerances["gentle_m"]:
        return f"Its distance from the centre jumped by {growth.max():.2f} m in one turn.", ()
    return "", ()
