"""The checks of the broadcaster: the frame has to go where the turtle goes."""

from __future__ import annotations

import math

from grader.exercise.check import Checks, Tolerances
from grader.exercise.verdict import Finding
from grader.recording.recording import Recording, Recordings
from grader.scenes.cast.trace import CastTrace
from grader.scenes.turtlesim.driven_path import DrivenPath
from grader.scenes.turtlesim.trace import TurtleTrace
from grader.text.message import chained, msg

checks = Checks()
WORLD = "world"


@checks()
def transform(recordings: Recordings, tolerances: Tolerances) -> Finding:
    """The frame turtle1 goes where turtle1 goes.

    {least} transforms or more from world to turtle1 come on /tf, each {place_m} m and {angle_deg}
    degrees at most from where turtle1 was within {late_s} s before.
    """
    return _follows(recordings.nominal, "turtle1", tolerances)


@checks()
def parameter(recordings: Recordings, tolerances: Tolerances) -> Finding:
    """The parameter says whose frame it is.

    With turtlename:=turtle2 it is the frame turtle2 that goes where turtle2 goes.
    """
    return _follows(recordings.varied[0], "turtle2", tolerances)


def _follows(recording: Recording, turtle: str, tolerances: Tolerances) -> Finding:
    cast = CastTrace.of(recording.cast)
    trace = TurtleTrace.of(recording.trace)
    path = DrivenPath(recording, trace.trajectory(turtle))
    sent = cast.transforms("/tf")
    frames = {(t["header"]["frame_id"], t["child_frame_id"]) for _, t in sent}
    own = [(at, t) for at, t in sent if (WORLD, turtle) == _names(t)]
    words = {"turtle": turtle, "least": tolerances["least"], "found": len(own)}
    if not own:
        others = chained(sorted(f"{parent} to {child}" for parent, child in frames)) or msg("none")
        text = msg("No transform from world to {turtle} came on /tf; there is {others}.", **words,
                   others=others)  # fmt: skip
        return Finding(0, text, msg("header.frame_id is the parent, child_frame_id the child."))
    if len(own) < tolerances["least"] or not len(path):
        text = msg("{found} transforms from world to {turtle} came, expected {least} or more.",
                   **words)  # fmt: skip
        return Finding(0, text, msg("Send one for each pose that comes."))
    if more := {child for _, child in frames} & {*trace.trajectories} - {turtle}:
        text = msg("Called for {turtle}, it sent the frame of {others}, too.",
                   turtle=turtle, others=", ".join(sorted(more)))  # fmt: skip
        return Finding(0, text, msg("The parameter turtlename says whose frame it is to send."))
    late_ticks = math.ceil(tolerances["late_s"] / path.tick_s)
    for time_ns, each in own:
        last = path.row_at(int(time_ns / 1e9 / path.tick_s))
        rows = range(max(0, last - late_ticks), last + 1)
        found = each["transform"]["translation"], each["transform"]["rotation"]
        if not any(_fits(path, row, *found, tolerances) for row in rows):
            place, turn = found
            text = msg(
                "At {time:.2f} s the frame {turtle} was at ({x:.2f}, {y:.2f}, {z:.2f}), turned by "
                "{turn:.0f} degrees; the turtle was at {place}, turned by {right:.0f}.",
                **words,
                time=time_ns / 1e9,
                x=place["x"],
                y=place["y"],
                z=place["z"],
                turn=math.degrees(2 * math.atan2(turn["z"], turn["w"])),
                place=path.place(last),
                right=math.degrees(path.theta[last]),
            )
            help_ = msg("Of a turn by theta about z, the quaternion has z = sin(theta / 2) and "
                        "w = cos(theta / 2).")  # fmt: skip
            return Finding(0, text, help_, (path.evidence(last, msg("the turtle is here")),))
    return Finding(1, msg("{found} transforms from world to {turtle} were right.", **words))


def _names(transform: dict[str, dict[str, str]]) -> tuple[str, str]:
    return transform["header"]["frame_id"], str(transform["child_frame_id"])


def _fits(
    path: DrivenPath,
    row: int,
    place: dict[str, float],
    turn: dict[str, float],
    tolerances: Tolerances,
) -> bool:
    """Whether a transform is the pose at a row; of a quaternion, the opposite is the same turn."""
    gap = math.dist((place["x"], place["y"], place["z"]), (path.x[row], path.y[row], 0.0))
    half = path.theta[row] / 2
    right = (0.0, 0.0, math.sin(half), math.cos(half))
    found = (turn["x"], turn["y"], turn["z"], turn["w"])
    cosine = abs(sum(a * b for a, b in zip(found, right, strict=True)))
    is_turn = abs(math.hypot(*found) - 1) < 0.01
    angle = math.degrees(2 * math.acos(min(1.0, cosine)))
    return bool(gap <= tolerances["place_m"] and is_turn and angle <= tolerances["angle_deg"])
