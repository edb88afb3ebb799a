"""The checks of the challenge. Each looks at one thing that the exercise asks for."""

from __future__ import annotations

from typing import Any

import numpy as np

from grader.check import Checks, Tolerances
from grader.exercises.turtlesim_challenge import ink, pens
from grader.exercises.turtlesim_challenge.path import NAMES, Path
from grader.messages import how_it_ended
from grader.recording import Recording
from grader.verdict import Evidence, Finding
from turtlesim_py.world.turtle import TICK_S

checks = Checks()


def _is_zero(command: dict[str, Any]) -> bool:
    return not command["linear"][0] and not command["angular"][2]


@checks()
def moves(recording: Recording, _: Tolerances) -> Finding:
    """The node starts, and its velocity commands move turtle1."""
    path = Path(recording)
    commands = recording.calls("cmd_vel")
    seconds = f"{recording.run.simulated_s:.1f} s"
    ending = how_it_ended(recording)
    if not commands:
        return Finding(
            0,
            f"Your node published no velocity command on /turtle1/cmd_vel in {seconds}.{ending}",
            _where_it_published(recording),
        )
    if not path.moving.any():
        return Finding(
            0,
            f"Your node published {len(commands)} velocity commands in {seconds}, "
            f"but turtle1 never moved.{ending}",
            "Is linear.x of the Twist different from zero?",
            (path.at(commands[0]["tick"], "the first command"),),
        )
    start = path.at(path.first + 1, "here it starts to move")
    return Finding(1, f"{len(commands)} velocity commands moved turtle1.", evidence=(start,))


def _where_it_published(recording: Recording) -> str:
    others = [t for t in recording.topics if t["topic"] != "/turtle1/cmd_vel"]
    twists = [t["topic"] for t in others if t["type"].endswith("/Twist")]
    wrong_type = [t for t in recording.topics if t["topic"] == "/turtle1/cmd_vel"]
    if twists:
        return f"It publishes velocities on {', '.join(twists)}: compare the topic's name."
    if wrong_type and wrong_type[0]["type"] != "geometry_msgs/msg/Twist":
        return (
            f"It publishes {wrong_type[0]['type']} on /turtle1/cmd_vel; "
            "the turtle listens to geometry_msgs/msg/Twist."
        )
    if wrong_type:
        return "It has a publisher on /turtle1/cmd_vel: is publish() ever called?"
    return "Does it create a publisher on /turtle1/cmd_vel, and does it spin?"


@checks(after=("moves",))
def spiral(recording: Recording, tolerances: Tolerances) -> Finding:
    """It draws a spiral from the centre: one way round, and gently wider with each turn."""
    path = Path(recording)
    seen: list[str] = []
    evidence: list[Evidence] = []
    share = 0.0
    start_m = float(path.distance[path.first])
    if start_m <= tolerances["start_m"]:
        share += 1 / 6
    else:
        seen.append(f"The path starts {start_m:.2f} m from the centre.")
        evidence.append(path.at(path.first + 1, "the start"))
    rows = slice(path.first + 1, path.last + 1)
    turning = path.turning[rows]
    way = np.sign(np.sum(turning))
    turns = abs(float(np.sum(turning))) * TICK_S / (2 * np.pi)
    wrong_way = float(np.mean(turning * way < 0)) if len(turning) else 0.0
    if turns >= tolerances["turns"] and wrong_way <= tolerances["wrong_way_share"]:
        share += 2 / 6
    else:
        seen.append(
            f"It made {turns:.1f} turns, {100 * wrong_way:.0f} % of the time the other way round; "
            f"{tolerances['turns']} turns one way are asked for."
        )
    growth = _growth(path, rows)
    if len(growth) and growth.min() >= tolerances["growth_m"]:
        share += 2 / 6
        if growth.max() <= tolerances["gentle_m"]:
            share += 1 / 6
        else:
            seen.append(f"Its distance from the centre jumped by {growth.max():.2f} m in one turn.")
    else:
        least = f"{growth.min():.2f} m in one turn" if len(growth) else "not known in under 2 turns"
        seen.append(f"Its distance from the centre must grow with each turn; it grew {least}.")
    if not seen:
        return Finding(
            1,
            f"{turns:.1f} turns from the centre, wider by {growth.min():.2f} to "
            f"{growth.max():.2f} m with each.",
        )
    help_ = "A constant angular velocity with a slowly growing linear velocity makes a spiral."
    return Finding(share, " ".join(seen), help_, tuple(evidence))


