"""Finds causes of wrong colours: a dividing line elsewhere, the quadrant before, a slow timer."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from grader.exercise.check import Tolerances
from grader.exercises.turtlesim_challenge import colours
from grader.exercises.turtlesim_challenge.commands import Cause
from grader.exercises.turtlesim_challenge.path import CENTRE_M, QUADRANTS, ROMAN, Path
from grader.exercises.turtlesim_challenge.pens import Coloring, came_after
from grader.text.message import Message, chained, joined, msg, series
from turtlesim_py.world.events import SetPen
from turtlesim_py.world.trajectory import Floats
from turtlesim_py.world.turtle import TICK_S

#: A call this far from both dividing lines was made by something else [m].
OFF_THE_LINES_M = 0.3
#: Calls for one line lie this near to it [m]: a turtle drives so far in a step or two.
ON_ONE_LINE_M = 0.12
#: So many calls are needed to see a line, and this part of them, or of a pattern, has to fit.
LEAST_CALLS, MOST = 3, 0.8
#: With the middle only a little elsewhere colours are not so early [ticks]; this part of the
#: changes is no accident.
EARLY_TICKS, EARLY = 6, 0.15
#: Delays that differ by more are no fixed delay: something is checked now and then [s].
NOW_AND_THEN_S = 0.35

WHERE = {
    1: msg("x > middle and y > middle"),
    2: msg("x < middle and y > middle"),
    3: msg("x < middle and y < middle"),
    4: msg("x > middle and y < middle"),
}
#: As a program would write it.
MIDDLE = f"{int(100 * CENTRE_M) / 100:g}"
SPIRAL_FIRST = msg(
    "Look at the spiral first: colours are judged in the quadrants that it goes through."
)


def causes(path: Path, found: Coloring, tolerances: Tolerances) -> Iterator[Cause]:
    """Yield causes of the wrong entries, the likeliest first."""
    once = _once(path, found)
    if once is not None:
        yield once
        return
    if None in found.by_quadrant.values():
        yield _lifted(found)
    elsewhere = found.bad and (
        _other_line(path)
        or _quadrant_before(path, found, tolerances)
        or _before_the_line(path, found, tolerances)
    )
    if elsewhere:  # it explains late colours and quadrants of one colour, too
        yield elsewhere
        return
    if len(found.alike) < len([color for color in found.by_quadrant.values() if color is not None]):
        yield alike(found.alike, found.by_quadrant)
    if found.bad:
        late = _late(found, tolerances)
        if late is not None:
            yield late


def alike(groups: list[list[int]], colors: dict[int, colours.Color | None]) -> Cause:
    """Quadrants with one colour: 'Quadrants II and IV are both red ...'."""
    same = [group for group in groups if len(group) > 1]
    text = joined([_of_one_colour(group, colors) for group in same], " ")
    if not all(len({colors[quadrant] for quadrant in group}) == 1 for group in same):
        help_ = msg(
            "Give each quadrant a colour of its own, one that an eye tells from the others."
        )
    elif max(map(len, same)) == QUADRANTS:
        help_ = msg(
            "Give each quadrant a colour of its own. If your node has four colours, look at its "
            "conditions: is each of them ever true? As for limits, the middle of the window is at "
            "{middle}.",
            middle=MIDDLE,
        )
    else:
        each = [
            msg("{quadrant} is {condition}", quadrant=ROMAN[q], condition=WHERE[q])
            for group in same
            for q in group
        ]
        conditions = joined(each, msg("; "))
        help_ = msg(
            "Give each quadrant a colour of its own. If your node has four colours, look at its "
            "conditions: {where}; the middle of the window is at {middle}.",
            where=conditions,
            middle=MIDDLE,
        )
    return Cause(text, help_)


def _of_one_colour(group: list[int], colors: dict[int, colours.Color | None]) -> Message:
    names = list(dict.fromkeys(colours.name(colors[quadrant]) for quadrant in group))
    quadrants = {"quadrants": series([ROMAN[q] for q in group])}
    if len(names) > 1:
        return msg(
            "Quadrants {quadrants} are {colours}: no eye tells them apart.",
            colours=series(names),
            **quadrants,
        )
    if len(group) == 2:
        return msg("Quadrants {quadrants} are both {color}.", color=names[0], **quadrants)
    return msg("Quadrants {quadrants} all are {color}.", color=names[0], **quadrants)


def _once(path: Path, found: Coloring) -> Cause | None:
    """set_pen was called a single time, whatever quadrants the turtle came to."""
    calls, entered = len(path.calls(SetPen)), len(path.entries(0.0))
    if calls != 1 or entered < LEAST_CALLS or len(found.by_quadrant) < 2:
        return None
    return Cause(
        msg(
            "set_pen was called once in the whole run; {entered} quadrants were entered.",
            entered=entered,
        ),
        msg(
            "Does your node ever see another quadrant? Its conditions have to compare x and y "
            "with {middle}, the middle. And if it does: what keeps it from calling once more?",
            middle=MIDDLE,
        ),
    )


def _before_the_line(path: Path, found: Coloring, tolerances: Tolerances) -> Cause | None:
    """The next quadrant's colour comes before the turtle does: nothing of x and y says so."""
    near, early = tolerances["color_distance"], []
    for entry, after in pairwise(path.entries(0.0)):
        if not {entry.quadrant, after.quadrant} <= found.by_quadrant.keys():
            continue
        here, there = found.by_quadrant[entry.quadrant], found.by_quadrant[after.quadrant]
        is_early = [
            colours.alike(found.colors[tick], there, near)
            for tick in entry.ticks
            if not colours.alike(here, there, near)
        ]
        # so many ticks at the end of the stay, but not the whole stay
        last = next((n for n, early in enumerate(reversed(is_early)) if not early), 0)
        early.append(last if last > EARLY_TICKS else 0)
    seen = [ticks for ticks in early if ticks]
    if len(seen) < LEAST_CALLS or len(seen) < EARLY * len(early):
        return None
    return Cause(
        msg(
            "The colour changes elsewhere than at x = {middle} or y = {middle}: about "
            "{early_s:.2f} s before the turtle is there.",
            middle=MIDDLE,
            early_s=float(np.median(seen)) * TICK_S,
        ),
        msg(
            "Is it theta, or the time, by which your node tells the quadrants? Compare x and y of "
            "the pose with {middle}.",
            middle=MIDDLE,
        ),
    )


