"""The checks of the challenge. Each looks at one thing that the exercise asks for."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np

from grader.exercise.check import Checks, Tolerances
from grader.exercise.sentences import how_it_ended
from grader.exercise.verdict import Evidence, Finding
from grader.exercises.turtlesim_challenge import ink, pens, shape
from grader.exercises.turtlesim_challenge.path import CENTRE_M, NAMES, Path
from grader.exercises.turtlesim_challenge.stops import judge_start, judge_stop
from grader.recording.recording import Recording, Recordings
from grader.scenes.turtlesim.trace import TurtleTrace
from turtlesim_py.world.events import CmdVel, SetPen
from turtlesim_py.world.turtle import COMMAND_TIMEOUT_NS, TICK_S

checks = Checks()

#: Ticks after which a command moves the turtle no more.
WATCHDOG_TICKS = int(COMMAND_TIMEOUT_NS / 1e9 / TICK_S) + 1


@checks()
def moves(recordings: Recordings, _: Tolerances) -> Finding:
    """The node starts and moves turtle1."""
    recording = recordings.nominal
    path = Path(recording)
    commands = TurtleTrace.of(recording.trace).of_kind(CmdVel)
    seconds = f"{recording.run.simulated_s:.1f} s"
    ending = how_it_ended(recording)
    if not commands:
        rationale = f"Your node published no velocity command on /turtle1/cmd_vel in {seconds}."
        help_ = _where_it_published(recording)
        if recording.run.outcome == "crashed":
            help_ = "Mend that error first; all that the node printed is in output.txt."
        return Finding(0, rationale + ending, help_)
    foreign = _foreign(path)
    if not (path.moving & (path.linear > 0)).any():
        return Finding(
            0,
            f"Your node published velocity commands ({len(commands)} in {seconds}), "
            f"but they never moved turtle1.{foreign}{ending}",
            "Is linear.x of the Twist different from zero?",
            (path.at(commands[0].tick, "the first command"),),
        )
    start = path.at(int(path.ticks[path.first]), "here it starts to move")
    return Finding(
        1, f"{len(commands)} velocity commands moved turtle1.{foreign}", evidence=(start,)
    )


def _foreign(path: Path) -> str:
    """A sentence about motion that was no driving."""
    if not path.foreign:
        return ""
    names = ", ".join(sorted({event.op for event in path.foreign}))
    first = path.foreign[0].tick * TICK_S
    return (
        f" It was also moved by {names} ({len(path.foreign)} calls, the first at {first:.2f} s); "
        "only the longest stretch without them is judged."
    )


def _where_it_published(recording: Recording) -> str:
    twists = [t.topic for t in recording.topics if t.type.endswith("/Twist")]
    others = [topic for topic in twists if topic != "/turtle1/cmd_vel"]
    types = [t.type for t in recording.topics if t.topic == "/turtle1/cmd_vel"]
    if others:
        return f"It publishes velocities on {', '.join(others)}: compare the topic's name."
    if types and types[0] != "geometry_msgs/msg/Twist":
        return (
            f"It publishes {types[0]} on /turtle1/cmd_vel; the turtle listens to "
            "geometry_msgs/msg/Twist."
        )
    if types:
        return "It has a publisher on /turtle1/cmd_vel: is publish() ever called?"
    return "Does it create a publisher on /turtle1/cmd_vel, and does it spin?"


@checks(after=("moves",))
def spiral(recordings: Recordings, tolerances: Tolerances) -> Finding:
    """A spiral from the centre, wider with each turn."""
    path = Path(recordings.nominal)
    missed: list[str] = []
    evidence: list[Evidence] = []
    share = 0.0
    start_m = float(path.distance[path.first])
    if start_m <= tolerances["start_m"]:
        share += tolerances["share_start"]
    else:
        missed.append(f"The path starts {start_m:.2f} m from the centre.")
        evidence.append(path.at(int(path.ticks[path.first]), "the start"))
    turns, other_way = shape.turns(path)
    loops = shape.loops(path)
    goes_round = loops.rounds >= tolerances["turns"] - shape.BEHIND_TURNS
    turns_enough = turns >= tolerances["turns"] and other_way <= tolerances["wrong_way_share"]
    if turns_enough and goes_round:
        share += tolerances["share_turns"]
    elif turns_enough:
        missed.append(
            f"The turtle turned {turns:.1f} times, but its path goes only {loops.rounds:.1f} times "
            f"round any centre; at least {tolerances['turns']:g} times are asked for."
        )
    else:
        missed.append(
            f"It made {turns:.1f} turns, with {100 * other_way:.0f} % of the turning the other "
            f"way; at least {tolerances['turns']:g} turns in one direction are asked for."
        )
    growth = shape.growth(path)
    grows = len(growth) > 0 and growth.min() >= tolerances["growth_m"]
    if grows and not (goes_round and loops.outside >= shape.MOSTLY):
        missed.append("Going round, its path does not stay outside of what it has drawn before.")
    elif grows and loops.farthest_m > tolerances["gentle_m"]:
        missed.append(f"It came away from its last turn by {loops.farthest_m:.2f} m.")
    elif grows and growth.max() <= tolerances["gentle_m"]:
        share += 1 - tolerances["share_start"] - tolerances["share_turns"]
    elif grows:
        missed.append(f"Its distance from the centre jumped by {growth.max():.2f} m in one turn.")
    elif len(growth):
        missed.append(
            f"Its mean distance from the centre must grow with each turn; from one turn to the "
            f"next it changed by {growth.min():+.2f} m."
        )
    else:
        missed.append("With fewer than two turns nobody can tell whether they grow.")
    if not missed:
        sizes = f"{growth.min():.2f} to {growth.max():.2f} m"
        return Finding(1, f"{turns:.1f} turns from the centre, each wider by {sizes}.")
    help_ = "A constant angular velocity with a slowly growing linear velocity makes a spiral."
    return Finding(share, " ".join(missed), help_, tuple(evidence))


@checks(after=("moves",))
def steady_rate(recordings: Recordings, tolerances: Tolerances) -> Finding:
    """Commands come at a fixed rate, without pauses."""
    path = Path(recordings.nominal)
    ticks = np.array([c.tick for c in path.calls(CmdVel) if c.tick <= path.stop_tick + 1])
    if len(ticks) < 3:
        return Finding(0, f"Fewer than three commands ({len(ticks)}) have no rate.", "Use a timer.")
    gaps = np.diff(ticks)
    if gaps.max() > WATCHDOG_TICKS:
        row = int(np.argmax(gaps > WATCHDOG_TICKS))
        return Finding(
            0,
            f"No command came for {gaps[row] * TICK_S:.2f} s, and the turtle paused on its way: "
            "a command moves it for one second only.",
            "Publish at a fixed rate, faster than once a second.",
            (path.at(int(ticks[row]) + WATCHDOG_TICKS, "it stands still here"),),
        )
    median = float(np.median(gaps))
    allowed = max(tolerances["rate_deviation"] * median, 1.5)
    regular = float(np.mean(np.abs(gaps - median) <= allowed))
    if regular < tolerances["rate_share"]:
        return Finding(
            0,
            f"The time between commands varies: usually it is {median * TICK_S:.2f} s, but only "
            f"{100 * regular:.0f} % of the intervals are near that.",
            "A timer keeps the rate fixed.",
        )
    return Finding(1, f"A command every {median * TICK_S:.2f} s.")


@checks(after=("moves",))
def edge_stop(recordings: Recordings, tolerances: Tolerances) -> Finding:
    """Stops by a command near an edge, wherever it starts."""
    findings = [
        judge_stop(Path(recording, n), tolerances) for n, recording in enumerate(recordings)
    ]
    failed = [(n, finding) for n, finding in enumerate(findings) if finding.share < 1]
    if not failed:
        rationale = f"It {findings[0].rationale}{_in_varied_runs_too(recordings)}."
        return Finding(1, rationale, evidence=findings[0].evidence)
    number, worst = failed[0]
    if number == 0:
        return worst
    away = _moved_away(recordings)
    if away is not None:
        return replace(
            away, rationale=f"From the centre it {findings[0].rationale}. " + away.rationale
        )
    return Finding(
        0,
        f"From the centre it {findings[0].rationale}, but not when it started elsewhere: "
        f"{worst.rationale}",
        "The stop must depend on the pose, not on the time or on how often something was done.",
        worst.evidence,
    )


@checks(after=("moves",))
def pen_per_quadrant(recordings: Recordings, tolerances: Tolerances) -> Finding:
    """Each quadrant entered gets its own pen colour."""
    path = Path(recordings.nominal)
    if not path.calls(SetPen):
        return Finding(
            0,
            "The pen was never changed.",
            "Call the service /turtle1/set_pen when the turtle enters another quadrant.",
        )
    paths = [Path(recording, number) for number, recording in enumerate(recordings)]
    colorings = [pens.coloring(path, tolerances) for path in paths]
    away = _moved_away(recordings)
    if away is not None and colorings[0].share > 0:
        return away
    telling = [n for n, coloring in enumerate(colorings) if coloring.tells or n == 0]
    worst = min(telling, key=lambda n: colorings[n].share)
    found, path = colorings[worst], paths[worst]
    if found.share >= 1:
        entries = len(colorings[0].judged)
        rationale = f"All {entries} entries gave the pen its quadrant's colour"
        return Finding(1, f"{rationale}{_in_varied_runs_too(recordings)}.")
    text = (
        f"{len(found.judged) - len(found.bad)} of {len(found.judged)} entries into a quadrant "
        f"gave the pen that quadrant's colour in time; the {len(found.own)} quadrants that were "
        f"entered have {found.different} different colours."
    )
    if worst:
        text = f"When the turtle started elsewhere (run {worst}): {text}"
    evidence = tuple(path.at(e.tick, f"enters quadrant {NAMES[e.quadrant]}") for e in found.bad[:5])
    help_ = "Compare the quadrant of each pose with the one before. Which is where?"
    return Finding(found.share, text, help_, evidence)


def _moved_away(recordings: Recordings) -> Finding | None:
    """Of the runs that start elsewhere, the first in which the turtle was brought away."""
    for number, recording in enumerate(recordings.varied, start=1):
        void = judge_start(Path(recording, number))
        if void is not None:
            told = f"The turtle started elsewhere (run {number}). {void.rationale}"
            return replace(void, rationale=told)
    return None


def _in_varied_runs_too(recordings: Recordings) -> str:
    count = len(recordings.varied)
    return f", and in the {count} runs that start elsewhere too" if count else ""


@checks(after=("moves",))
def picture(recordings: Recordings, tolerances: Tolerances) -> Finding:
    """Four quarters, each in a colour of its own."""
    background = ink.background(recordings.nominal)
    quarters = ink.quarters(ink.own_drawing(recordings.nominal), background)
    empty = [NAMES[q] for q, quarter in quarters.items() if quarter.pixels < ink.LEAST_PIXELS]
    if empty:
        return Finding(
            0,
            f"There is next to nothing drawn in quadrant {', '.join(empty)}.",
            _how_to_draw(recordings.nominal),
        )
    mixed = [q for q, quarter in quarters.items() if quarter.share < tolerances["own_ink"]]
    if mixed:
        shares = ", ".join(f"{NAMES[q]} {100 * quarters[q].share:.0f} %" for q in mixed)
        return Finding(
            0,
            f"Some quarters mix colours; their main colour covers only: {shares}.",
            "The colour should change where the turtle enters a quadrant.",
        )
    different = len({quarter.color for quarter in quarters.values()})
    if different < 4:
        return Finding(
            0,
            f"The four quarters show {different} different colours.",
            "Give each quadrant a colour of its own.",
        )
    total = sum(quarter.pixels for quarter in quarters.values())
    return Finding(1, f"Four quarters, four colours, {total} painted pixels.")


def _how_to_draw(recording: Recording) -> str:
    calls = TurtleTrace.of(recording.trace).of_kind(SetPen)
    if any(call.off for call in calls):
        return "A pen that is off draws nothing: look at what your requests say of `off`."
    background = ink.background(recording)
    if any((call.r, call.g, call.b) == background for call in calls):
        return "What is drawn in the colour of the background cannot be seen."
    return "Draw on until the spiral fills the window."


@checks(after=("moves",))
def no_redundant_calls(recordings: Recordings, tolerances: Tolerances) -> Finding:
    """set_pen is called on entering a quadrant only."""
    path = Path(recordings.nominal)
    calls = path.calls(SetPen)
    if not calls:
        return Finding(0, "set_pen was never called.", "Call it once for each quadrant entered.")
    # Near the start the count of entries depends on where exactly the centre is taken to be.
    counts = [len(path.entries(0.0, centre)) for centre in (CENTRE_M, *tolerances["centres_m"])]
    needed = max(counts)
    if len(calls) <= needed + tolerances["spare_calls"]:
        return Finding(1, f"{len(calls)} calls for {counts[0]} entries.")
    useless = [b for a, b in pairwise(calls) if _same_pen(a, b)]
    first = (useless or calls[needed:])[0]
    return Finding(
        0,
        f"set_pen was called {len(calls)} times; {counts[0]} were needed. The first needless call "
        f"came at {first.tick * TICK_S:.2f} s.",
        "Remember the quadrant of the last call, and call only when it changes.",
        (path.at(first.tick, "a call that was not needed"),),
    )


def _same_pen(earlier: SetPen, later: SetPen) -> bool:
    return replace(earlier, tick=later.tick) == later