def _growth(path: Path, rows: slice) -> Any:
    """By how much the mean distance from the centre grows from each full turn to the next [m]."""
    angle = np.cumsum(np.abs(path.turning[rows])) * TICK_S
    turn = np.floor(angle / (2 * np.pi)).astype(int)
    whole = int(turn[-1]) if len(turn) else 0
    means = [float(path.distance[rows][turn == k].mean()) for k in range(whole)]
    return np.diff(means)


@checks(after=("moves",))
def steady_rate(recording: Recording, tolerances: Tolerances) -> Finding:
    """Commands come at a fixed rate, and often enough that the turtle never pauses."""
    path = Path(recording)
    stop = path.last + 1
    ticks = [c["tick"] for c in recording.calls("cmd_vel") if c["tick"] <= stop]
    if len(ticks) < 3:
        return Finding(0, f"{len(ticks)} commands are too few to have a rate.", "Use a timer.")
    intervals = np.diff(ticks) * TICK_S
    median = float(np.median(intervals))
    near = np.abs(intervals - median) <= tolerances["rate_deviation"] * max(median, TICK_S)
    pauses = np.flatnonzero(~path.moving[path.first + 1 : path.last + 1])
    if len(pauses):
        tick = int(path.first + 2 + pauses[0])
        return Finding(
            0,
            "The turtle paused on its way: a command moves it for one second only.",
            "Publish at a fixed rate, faster than once a second.",
            (path.at(tick, "it stands still here"),),
        )
    if near.mean() < tolerances["rate_share"]:
        return Finding(
            0,
            f"The intervals between commands vary: half of them are over {median:.2f} s, and only "
            f"{100 * near.mean():.0f} % are near that.",
            "A timer keeps the rate fixed.",
        )
    return Finding(1, f"One command every {median:.2f} s.")


@checks(after=("moves",))
def edge_stop(recording: Recording, tolerances: Tolerances) -> Finding:
    """It stops near an edge by its own command, without touching a wall."""
    path = Path(recording)
    end = path.at(path.last + 1, "the last place it moved to")
    walls = [log for log in recording.logs if "I hit the wall" in log[3]]
    if walls:
        return Finding(
            0,
            f"The turtle ran into the wall {len(walls)} times.",
            "Watch the pose, and stop before a wall is reached.",
            (path.at(walls[0][0], "it hits the wall here"),),
        )
    if recording.run.outcome == "time_limit" and path.last >= len(path) - 2:
        return Finding(
            0,
            f"The turtle was still moving after {recording.run.simulated_s:.0f} s.",
            "Compare x and y of the pose with the size of the window, and publish a zero Twist.",
            (end,),
        )
    gap = float(path.wall_distance[path.last])
    if gap > tolerances["edge_m"]:
        return Finding(
            0,
            f"The turtle came to rest {gap:.2f} m from the nearest wall; "
            f"{tolerances['edge_m']} m or less is near.{how_it_ended(recording)}",
            "What should make it stop is the pose, near an edge.",
            (end,),
        )
    last_commands = [c for c in recording.calls("cmd_vel") if c["tick"] <= path.last + 2]
    if not last_commands or not _is_zero(last_commands[-1]):
        return Finding(
            0,
            f"The turtle came to rest {gap:.2f} m from the wall because no command came any "
            f"more, not because it was told to stop.{how_it_ended(recording)}",
            "Publish a Twist of zeros to stop.",
            (end,),
        )
    return Finding(1, f"It stopped by a command, {gap:.2f} m from the wall.", evidence=(end,))