def _lifted(found: Coloring) -> Cause:
    lifted = [ROMAN[q] for q, color in sorted(found.by_quadrant.items()) if color is None]
    text = msg(
        "The pen is off in quadrant {quadrants}: it draws nothing there.", quadrants=series(lifted)
    )
    if len(lifted) == len(found.by_quadrant):
        text = msg("The pen is off everywhere: it draws nothing there.")
    return Cause(text, msg("What do your requests say of `off`? 0 is a pen that draws."))


def _other_line(path: Path) -> Cause | None:
    """Calls that come where x or y has one value, and that is not the middle."""
    x, y = _where_the_colour_changes(path)
    off = np.minimum(np.abs(x - CENTRE_M), np.abs(y - CENTRE_M)) > OFF_THE_LINES_M
    if off.sum() < LEAST_CALLS:
        return None
    explained = np.zeros(int(off.sum()), dtype=bool)
    lines = []
    for name, values in (("x", x[off]), ("y", y[off])):
        near = np.abs(values[:, None] - values[None, :]) <= ON_ONE_LINE_M
        best = near[int(np.argmax(near.sum(axis=1)))]
        if best.sum() >= LEAST_CALLS:
            lines.append(f"{name} = {float(np.median(values[best])):.1f}")
            explained |= best
    if not lines or explained.mean() < MOST:
        return None
    return Cause(
        msg(
            "The colour changes at {lines}; the middle of the window is at {middle}.",
            lines=chained(lines),
            middle=MIDDLE,
        ),
        msg("Which limits does your node compare x and y of the pose with?"),
    )


def _where_the_colour_changes(path: Path) -> tuple[Floats, Floats]:
    calls = path.calls(SetPen)
    # the first one gives the turtle the colour of where it starts
    changes = [b for a, b in pairwise(calls) if (a.r, a.g, a.b, a.off) != (b.r, b.g, b.b, b.off)]
    rows = np.searchsorted(path.ticks, [call.tick for call in changes]).clip(0, len(path) - 1)
    return path.x[rows], path.y[rows]


def _quadrant_before(path: Path, found: Coloring, tolerances: Tolerances) -> Cause | None:
    """The colour fits the quadrant that the turtle came from, each time."""
    by_before: dict[int, Counter[colours.Color | None]] = {}
    by_itself: dict[int, Counter[colours.Color | None]] = {}
    judged = set(found.judged)
    for before, entry in pairwise(path.entries(tolerances["band_m"])):
        if entry in judged:
            # at the end of the stay: a colour that is only late is there by then
            color = found.colors[entry.last_tick]
            by_before.setdefault(before.quadrant, Counter())[color] += 1
            by_itself.setdefault(entry.quadrant, Counter())[color] += 1
    total = sum(count.total() for count in by_before.values())
    fits_before, fits_itself = (
        sum(count.most_common(1)[0][1] for count in shown.values())
        for shown in (by_before, by_itself)
    )
    # On a way round one side each quadrant is entered from one other only: then both fit.
    if total < LEAST_CALLS or fits_before < 0.95 * total or fits_itself >= fits_before:
        return None
    return Cause(
        msg(
            "The pen has the colour of the quadrant that the turtle came from, not of the one "
            "that it came into."
        ),
        msg(
            "Of the two quadrants that your node compares, the one before and the new one: for "
            "which does it ask the colour?"
        ),
    )


def _late(found: Coloring, tolerances: Tolerances) -> Cause | None:
    """The colours come too late, by a fixed delay or by a varying one."""
    near = tolerances["color_distance"]
    delays = {entry: came_after(entry, found, near) for entry in found.judged}
    late = [d for e in found.bad if (d := delays[e]) is not None and d > found.waits[e]]
    if not late:
        return None
    typical = float(np.median(late)) * TICK_S
    allowed = float(np.median([found.waits[entry] for entry in found.bad])) * TICK_S
    came = [delay * TICK_S for delay in delays.values() if delay is not None]
    low, high = np.percentile(came, [10, 90])
    if high - low <= NOW_AND_THEN_S:
        return Cause(
            msg(
                "The colour comes {late_s:.2f} s after the turtle; {allowed_s:.2f} s are allowed.",
                late_s=typical,
                allowed_s=allowed,
            ),
            msg("Call set_pen in the pose callback, at once: what does your node wait for?"),
        )
    return Cause(
        msg(
            "The colour comes now and then only, {low_s:.2f} to {high_s:.2f} s after the turtle; "
            "{allowed_s:.2f} s are allowed.",
            low_s=low,
            high_s=max(float(high), typical),  # what came too late is shown in any case
            allowed_s=allowed,
        ),
        msg("Look at the quadrant in the pose callback, not in a slow timer."),
    )
