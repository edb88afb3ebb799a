"""Whether each quadrant gets a colour of its own, in all runs."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from grader.exercise.check import Tolerances
from grader.exercise.verdict import Evidence, Finding
from grader.exercises.turtlesim_challenge import colours, pens
from grader.exercises.turtlesim_challenge.edge import in_varied_runs_too
from grader.exercises.turtlesim_challenge.path import NAMES, QUADRANTS, ROMAN, Entry, Path
from grader.exercises.turtlesim_challenge.stops import judge_start
from grader.recording.recording import Recordings
from turtlesim_py.world.events import SetPen
from turtlesim_py.world.turtle import TICK_S

#: So many entries are shown.
SHOWN = 5


def judge_pens(recordings: Recordings, tolerances: Tolerances) -> Finding:
    """The worst of the runs that tell anything."""
    path = Path(recordings.nominal)
    if not path.calls(SetPen):
        return Finding(
            0,
            "The pen was never changed.",
            "Call the service /turtle1/set_pen when the turtle enters another quadrant.",
        )
    nominal = pens.coloring(path, tolerances, QUADRANTS)
    paths = [path, *(Path(run, number) for number, run in enumerate(recordings.varied, start=1))]
    colorings = [nominal, *(_elsewhere(path, tolerances, nominal) for path in paths[1:])]
    away = first_moved_away(recordings)
    if away is not None and nominal.share > 0:
        return away
    telling = [n for n, coloring in enumerate(colorings) if coloring.tells or n == 0]
    worst = min(telling, key=lambda n: colorings[n].share)
    found, path = colorings[worst], paths[worst]
    if found.share >= 1:
        entries = len(nominal.judged)
        rationale = f"All {entries} entries gave the pen its quadrant's colour"
        return Finding(1, f"{rationale}{in_varied_runs_too(recordings)}.")
    sentences = _seen(found, tolerances)
    if worst:
        sentences[0] = f"When the turtle started elsewhere (run {worst}): {sentences[0]}"
    return Finding(
        found.share, " ".join(sentences), _help(found), _evidence(path, found, tolerances)
    )


def _elsewhere(path: Path, tolerances: Tolerances, nominal: pens.Coloring) -> pens.Coloring:
    """A run from elsewhere: a quadrant that was entered once or twice may tell no colour itself."""
    by_itself = pens.coloring(path, tolerances)
    if by_itself.different == len(by_itself.own):
        return by_itself
    as_before = pens.coloring(path, tolerances, known=nominal.own)
    return max(by_itself, as_before, key=lambda coloring: coloring.share)


def first_moved_away(recordings: Recordings) -> Finding | None:
    """Of the runs that start elsewhere, the first in which the turtle was brought away."""
    for number, recording in enumerate(recordings.varied, start=1):
        void = judge_start(Path(recording, number))
        if void is not None:
            told = f"The turtle started elsewhere (run {number}). {void.rationale}"
            return replace(void, rationale=told)
    return None


def told_alike(groups: list[list[int]], own: dict[int, colours.Color | None]) -> list[str]:
    """Sentences about quadrants with one colour: 'Quadrants II and IV are both red ...'."""
    return [
        f"Quadrants {_and([ROMAN[q] for q in group])} "
        f"{'are both' if len(group) == 2 else 'all are'} {colours.name(own[group[0]])}."
        for group in groups
        if len(group) > 1
    ]


def _seen(found: pens.Coloring, tolerances: Tolerances) -> list[str]:
    if not found.judged:
        return ["The turtle left no quadrant in which there was time to change the colour."]
    right, of = len(found.judged) - len(found.bad), len(found.judged)
    sentences = [
        f"{right} of {of} entries into a quadrant gave the pen that quadrant's colour in time."
    ]
    lifted = [ROMAN[q] for q, color in sorted(found.own.items()) if color is None]
    if lifted:
        where = "everywhere" if len(lifted) == len(found.own) else f"in quadrant {_and(lifted)}"
        sentences.append(f"The pen is off {where}: it draws nothing there.")
    sentences += told_alike(found.alike, found.own)
    sentences += _told_late(found, tolerances)
    sentences += _told_demanded(found, tolerances)
    if found.wanted > len(found.own):
        sentences.append(f"Of the four quadrants {len(found.own)} were entered for long enough.")
    if 0 < found.share < 1:
        wanted = max(found.wanted, len(found.own))
        sentences.append(
            f"Of the points that is {right}/{of} for the entries times {found.different}/{wanted} "
            "for colours that differ."
        )
    elif not found.tells:
        sentences.append("One quadrant alone tells nothing.")
    return sentences


def _told_late(found: pens.Coloring, tolerances: Tolerances) -> list[str]:
    """How late the colours are that come at all."""
    delays = [pens.came_after(entry, found, tolerances["color_distance"]) for entry in found.bad]
    late = [delay for delay in delays if delay]
    if not late:
        return []
    typical = float(np.median(late)) * TICK_S
    allowed = float(np.median([found.waits[entry] for entry in found.bad])) * TICK_S
    return [f"The colour comes {typical:.2f} s after the turtle; {allowed:.2f} s are allowed."]


def _told_demanded(found: pens.Coloring, tolerances: Tolerances) -> list[str]:
    asked = pens.demanded(tolerances)
    return [
        f"Quadrant {ROMAN[quadrant]} is to be {colours.name(asked[quadrant])}."
        for quadrant in sorted({entry.quadrant for entry in found.bad} & asked.keys())
    ]


def _help(found: pens.Coloring) -> str:
    if None in found.own.values():
        return "What do your requests say of `off`? 0 is a pen that draws."
    if found.judged and not found.bad and len(found.alike) < len(found.own):
        return "Give each quadrant a colour of its own, one that an eye tells from the others."
    return "Compare the quadrant of each pose with the one before. Which is where?"


def _evidence(path: Path, found: pens.Coloring, tolerances: Tolerances) -> tuple[Evidence, ...]:
    shown = found.bad
    if not shown:  # all in time, and some colours are the same: one entry into each of these
        doubtful = {q for group in found.alike if len(group) > 1 for q in group}
        last = {e.quadrant: e for e in found.judged if e.quadrant in doubtful}
        shown = sorted(last.values(), key=lambda entry: entry.tick)
    return tuple(path.at(e.tick, _note(e, found, tolerances)) for e in shown[:SHOWN])


def _note(entry: Entry, found: pens.Coloring, tolerances: Tolerances) -> str:
    enters = f"enters quadrant {NAMES[entry.quadrant]}"
    own = found.own[entry.quadrant]
    before = colours.name(found.colors[entry.settled(found.waits[entry])])
    if entry not in found.bad:
        return f"{enters}, in {before}"
    if own is None:
        return f"{enters} with the pen off"
    delay = pens.came_after(entry, found, tolerances["color_distance"])
    if delay is None:
        return f"{enters}, and draws in {before} there, not in {colours.name(own)}"
    if delay <= found.waits[entry]:
        return f"{enters}; its colour, {colours.name(own)}, does not stay"
    return f"{enters}; {colours.name(own)} comes {delay * TICK_S:.2f} s later, until then {before}"


def _and(words: list[str]) -> str:
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} and {words[-1]}"
