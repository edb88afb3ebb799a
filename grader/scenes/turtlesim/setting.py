"""A setting of turtlesim: a scenario, played beside the submission as `turtlesim_py.scenario` does.

It may have any turtles. Its events of a tick happen before those that the submission has sent for
that tick.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from grader.text.message import NOTHING, Message, msg
from turtlesim_py.scenario import ScenarioError, events_by_tick, parse, replay
from turtlesim_py.world.events import Event, Spawn

#: The longest scenario [ticks]: an hour. It is replayed when an exercise is loaded.
MOST_TICKS = 225_000


def script(setting: str) -> tuple[Sequence[Event], Mapping[int, Sequence[Event]]]:
    """Return a scenario's events before a run begins, and those by tick; 1 is recorded first.

    Turtles of tick 1 are spawned before the run: a submission that waits for a later one would look
    as if it waited in vain.
    """
    if not setting:
        return (), {}
    by_tick = {
        tick: [event for _, event in each] for tick, each in events_by_tick(parse(setting)).items()
    }
    spawned = [event for event in by_tick.get(1, ()) if isinstance(event, Spawn)]
    if spawned:
        by_tick[1] = [event for event in by_tick[1] if event not in spawned]
    return spawned, by_tick


def wrong(setting: str) -> Message:
    """Return why a text is no scenario; NOTHING where it is one, or is empty."""
    if not setting:
        return NOTHING
    try:
        scenario = parse(setting)
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
