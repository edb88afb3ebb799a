"""The checks of the challenge, one for each requirement of the exercise."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from grader.exercise.check import Checks, Tolerances
from grader.exercise.sentences import error_first, how_it_ended
from grader.exercise.verdict import Finding
from grader.exercises.turtlesim_challenge.commands import too_fast
from grader.exercises.turtlesim_challenge.edge import judge_edge
from grader.exercises.turtlesim_challenge.path import Path
from grader.exercises.turtlesim_challenge.penning import judge_pens
from grader.exercises.turtlesim_challenge.pens import check_demanded
from grader.exercises.turtlesim_challenge.picture import judge_picture
from grader.exercises.turtlesim_challenge.rate import judge_calls, judge_rate
from grader.exercises.turtlesim_challenge.spiral import judge_spiral
from grader.recording.recording import Recording, Recordings
from grader.scenes.turtlesim.trace import TurtleTrace
from grader.text.message import Message, joined, msg
from turtlesim_py.world.events import CmdVel
from turtlesim_py.world.turtle import TICK_S

checks = Checks()
#: Why a program passes some of these that reads no pose; the others are about that.
NOMINAL = "the nominal run starts where everybody knows"


@checks.tolerance
def colours(asked: Any) -> None:
    """The colours that the quadrants are to have, if any: {1: [255, 255, 255], ...}."""
    check_demanded(asked)


@checks(parrot=NOMINAL)
def moves(recordings: Recordings, _: Tolerances) -> Finding:
    """The node starts and moves turtle1.

    The first thing of all: a command on /turtle1/cmd_vel has moved turtle1 by its linear velocity.
    All or nothing. Without it nothing else is judged.
    """
    recording = recordings.nominal
    path = Path(recording)
    commands = TurtleTrace.of(recording.trace).of_kind(CmdVel)
    if not commands:
        return _silent(recording)
    relocated = _relocated(path)
    if not (path.moving & (path.linear > 0)).any():
        return _unmoved(path, commands, joined([*relocated, how_it_ended(recording)]))
    start = path.at(int(path.ticks[path.first]), msg("here it starts to move"))
    text = msg("{commands} velocity commands moved turtle1.", commands=len(commands))
    return Finding(1, joined([text, *relocated]), evidence=(start,))


def _silent(recording: Recording) -> Finding:
    """Judge a run in which no command came."""
    run = recording.run
    if run.outcome in ("crashed", "exited", "killed"):  # its end says when
        text = msg("Your node published no velocity command on /turtle1/cmd_vel.")
    else:
        text = msg(
            "Your node published no velocity command on /turtle1/cmd_vel in {seconds:.1f} s.",
            seconds=run.simulated_s,
        )
    help_ = _where_it_published(recording)
    if run.outcome == "crashed":
        help_ = msg("Mend that error first; all that the node printed is in output.txt.")
    return Finding(0, joined([text, how_it_ended(recording)]), help_)


def _unmoved(path: Path, commands: Sequence[CmdVel], more: Message) -> Finding:
    """Judge a run in which commands came, and none has moved the turtle."""
    seconds = path.recording.run.simulated_s
    first = (path.at(commands[0].tick, msg("the first command")),)
    fast = too_fast(path, int(path.ticks[-1])) if len(path) else None
    if fast is not None:
        return Finding(0, joined([fast.text, more]), fast.help)
    if not any(value for call in commands for value in (*call.linear, *call.angular)):
        text = msg(
            "Your node published {n} velocity command in {seconds:.1f} s, and never moved "
            "turtle1: all were zeros.",
            "Your node published {n} velocity commands in {seconds:.1f} s, and never moved "
            "turtle1: all were zeros.",
            n=len(commands),
            seconds=seconds,
        )
        help_ = msg(
            "Is linear.x of the Twist ever set? If your node stops near a wall: is that condition "
            "always true, `<` for `>`?"
        )
        return Finding(0, joined([text, more]), help_, first)
    text = msg(
        "Your node published velocity commands ({commands} in {seconds:.1f} s), but they never "
        "moved turtle1.",
        commands=len(commands),
        seconds=seconds,
    )
    help_ = msg("Is linear.x of the Twist different from zero? If it is to grow: what adds to it?")
    return Finding(0, joined([text, more]), help_, first)


def _relocated(path: Path) -> list[str | Message]:
    """Return a sentence on motion that was no driving, and a blank before it; or nothing."""
    if not path.relocations:
        return []
    names = ", ".join(sorted({event.op for event in path.relocations}))
    text = msg(
        "It was also moved by {names} ({calls} calls, the first at {first_s:.2f} s); "
        "only the longest stretch without them is judged.",
        names=names,
        calls=len(path.relocations),
        first_s=path.relocations[0].tick * TICK_S,
    )
    return [" ", text]


def _where_it_published(recording: Recording) -> Message:
    twists = [t.topic for t in recording.topics if t.type.endswith("/Twist")]
    others = [topic for topic in twists if topic != "/turtle1/cmd_vel"]
    types = [t.type for t in recording.topics if t.topic == "/turtle1/cmd_vel"]
    if others:
        return msg(
            "It publishes velocities on {topics}: compare the topic's name.",
            topics=", ".join(others),
        )
    if types and types[0] != "geometry_msgs/msg/Twist":
        return msg(
            "It publishes {type} on /turtle1/cmd_vel; the turtle listens to "
            "geometry_msgs/msg/Twist.",
            type=types[0],
        )
    if types:
        return msg("It has a publisher on /turtle1/cmd_vel: is publish() ever called?")
    return msg("Does it create a publisher on /turtle1/cmd_vel, and does it spin?")


@checks(after=("moves",), parrot=NOMINAL)
def spiral(recordings: Recordings, tolerances: Tolerances) -> Finding:
    """A spiral from the centre, wider with each turn.

    The drawn line of the run from the centre, whatever its direction and however the turtle heads:
    driving backwards, corners instead of arcs, and wobbles that stay outside of the turn before
    are fine. Three parts, each all or nothing.

    - {share_start%} for the start: no farther than {start_m} m from the centre of the window.
    - {share_turns%} for the turns: at least {turns} full turns; at most {wrong_way_share%} of all
      turning goes the other way; and the line goes round a centre as often, less half a turn.
    - The rest for growing gently: with each turn the mean distance from the centre grows by
      {growth_m} m at least and {gentle_m} m at most; nine tenths of the line lie outside of the
      turn before; and no more than half of the growth comes from driving straight outwards, as
      between concentric circles.
    """
    return error_first(recordings, judge_spiral(Path(recordings.nominal), tolerances))


@checks(after=("moves",), parrot=NOMINAL)
def steady_rate(recordings: Recordings, tolerances: Tolerances) -> Finding:
    """Commands come at a fixed rate, without pauses.

    The times between the velocity commands of the run from the centre, up to the stop:
    {rate_share%} of them differ from the usual time by {rate_deviation%} of it at most. A pause
    longer than a second, or several commands in every step of the simulator, is no rate. All or
    nothing, but for a path with fewer than {turns} turns: half that many earn nothing, {turns}
    all points, linear in between.
    """
    return error_first(recordings, judge_rate(Path(recordings.nominal), tolerances))


@checks(after=("moves",))
def edge_stop(recordings: Recordings, tolerances: Tolerances) -> Finding:
    """Stops by a command near an edge, wherever it starts.

    In every run turtle1 comes to rest {edge_m} m or less from the nearest wall, without touching
    one, because a command says so: linear.x 0, and in the end angular.z 0 as well. Who turns on
    the spot first and stands then has stopped. Half of the points if it rests only because no more
    commands come (the simulator stops a turtle a second after its last command), or turns on the
    spot to the end. The worst run counts: in the varied runs the turtle drives faster or slower
    than it is commanded, so that only a stop by the pose succeeds in all. Where the time was up
    while the spiral still grew, the other runs decide.
    """
    return error_first(recordings, judge_edge(recordings, tolerances))


@checks(after=("moves",))
def pen_per_quadrant(recordings: Recordings, tolerances: Tolerances) -> Finding:
    """Each quadrant entered gets its own pen colour.

    An entry is right if the pen has its quadrant's colour {late_s} s after the turtle has come in
    by {band_m} m, and draws. A quadrant's colour is the one that most of its stays end with, or
    the one that the exercise asks for. Stays too short for an answer do not count. Colours are
    different if an eye tells them apart: if they are {color_distance} apart in CIELAB (about 2.3
    is just noticeable).

    The points are the part of the entries that are right, times the number of different colours
    out of four: 15 right entries of 31, and 3 colours, are 15/31 x 3/4 x 20 = 7.26 of 20 points.
    In a varied run the quadrants that were entered count instead of four; the worst run counts.
    Where fewer than {chance_share%} of the entries are right, one right entry for each quadrant not
    counted, or the colours of a varied run come where the turtle would be if it obeyed each command
    exactly, they do not come from the pose: no points.
    """
    return error_first(recordings, judge_pens(recordings, tolerances))


@checks(after=("moves",), parrot=NOMINAL)
def picture(recordings: Recordings, tolerances: Tolerances) -> Finding:
    """Four quarters, each in a colour of its own.

    What the run from the centre leaves on the canvas: each quarter has ink, {own_ink%} or more of
    it in one colour, and the four colours differ as above. What is drawn within the {late_s} s
    that a colour may take does not count as mixed, and what has the colour of the background is
    not there. Another background is allowed. All or nothing.
    """
    return error_first(recordings, judge_picture(recordings.nominal, tolerances))


@checks(after=("moves",), parrot=NOMINAL)
def no_redundant_calls(recordings: Recordings, tolerances: Tolerances) -> Finding:
    """set_pen is called on entering a quadrant only.

    In the run from the centre set_pen is called no more often than quadrants are entered, and
    {spare_calls} times more. Calls that switch the pen off are worth nothing. All or nothing, but
    for a path with fewer than {turns} turns, as for the rate; and for fewer calls than entries:
    then the points are the part of the entries that have one.
    """
    return error_first(recordings, judge_calls(Path(recordings.nominal), tolerances))
