"""Judges whether each quadrant gets a colour of its own, in all runs."""

from __future__ import annotations

from grader.exercise.check import Tolerances
from grader.exercise.verdict import Evidence, Finding
from grader.exercises.turtlesim_challenge import colours, mistakes, pens
from grader.exercises.turtlesim_challenge.edge import in_run
from grader.exercises.turtlesim_challenge.path import NAMES, QUADRANTS, ROMAN, Path, Visit
from grader.recording.recording import Recordings
from grader.text.message import Message, joined, msg
from turtlesim_py.world.events import SetPen
from turtlesim_py.world.turtle import TICK_S

#: With this share or less the run from the centre shows by itself what is wrong.
SHOWS_IT_TOO = 0.9
#: So many entries are shown.
SHOWN = 5


def judge_pens(recordings: Recordings, tolerances: Tolerances) -> Finding:
    """Return the worst of the runs that are conclusive."""
    path = Path(recordings.nominal)
    if not path.calls(SetPen):
        return Finding(
            0,
            msg("The pen was never changed."),
            msg("Call the service /turtle1/set_pen when the turtle enters another quadrant."),
        )
    nominal = pens.coloring(path, tolerances, QUADRANTS)
    paths = [path, *(Path(run, number) for number, run in enumerate(recordings.varied, start=1))]
    colorings = [nominal, *(_elsewhere(path, tolerances, nominal) for path in paths[1:])]
    conclusive = [n for n, coloring in enumerate(colorings) if coloring.is_conclusive or n == 0]
    worst = min(conclusive, key=lambda n: colorings[n].share)
    share = colorings[worst].share
    if share >= 1:
        entered = len(path.entries(tolerances["band_m"]))
        return Finding(1, _all_right(len(nominal.judged), entered, len(recordings.varied)))
    blind = next(
        (
            n
            for n in range(1, len(paths))
            if pens.go_by_commands(paths[n], colorings[n], tolerances)
        ),
        0,
    )
    if blind and nominal.right > SHOWS_IT_TOO:
        text = msg(
            "{run!u} the colours change where the turtle would be if it obeyed your commands "
            "exactly, not where it is: they do not come from the pose.",
            run=in_run(paths[blind]),
        )
        evidence = _evidence(paths[blind], colorings[blind], tolerances)
        return Finding(0, text, _READ_THE_POSE, evidence)
    # What the run from the centre shows as well is reported for that one.
    shown = 0 if nominal.share <= SHOWS_IT_TOO else worst
    found, path = colorings[shown], paths[shown]
    sentences, help_ = _explain(path, found, tolerances)
    if shown:
        sentences[0] = msg("{run!u}: {seen}", run=in_run(path), seen=sentences[0])
    if blind or (not share and colorings[worst].right):
        share = 0
        sentences.append(msg("Chance alone would do as well: no points."))
    else:
        sentences += _points(colorings[worst], worst)
    return Finding(share, joined(sentences, " "), help_, _evidence(path, found, tolerances))


def _all_right(right: int, entered: int, varied: int) -> Message:
    elsewhere = msg(
        ", and in the varied run too",
        ", and in the {n} varied runs too",
        n=varied,
    )
    return msg(
        "All {entries} gave the pen its quadrant's colour{short}{elsewhere}.",
        entries=_entries(right),
        short="" if right == entered else msg(" (short stays not counted)"),
        elsewhere=elsewhere if varied else "",
    )


def _entries(number: int) -> Message:
    return msg("{n} entry", "{n} entries", n=number)


def _elsewhere(path: Path, tolerances: Tolerances, nominal: pens.Coloring) -> pens.Coloring:
    """Judge the colours of a run from elsewhere, which may have too few entries to show them."""
    by_itself = pens.coloring(path, tolerances)
    if by_itself.different == len(by_itself.by_quadrant) and by_itself.share:
        return by_itself
    as_before = pens.coloring(path, tolerances, known=nominal.by_quadrant)
    return max(by_itself, as_before, key=lambda coloring: coloring.share)


