"""A run in words, for readers that do not see colours: requests, remarks, the drawing.

Quadrants have their numbers of mathematics. A colour is named roughly after its hue, followed by
its RGB values.
"""

from __future__ import annotations

import colorsys
import math
from collections.abc import Iterator, Sequence
from functools import lru_cache

import numpy as np

from grader.recording.subject import Pixels
from grader.scenes.turtlesim.trace import FIRST_TURTLE, TurtleTrace
from grader.text import strings as text
from grader.text.message import NOTHING, Message, joined, msg
from turtlesim_py.ros.interfaces import NEWER, OLDER
from turtlesim_py.world.events import (
    Clear,
    Event,
    Kill,
    Reset,
    RotateAbsolute,
    SetParameter,
    SetPen,
    Spawn,
    TeleportAbsolute,
    TeleportRelative,
)
from turtlesim_py.world.turtle import SIZE_M, TICK_S

QUADRANTS = {
    1: msg("top right (quadrant I)"),
    2: msg("top left (quadrant II)"),
    3: msg("bottom left (quadrant III)"),
    4: msg("bottom right (quadrant IV)"),
}
#: The largest hue [degrees] of a name.
_HUES = (
    (15, msg("red")),
    (45, msg("orange")),
    (70, msg("yellow")),
    (165, msg("green")),
    (200, msg("cyan")),
    (260, msg("blue")),
    (290, msg("purple")),
    (320, msg("magenta")),
    (345, msg("pink")),
    (360, msg("red")),
)
#: The most characters that are shown of a submission's text.
_NAME_LIMIT = 80


@lru_cache(1024)
def color(r: int, g: int, b: int) -> Message:
    """Name a colour, each part 0-255: 'red (255, 0, 0)'."""
    return msg("{name} ({r}, {g}, {b})", name=_named(r, g, b), r=r, g=g, b=b)


def _named(r: int, g: int, b: int) -> Message:
    hue, saturation, value = colorsys.rgb_to_hsv(r / 255, g / 255, b / 255)
    if value < 0.2:
        return msg("black")
    if saturation < 0.12:
        return msg("white") if value > 0.9 else msg("grey")
    name = next(name for most, name in _HUES if 360 * hue <= most)
    if value < 0.6:
        return msg("dark {color}", color=name)
    return msg("light {color}", color=name) if saturation < 0.5 else name


def quarter(x: float, y: float) -> Message:
    """Return the quarter of the window that a place [m] lies in; '' for one that is not finite."""
    if not (math.isfinite(x) and math.isfinite(y)):
        return NOTHING
    right, top = x >= SIZE_M / 2, y >= SIZE_M / 2
    return QUADRANTS[(1 if right else 2) if top else (4 if right else 3)]


def asked_for(event: Event) -> Message:
    """Describe the arguments of an input; '' where it has none."""
    turtle = getattr(event, "turtle", FIRST_TURTLE)
    request = _asked_for(event)
    return request if turtle == FIRST_TURTLE else joined([_clipped(turtle), ": ", request])


def _asked_for(event: Event) -> Message:
    match event:
        case SetPen():
            if event.off:
                return msg("the pen off")
            return joined([color(event.r, event.g, event.b), f"{event.width} px"], ", ")
        case TeleportAbsolute():
            place, heading = text.place(event.x, event.y), _degrees(event.theta)
            return msg("to {place}, heading {heading}", place=place, heading=heading)
        case TeleportRelative():
            turn = _degrees(event.angular)
            return msg("a turn by {turn}, then {way:g} m ahead", turn=turn, way=event.linear)
        case RotateAbsolute():
            return msg("to heading {heading}", heading=_degrees(event.theta))
        case Spawn():
            name = Message.of(_clipped(event.name)) or msg("a name of its choice")
            return joined([name, text.place(event.x, event.y)], ", ")
        case Kill():
            return Message.of(_clipped(event.name))
        case SetParameter():
            return Message.of(f"{_clipped(event.name)} = {_clipped(str(event.value))}")
    return NOTHING