@checks(after=("moves",))
def pen_per_quadrant(recording: Recording, tolerances: Tolerances) -> Finding:
    """On entering a quadrant the pen takes that quadrant's colour, four different ones."""
    path = Path(recording)
    entries = path.entries(tolerances["band_m"])
    colors = pens.colors_by_tick(recording)
    own = pens.own_colors(path, entries, colors)
    if not recording.calls("set_pen"):
        return Finding(
            0,
            "The pen was never changed.",
            "Call the service /turtle1/set_pen when the turtle enters another quadrant.",
        )
    late_ticks = round(tolerances["late_s"] / TICK_S)
    # After its last command the turtle is not on its way any more, and a last-moment entry
    # leaves no time for an answer.
    end = min(path.last + 1, recording.calls("cmd_vel")[-1]["tick"])
    judged = [e for e in entries if e.tick + (late_ticks if e is entries[-1] else 0) <= end]
    bad = [e for e in judged if not pens.in_time(e, own, colors, late_ticks)]
    different = len(set(own.values()))
    good_share = 1 - len(bad) / len(judged) if judged else 0.0
    share = good_share * different / 4
    if share >= 1:
        return Finding(1, f"All {len(judged)} entries changed the pen to the quadrant's colour.")
    text = f"{len(judged) - len(bad)} of {len(judged)} entries into a quadrant changed the pen to "
    text += f"that quadrant's colour in time; the quadrants have {different} different colours."
    evidence = tuple(path.at(e.tick, f"quadrant {NAMES[e.quadrant]}") for e in bad[:5])
    return Finding(
        share,
        text,
        "Compare the new quadrant with the one before, and look how long the answer takes.",
        evidence,
    )


@checks(after=("moves",))
def picture(recording: Recording, tolerances: Tolerances) -> Finding:
    """The picture has four quarters, each in a colour of its own."""
    quarters = ink.quarters(recording.canvas)
    empty = [NAMES[q] for q, quarter in quarters.items() if quarter.pixels < ink.LEAST_PIXELS]
    if empty:
        return Finding(
            0,
            f"There is next to nothing drawn in quadrant {', '.join(empty)}.",
            "Draw on until the spiral fills the window.",
        )
    mixed = [q for q, quarter in quarters.items() if quarter.share < tolerances["own_ink"]]
    same = len({quarter.color for quarter in quarters.values()})
    if mixed:
        shares = ", ".join(f"{NAMES[q]}: {100 * quarters[q].share:.0f} %" for q in mixed)
        return Finding(
            0,
            f"Quarters with a mixture of colours; the main one covers {shares}.",
            "The colour should change where the turtle enters a quadrant.",
        )
    if same < 4:
        return Finding(
            0,
            f"The four quarters show {same} different colours.",
            "Give each quadrant a colour of its own.",
        )
    total = sum(quarter.pixels for quarter in quarters.values())
    return Finding(1, f"Four quarters, four colours, {total} painted pixels.")


@checks(after=("moves",))
def no_redundant_calls(recording: Recording, tolerances: Tolerances) -> Finding:
    """The pen service is called on entering a quadrant only."""
    path = Path(recording)
    calls = recording.calls("set_pen")
    needed = len(path.entries(0.0))
    if not calls:
        return Finding(0, "set_pen was never called.", "Call it once for each quadrant entered.")
    useless = pens.repeated(calls)
    if len(calls) <= needed + tolerances["spare_calls"]:
        return Finding(1, f"{len(calls)} calls for {needed} entries.")
    first = (useless or calls[needed:])[0]
    return Finding(
        0,
        f"set_pen was called {len(calls)} times; {needed} were needed.",
        "Remember the quadrant of the last call, and call only when it changes.",
        (path.at(first["tick"], "a call that was not needed"),),
    )
