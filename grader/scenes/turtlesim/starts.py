"""Where varied runs start: somewhere round the centre of the window."""

from __future__ import annotations

import math
import random

from grader.scenes.scene import Start
from turtlesim_py.world.turtle import SIZE_M

#: From the centre to half a metre before a wall [m]; rounded, because authors read it.
FARTHEST_M = round(SIZE_M / 2 - 0.5, 2)


def starts(count: int, seed: int, nearest_m: float, farthest_m: float) -> list[Start]:
    """Places at a distance from the centre; the same for the same seed."""
    chance = random.Random(seed)
    found = []
    for _ in range(count):
        distance = chance.uniform(nearest_m, farthest_m)
        angle = chance.uniform(-math.pi, math.pi)
        x, y = (SIZE_M / 2 + distance * f(angle) for f in (math.cos, math.sin))
        theta = chance.uniform(-math.pi, math.pi)
        found.append(Start(round(x, 3), round(y, 3), round(theta, 3)))
    return found