def _degrees(theta: float) -> str:
    return f"{math.degrees(theta):.0f}°"


def _clipped(name: str) -> str:
    return text.shown(name, _NAME_LIMIT)


def drawn(canvas: Pixels, background: str) -> tuple[Message, ...]:
    """Describe the visible ink in each quarter of a canvas (height, width, 4), by quadrant.

    Args:
        background: the window's colour, "#rrggbb"; ink of this colour does not show.
    """
    height, width = canvas.shape[0] // 2, canvas.shape[1] // 2
    top, bottom, left, right = slice(height), slice(height, None), slice(width), slice(width, None)
    parts = {1: (top, right), 2: (top, left), 3: (bottom, left), 4: (bottom, right)}
    return tuple(
        msg(
            "{quarter}: {ink}",
            quarter=QUADRANTS[quadrant],
            ink=_ink(canvas[rows, columns], background),
        )
        for quadrant, (rows, columns) in parts.items()
    )


def _ink(part: Pixels, background: str) -> Message:
    ink = part[part[..., 3] > 0][:, :3]
    packed = ink.astype(np.uint32) @ np.array([1 << 16, 1 << 8, 1], dtype=np.uint32)
    packed = packed[packed != int(background[1:], 16)]
    if not len(packed):
        return msg("nothing drawn")
    colors, counts = np.unique(packed, return_counts=True)
    most = int(np.argmax(counts))
    name = color(*int(colors[most]).to_bytes(3, "big"))
    pixels = msg("{n:,} pixel", "{n:,} pixels", n=len(packed))
    if len(colors) == 1:
        return msg("all {color}, {pixels}", color=name, pixels=pixels)
    if 2 * counts[most] > len(packed):
        return msg("mostly {color}, {pixels}", color=name, pixels=pixels)
    return msg(
        "{pixels} of {colors:,} colours, most often {color}",
        pixels=pixels,
        colors=len(colors),
        color=name,
    )


# What the node did other than driving -----------------------------------------------------------

#: Call that changes the arena other than by driving -> its effect.
_INTERVENTIONS: dict[type[Event], Message] = {
    TeleportAbsolute: msg("it moves a turtle without driving"),
    TeleportRelative: msg("it moves a turtle without driving"),
    Spawn: msg("it adds a turtle"),
    Kill: msg("it removes a turtle"),
    Reset: msg("it starts the arena anew"),
    Clear: msg("it wipes the drawing"),
}
_POSE = f"/{FIRST_TURTLE}/pose"


def remarks(
    trace: TurtleTrace, published: Sequence[str], interfaces: str = OLDER
) -> Iterator[Message]:
    """Yield the remarks, one sentence each.

    Args:
        published: the topics that the submission published on.
        interfaces: the package of turtlesim's messages in the run.
    """
    if interfaces == NEWER:
        yield msg(
            "The node was run with the messages of {newer}: ROS 2 has them from Kilted on, "
            "in Jazzy they are those of {older}.",
            newer=NEWER,
            older=OLDER,
        )
    for kind, effect in _INTERVENTIONS.items():
        calls = [event for event in trace.events if isinstance(event, kind)]
        if calls:
            yield msg(
                "The node called {call} once, first at {first_s:.2f} s: {effect}.",
                "The node called {call} {n} times, first at {first_s:.2f} s: {effect}.",
                n=len(calls),
                call=kind.op,
                first_s=calls[0].tick * TICK_S,
                effect=effect,
            )
    thin = [e for e in trace.events if isinstance(e, SetPen) and e.width == 0 and not e.off]
    if thin:
        yield msg(
            "The pen's width is 0, first at {first_s:.2f} s: that draws like width "
            "1; what lifts the pen is off = 1.",
            first_s=thin[0].tick * TICK_S,
        )
    if _POSE in published:
        yield msg(
            "The node published on {topic} itself. Judged is where the turtle really was.",
            topic=_POSE,
        )