def _explain(
    path: Path, found: pens.Coloring, tolerances: Tolerances
) -> tuple[list[Message], Message]:
    """Return what was found, the cause first, and what to do."""
    if not found.judged:
        seen = msg("The turtle left no quadrant in which there was time to change the colour.")
        return [seen], mistakes.SPIRAL_FIRST
    causes = list(mistakes.causes(path, found, tolerances))
    sentences = [cause.text for cause in causes]
    help_ = causes[0].help if causes else _LOOK_THERE if found.bad else mistakes.SPIRAL_FIRST
    if found.bad:
        right, of = len(found.judged) - len(found.bad), len(found.judged)
        sentences.append(
            msg(
                "{right} of {entries} into a quadrant gave the pen that quadrant's colour in time.",
                right=right,
                entries=_entries(of),
            )
        )
    sentences += _demanded(found, tolerances)
    if found.wanted > len(found.by_quadrant):
        sentences.append(
            msg(
                "Of the four quadrants {n} was entered for long enough.",
                "Of the four quadrants {n} were entered for long enough.",
                n=len(found.by_quadrant),
            )
        )
    if not found.is_conclusive:
        sentences.append(msg("One quadrant alone tells nothing."))
    return sentences, help_


_READ_THE_POSE = msg(
    "Find the quarter anew from pose.x and pose.y in each pose callback, and call set_pen when it "
    "has changed."
)
_LOOK_THERE = msg(
    "Look at the first moment that is named: in which quadrant is the turtle, and which colour "
    "does your node ask for?"
)


def _points(found: pens.Coloring, run: int) -> list[Message]:
    """Say how the points are computed, where there are some."""
    if not 0 < found.share < 1:
        return []
    right, of = len(found.judged) - len(found.bad), len(found.judged)
    wanted = max(found.wanted, len(found.by_quadrant))
    values = {"right": right, "of": of, "different": found.different, "wanted": wanted}
    if run:
        return [
            msg(
                "Points in run {run}: {right}/{of} (entries) times {different}/{wanted} (colours).",
                run=run,
                **values,
            )
        ]
    return [msg("Points: {right}/{of} (entries) times {different}/{wanted} (colours).", **values)]


def _demanded(found: pens.Coloring, tolerances: Tolerances) -> list[Message]:
    asked = pens.demanded(tolerances)
    return [
        msg(
            "Quadrant {quadrant} is to be {color}.",
            quadrant=ROMAN[quadrant],
            color=colours.name(asked[quadrant]),
        )
        for quadrant in sorted({entry.quadrant for entry in found.bad} & asked.keys())
    ]


def _evidence(path: Path, found: pens.Coloring, tolerances: Tolerances) -> tuple[Evidence, ...]:
    shown = found.bad
    if not shown:  # all in time, and some colours are the same: one entry into each of these
        doubtful = {q for group in found.alike if len(group) > 1 for q in group}
        last = {e.quadrant: e for e in found.judged if e.quadrant in doubtful}
        shown = sorted(last.values(), key=lambda entry: entry.tick)
    return tuple(path.at(e.tick, _note(e, found, tolerances)) for e in shown[:SHOWN])


def _note(entry: Visit, found: pens.Coloring, tolerances: Tolerances) -> Message:
    entered = {"quadrant": NAMES[entry.quadrant]}
    wanted = found.by_quadrant[entry.quadrant]
    before = colours.name(found.colors[entry.settled(found.waits[entry])])
    if entry not in found.bad:
        return msg("enters quadrant {quadrant}, in {color}", color=before, **entered)
    if wanted is None:
        return msg("enters quadrant {quadrant} with the pen off", **entered)
    color = colours.name(wanted)
    delay = pens.came_after(entry, found, tolerances["color_distance"])
    if delay is None:
        return msg(
            "enters quadrant {quadrant}, and draws in {before} there, not in {color}",
            before=before,
            color=color,
            **entered,
        )
    if delay <= found.waits[entry]:
        return msg(
            "enters quadrant {quadrant}; its colour, {color}, does not stay", color=color, **entered
        )
    return msg(
        "enters quadrant {quadrant}; {color} comes {late_s:.2f} s later, until then {before}",
        color=color,
        late_s=delay * TICK_S,
        before=before,
        **entered,
    )
