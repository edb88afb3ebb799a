"""Colours, places and calls in words, for those who do not see them."""

import math

import numpy as np
import pytest

from grader.scenes.turtlesim import words
from turtlesim_py.world.events import (
    Clear,
    Kill,
    RotateAbsolute,
    SetParameter,
    SetPen,
    Spawn,
    TeleportAbsolute,
    TeleportRelative,
)

BLUE_GROUND = "#4556ff"


COLOURS = {
    "red": [(255, 0, 0), (255, 0, 40)],
    **{"orange": [(255, 165, 0)], "yellow": [(255, 255, 0)], "dark green": [(0, 128, 0)]},
    **{"cyan": [(0, 255, 255)], "blue": [(0, 0, 255)], "light blue": [(179, 184, 255)]},
    **{"purple": [(160, 32, 240)], "magenta": [(255, 0, 255)], "pink": [(255, 105, 180)]},
    **{"white": [(255, 255, 255)], "grey": [(128, 128, 128)], "black": [(0, 0, 0)]},
}


@pytest.mark.parametrize("name", COLOURS)
def test_a_colour_has_a_name_and_its_numbers(name):
    for rgb in COLOURS[name]:
        assert str(words.color(*rgb)) == f"{name} {rgb}"


def test_every_colour_has_a_name():
    steps = range(0, 256, 17)
    assert all(words.color(r, g, b) for r in steps for g in steps for b in steps)


def test_a_place_is_a_quarter_of_the_window():
    assert str(words.quarter(9, 9)) == "top right (quadrant I)"
    assert str(words.quarter(1, 9)) == "top left (quadrant II)"
    assert str(words.quarter(1, 1)) == "bottom left (quadrant III)"
    assert str(words.quarter(9, 1)) == "bottom right (quadrant IV)"
    assert not words.quarter(math.nan, 1)


@pytest.mark.parametrize(
    ("event", "said"),
    [
        (SetPen(tick=1, r=255, g=0, b=0, width=3, off=0), "red (255, 0, 0), 3 px"),
        (SetPen(tick=1, r=255, g=0, b=0, width=3, off=1), "the pen off"),
        (SetPen(tick=1, turtle="ada", r=0, g=0, b=0, width=1, off=0), "ada: black (0, 0, 0), 1 px"),
        (TeleportAbsolute(tick=1, x=1, y=2, theta=math.pi), "to (1.00, 2.00), heading 180°"),
        (TeleportRelative(tick=1, linear=1.5, angular=0), "a turn by 0°, then 1.5 m ahead"),
        (RotateAbsolute(tick=1, theta=math.pi / 2, id=0), "to heading 90°"),
        (Spawn(tick=1, x=1, y=2, theta=0, name=""), "a name of its choice, (1.00, 2.00)"),
        (Spawn(tick=1, x=1, y=2, theta=0, name="\x1b[31mada\n"), "ada, (1.00, 2.00)"),
        (Kill(tick=1, name="a" * 1000), "a" * 40 + "…" + "a" * 39),
        (SetParameter(tick=1, name="background_r", value=7), "background_r = 7"),
        (Clear(tick=1), ""),
        (
            TeleportAbsolute(tick=1, x=math.nan, y=2, theta=math.inf),
            "to an unknown place, heading inf°",
        ),
    ],
)
def test_a_call_says_what_it_asked_for(event, said):
    assert str(words.asked_for(event)) == said


def test_a_drawing_is_told_quarter_by_quarter():
    canvas = np.zeros((500, 500, 4), dtype=np.uint8)
    canvas[10:20, 300:310] = (255, 0, 0, 255)
    canvas[10:20, 100:109] = (0, 255, 0, 255)
    canvas[10:20, 109:110] = (0, 0, 255, 255)
    canvas[300:301, 100:101] = (255, 255, 255, 255)
    canvas[300:400, 300:400] = (0x45, 0x56, 0xFF, 255)  # the background's colour: nobody sees it
    assert tuple(map(str, words.drawn(canvas, BLUE_GROUND))) == (
        "top right (quadrant I): all red (255, 0, 0), 100 pixels",
        "top left (quadrant II): mostly green (0, 255, 0), 100 pixels",
        "bottom left (quadrant III): all white (255, 255, 255), 1 pixel",
        "bottom right (quadrant IV): nothing drawn",
    )


def test_where_no_colour_prevails_the_commonest_is_named():
    canvas = np.zeros((500, 500, 4), dtype=np.uint8)
    for row, color in enumerate(((255, 0, 0), (0, 255, 0), (0, 0, 255), (255, 0, 0))):
        canvas[row, 300:310] = (*color, 255)
    first, *_ = words.drawn(canvas, BLUE_GROUND)
    assert str(first).endswith("): 40 pixels of 3 colours, most often red (255, 0, 0)")
