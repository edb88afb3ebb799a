"""The check of the listener that its turtle's scene answers."""

from __future__ import annotations

import math

from grader.exercise.check import Checks, Tolerances
from grader.exercise.verdict import Finding
from grader.recording.recording import Recordings
from grader.scenes.turtlesim.trace import TurtleTrace
from grader.text.message import chained, msg
from turtlesim_py.world.events import Spawn

checks = Checks()
NAME, PLACE = "turtle2", (4.0, 2.0)


@checks(parrot="the task names the place")
def spawns(recordings: Recordings, tolerances: Tolerances) -> Finding:
    """It spawns turtle2 at (4, 2).

    Within {place_m} m of it.
    """
    asked = TurtleTrace.of(recordings.nominal.trace).of_kind(Spawn)
    if not asked:
        help_ = msg("Call the service spawn, turtlesim/srv/Spawn, once it is there.")
        return Finding(0, msg("Nobody asked for another turtle."), help_)
    for each in asked:
        if each.name == NAME and math.dist((each.x, each.y), PLACE) <= tolerances["place_m"]:
            return Finding(1, msg("turtle2 came at (4, 2)."))
    shown = [f"{each.name or '?'} ({each.x:.2f}, {each.y:.2f})" for each in asked[:5]]
    text = msg("It asked for {turtles}, expected turtle2 (4.00, 2.00).", turtles=chained(shown))
    return Finding(0, text, msg("Look at what is in the request: name, x, y."))
