"""Whether the picture shows four quarters in four colours."""

from __future__ import annotations

from grader.exercise.check import Tolerances
from grader.exercise.verdict import Finding
from grader.exercises.turtlesim_challenge import colours, ink, mistakes, pens, shape
from grader.exercises.turtlesim_challenge.path import NAMES, QUADRANTS, ROMAN, Path
from grader.language.phrase import joined, say
from grader.recording.recording import Recording
from grader.scenes.turtlesim.trace import TurtleTrace
from turtlesim_py.world.events import SetPen


def judge_picture(recording: Recording, tolerances: Tolerances) -> Finding:
    """Ink in all quarters, each mainly in one colour, and these colours differ."""
    background, near = ink.background(recording), tolerances["color_distance"]
    quarters = ink.quarters(ink.own_drawing(recording), background, near)
    empty = [NAMES[q] for q, quarter in quarters.items() if quarter.pixels < ink.LEAST_PIXELS]
    if empty:
        return Finding(
            0,
            say(
                "There is next to nothing drawn in quadrant {quadrants}.",
                quadrants=joined(empty, ", "),
            ),
            _how_to_draw(recording, near),
        )
    mixed = _mixed(quarters, tolerances)
    if mixed:
        # A colour may come as late as pen_per_quadrant allows: what was drawn until then is no mix.
        settled = ink.settled_drawing(recording, _pauses(recording, tolerances))
        for quadrant, quarter in ink.quarters(settled, background, near).items():
            if quarter.pixels >= ink.LEAST_PIXELS:
                quarters[quadrant] = quarter
        mixed = _mixed(quarters, tolerances)
    if mixed:
        shares = ", ".join(f"{ROMAN[q]} {int(100 * quarters[q].share)} %" for q in mixed)
        return Finding(
            0,
            say(
                "Some quarters mix colours. The main colour should cover {own_ink:g} % or more of "
                "what is drawn there; it covers only: {shares}.",
                own_ink=100 * tolerances["own_ink"],
                shares=shares,
            ),
            say("The colour should change where the turtle enters a quadrant."),
        )
    own = {quadrant: quarter.color for quadrant, quarter in quarters.items()}
    groups = colours.groups(own, near)
    if len(groups) < QUADRANTS:
        cause = mistakes.alike(groups, own)
        hardly_driven = not shape.shown(Path(recording), tolerances)
        return Finding(0, cause.text, mistakes.SPIRAL_FIRST if hardly_driven else cause.help)
    total = sum(quarter.pixels for quarter in quarters.values())
    return Finding(1, say("Four quarters, four colours, {total} painted pixels.", total=total))


def _mixed(quarters: dict[int, ink.Quarter], tolerances: Tolerances) -> list[int]:
    return [q for q, quarter in quarters.items() if quarter.share < tolerances["own_ink"]]


def _pauses(recording: Recording, tolerances: Tolerances) -> list[tuple[int, int]]:
    """From and to which ticks the colour may still be that of the quadrant before."""
    path = Path(recording)
    entries = path.entries(tolerances["band_m"])
    waits = pens.coloring(path, tolerances).waits
    before = [0, *(entry.last_tick + 1 for entry in entries[:-1])]
    return [
        (first, entry.tick + waits[entry])
        for first, entry in zip(before, entries, strict=True)
        if entry in waits
    ]


def _how_to_draw(recording: Recording, near: float) -> str:
    calls = TurtleTrace.of(recording.trace).of_kind(SetPen)
    if any(call.off for call in calls):
        return say(
            "The pen is off: look at what your requests say of `off`; 0 is a pen that draws."
        )
    background = ink.background(recording)
    if any(colours.alike((call.r, call.g, call.b), background, near) for call in calls):
        return say("What is drawn in the colour of the background cannot be seen.")
    return say("Draw on until the spiral fills the window.")
