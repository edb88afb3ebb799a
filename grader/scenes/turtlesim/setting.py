"""A setting of turtlesim: a scenario, played beside the submission as `turtlesim_py.scenario` does.

It may have any turtles: what it spawns, drives or teleports in a tick happens before what the
submission has sent for that tick.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any

from grader.message import NOTHING, Message, msg
from turtlesim_py.scenario import ScenarioError, events_by_tick, replay
from turtlesim_py.world.events import Event, Spawn

#: A scenario is played through when an exercise is loaded: no longer than an hour [ticks].
MOST_TICKS = 225_000


def script(setting: str) -> tuple[Sequence[Event], Mapping[int, Sequence[Event]]]:
    """What a scenario does before a run begins, and in which tick, 1 for the first recorded.

    Turtles are spawned in tick 1, and are there before: a submission that waits for one that comes
    later would be taken for one that waits in vain.
    """
    if not setting:
        return (), {}
    by_tick = {
        tick: [event for _, event in each]
        for tick, each in events_by_tick(_scenario(setting)).items()
    }
    there = [event for event in by_tick.get(1, ()) if isinstance(event, Spawn)]
    if there:
        by_tick[1] = [event for event in by_tick[1] if event not in there]
    return there, by_tick


def wrong(setting: str) -> Message:
    """Why a text is no scenario; NOTHING where it is one, or is empty."""
    if not setting:
        return NOTHING
    try:
        scenario = _scenario(setting)
        ticks = scenario.get("ticks")
        if isinstance(ticks, int) and ticks > MOST_TICKS:
            return msg("expected {most} ticks at most, found {ticks}", most=MOST_TICKS, ticks=ticks)
        replay(scenario)
        for tick, each in events_by_tick(scenario).items():
            if tick > 1 and any(isinstance(event, Spawn) for _, event in each):
                return msg("expected turtles to be spawned in tick 1, found tick {tick}", tick=tick)
    except ScenarioError as error:
        return msg("expected a scenario in JSON: {why}", why=str(error))
    return NOTHING


def _scenario(setting: str) -> dict[str, Any]:
    try:
        data = json.loads(setting)
    except ValueError as error:
        raise ScenarioError(str(error)) from None
    if isinstance(data, dict):
        data = data.get("scenario", data)
    if not isinstance(data, dict):
        raise ScenarioError(f"expected an object, found {data!r:.40}")
    return data
