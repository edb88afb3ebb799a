"""Whether each quadrant gets a colour of its own, in all runs."""

from __future__ import annotations

from dataclasses import replace

from grader.exercise.check import Tolerances
from grader.exercise.sentences import counted
from grader.exercise.verdict import Evidence, Finding
from grader.exercises.turtlesim_challenge import colours, mistakes, pens
from grader.exercises.turtlesim_challenge.edge import in_varied_runs_too
from grader.exercises.turtlesim_challenge.path import NAMES, QUADRANTS, ROMAN, Entry, Path
from grader.exercises.turtlesim_challenge.stops import judge_start
from grader.recording.recording import Recordings
from turtlesim_py.world.events import SetPen
from turtlesim_py.world.turtle import TICK_S

#: With this share or less the run from the centre shows by itself what is wrong.
SHOWS_IT_TOO = 0.9
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
    share = colorings[worst].share
    if share >= 1:
        return Finding(
            1, _all_right(path, nominal, tolerances) + in_varied_runs_too(recordings) + "."
        )
    # What the run from the centre shows as well is told of that one.
    shown = 0 if nominal.share <= SHOWS_IT_TOO else worst
    found, path = colorings[shown], paths[shown]
    sentences, help_ = _told(path, found, tolerances)
    if shown:
        sentences[0] = f"When the turtle started elsewhere (run {worst}): {sentences[0]}"
    sentences += _points(colorings[worst], worst)
    return Finding(share, " ".join(sentences), help_, _evidence(path, found, tolerances))


def _all_right(path: Path, nominal: pens.Coloring, tolerances: Tolerances) -> str:
    right, entered = len(nominal.judged), len(path.entries(tolerances["band_m"]))
    short = "" if right == entered else " (short stays not counted)"
    return f"All {counted(right, 'entry', 'entries')} gave the pen its quadrant's colour{short}"


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


def _told(path: Path, found: pens.Coloring, tolerances: Tolerances) -> tuple[list[str], str]:
    """What was seen, the cause first, and what to do."""
    if not found.judged:
        seen = "The turtle left no quadrant in which there was time to change the colour."
        return [seen], mistakes.SPIRAL_FIRST
    causes = list(mistakes.causes(path, found, tolerances))
    sentences = [cause.text for cause in causes]
    help_ = causes[0].help if causes else _LOOK_THERE if found.bad else mistakes.SPIRAL_FIRST
    if found.bad:
        right, of = len(found.judged) - len(found.bad), len(found.judged)
        sentences.append(
            f"{right} of {counted(of, 'entry', 'entries')} into a quadrant gave the pen that "
            "quadrant's colour in time."
        )
    sentences += _told_demanded(found, tolerances)
    if found.wanted > len(found.own):
        entered = len(found.own)
        were = "was" if entered == 1 else "were"
        sentences.append(f"Of the four quadrants {entered} {were} entered for long enough.")
    if not found.tells:
        sentences.append("One quadrant alone tells nothing.")
    return sentences, help_


_LOOK_THERE = (
    "Look at the first moment that is named: in which quadrant is the turtle, and which colour "
    "does your node ask for?"
)


def _points(found: pens.Coloring, run: int) -> list[str]:
    """How the points come about, where there are some."""
    if not 0 < found.share < 1:
        return []
    right, of = len(found.judged) - len(found.bad), len(found.judged)
    wanted = max(found.wanted, len(found.own))
    where = f" in run {run}" if run else ""
    return [f"Points{where}: {right}/{of} (entries) times {found.different}/{wanted} (colours)."]


def _told_demanded(found: pens.Coloring, tolerances: Tolerances) -> list[str]:
    asked = pens.demanded(tolerances)
    return [
        f"Quadrant {ROMAN[quadrant]} is to be {colours.name(asked[quadrant])}."
        for quadrant in sorted({entry.quadrant for entry in found.bad} & asked.keys())
    ]


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
