"""The checks of the challenge. Each looks at one thing that the exercise asks for."""

from __future__ import annotations

from grader.exercise.check import Checks, Tolerances
from grader.exercise.sentences import how_it_ended
from grader.exercise.verdict import Finding
from grader.exercises.turtlesim_challenge.calls import judge_calls
from grader.exercises.turtlesim_challenge.edge import judge_edge
from grader.exercises.turtlesim_challenge.path import Path
from grader.exercises.turtlesim_challenge.penning import judge_pens
from grader.exercises.turtlesim_challenge.picture import judge_picture
from grader.exercises.turtlesim_challenge.rate import judge_rate
from grader.exercises.turtlesim_challenge.spiral import judge_spiral
from grader.recording.recording import Recording, Recordings
from grader.scenes.turtlesim.trace import TurtleTrace
from turtlesim_py.world.events import CmdVel
from turtlesim_py.world.turtle import TICK_S

checks = Checks()


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
    return judge_spiral(Path(recordings.nominal), tolerances)


@checks(after=("moves",))
def steady_rate(recordings: Recordings, tolerances: Tolerances) -> Finding:
    """Commands come at a fixed rate, without pauses."""
    return judge_rate(Path(recordings.nominal), tolerances)


@checks(after=("moves",))
def edge_stop(recordings: Recordings, tolerances: Tolerances) -> Finding:
    """Stops by a command near an edge, wherever it starts."""
    return judge_edge(recordings, tolerances)


@checks(after=("moves",))
def pen_per_quadrant(recordings: Recordings, tolerances: Tolerances) -> Finding:
    """Each quadrant entered gets its own pen colour."""
    return judge_pens(recordings, tolerances)


@checks(after=("moves",))
def picture(recordings: Recordings, tolerances: Tolerances) -> Finding:
    """Four quarters, each in a colour of its own."""
    return judge_picture(recordings.nominal, tolerances)


@checks(after=("moves",))
def no_redundant_calls(recordings: Recordings, tolerances: Tolerances) -> Finding:
    """set_pen is called on entering a quadrant only."""
    return judge_calls(Path(recordings.nominal), tolerances)
