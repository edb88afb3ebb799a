"""The checks of the service that draws: the polygon that was asked for, and when it answers."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import Any

from grader.exercise.check import Checks, Tolerances
from grader.exercise.expect.judging import no_service
from grader.exercise.verdict import Finding
from grader.recording.recording import Recording, Recordings
from grader.scenes.cast.trace import CastTrace
from grader.scenes.turtlesim.driven_path import DrivenPath
from grader.scenes.turtlesim.trace import USUAL_START, TurtleTrace
from grader.text.message import msg

checks = Checks()
SERVICE = "/draw_polygon", "turtle_exercise_interfaces/srv/DrawPolygon"
SENDS = msg("Your service publishes on /turtle1/cmd_vel: do the messages go out?")
#: Of a turtle that has not moved [m].
STILL_M = 0.01
#: It may still have been rolling when the answer came [s].
LATE_S = 0.5


@checks(parrot="what it has drawn is judged")
def serves(recordings: Recordings, tolerances: Tolerances) -> Finding:
    """It serves draw_polygon.

    The call of the caller reaches it.
    """
    if "sent_ns" in _call(recordings.nominal):
        return Finding(1, msg("draw_polygon is there."))
    return no_service(CastTrace.of(recordings.nominal.cast), *SERVICE).finding


@checks(after=("serves",))
def square(recordings: Recordings, tolerances: Tolerances) -> Finding:
    """Of 4 sides it draws a square.

    Each of the 4 sides, {side_error_m} m at most longer or
    shorter than asked for, is a part of the points, and each of the 3 corners between them,
    {corner_error_deg} degrees at most off, and an end {closed_m} m at most from the start.
    """
    return _polygon(recordings, 0, tolerances)


@checks(after=("serves",))
def others(recordings: Recordings, tolerances: Tolerances) -> Finding:
    """Of 3 and 6 sides it draws a triangle and a hexagon.

    Judged as the square; each is half of the points.
    """
    return _mean(_polygon(recordings, run, tolerances) for run in (1, 2))


@checks(after=("serves",))
def done(recordings: Recordings, tolerances: Tolerances) -> Finding:
    """It answers once it is drawn.

    Half a second after each answer, the turtle drives no longer.
    """
    return _mean(_done(recordings, run) for run in range(3))


@checks(after=("serves",))
def still(recordings: Recordings, tolerances: Tolerances) -> Finding:
    """Of 2 sides it draws nothing.

    Of 4 sides it draws something.
    """
    path = _path(recordings, 3)
    if _path(recordings, 0).length_m <= STILL_M:
        return Finding(0, msg("Asked for 4 sides, turtle1 stayed where it was, too."), SENDS)
    if path.length_m <= STILL_M:
        return Finding(1, msg("turtle1 stayed where it was."))
    text = msg("Asked for 2 sides, turtle1 drove {way:.2f} m.", way=path.length_m)
    help_ = msg("Look at the request before you drive.")
    return Finding(0, text, help_, (path.evidence(path.first, msg("here it drove off")),))


def _mean(found: Iterable[Finding]) -> Finding:
    """Tell the worst, and give their mean."""
    each = list(found)
    worst = min(each, key=lambda finding: finding.share)
    return replace(worst, share=sum(finding.share for finding in each) / len(each))


def _call(recording: Recording) -> dict[str, Any]:
    calls = CastTrace.of(recording.cast).of_kind("call", id="draw")
    return {key: value for event in calls for key, value in event.items()}


def _path(recordings: Recordings, run: int) -> DrivenPath:
    recording = [*recordings][run]
    way = TurtleTrace.of(recording.trace).trajectory()
    return DrivenPath(recording, way, run).until_lost().begun_at(USUAL_START)


def _done(recordings: Recordings, run: int) -> Finding:
    call, path = _call([*recordings][run]), _path(recordings, run)
    words = {"n": call["request"]["sides"]}
    if "answered_ns" not in call:
        help_ = msg("Does the callback come to its end, and return its response?")
        return Finding(0, msg("Asked for {n} sides, it never answered.", **words), help_)
    if path.length_m <= STILL_M:
        return Finding(0, msg("Asked for {n} sides, it answered and drew nothing.", **words), SENDS)
    row = path.row_at(round((call["answered_ns"] / 1e9 + LATE_S) / path.tick_s))
    if (way := path.length_from(row)) <= STILL_M:
        return Finding(1, msg("The answers came when the way was drawn."))
    text = msg("Asked for {n} sides, it answered, and turtle1 drove {way:.2f} m more.",
               way=way, **words)  # fmt: skip
    return Finding(0, text, msg("Answer when it is drawn."), (path.evidence(row, text),))


def _polygon(recordings: Recordings, run: int, tolerances: Tolerances) -> Finding:
    whole = _path(recordings, run)
    path = whole.between_jumps()
    wanted = _call(whole.recording)["request"]
    count, length = wanted["sides"], wanted["length"]
    words: dict[str, Any] = {"n": count, "length": length}
    if path.length_m <= STILL_M:
        return Finding(0, msg("Asked for {n} sides, turtle1 did not move.", **words), SENDS)
    sides = path.sides(tolerances["corner_size_m"], length / 2)
    turn = 360.0 / count
    turns = [(side, abs(side.turn_deg)) for side in sides[:-1] if side.turn_deg is not None]
    error, slack = tolerances["side_error_m"], tolerances["corner_error_deg"]
    wrong = [side for side in sides if abs(side.length_m - length) > error]
    wrong_turns = [side for side, found in turns if abs(found - turn) > slack]
    gap = float(path.distance_from(path.x[0], path.y[0])[-1])
    is_closed = len(sides) > 2 and gap <= tolerances["closed_m"]
    # corners between sides of another length are those of a polygon that nobody asked for
    are_asked = len(sides) > len(wrong)
    right = len(sides) - len(wrong) + (len(turns) - len(wrong_turns)) * are_asked
    share = (min(right, 2 * count - 1) + is_closed * are_asked) / (2 * max(count, len(sides)))
    text = msg(
        "Asked for {n} sides of {length} m, turtle1 drove sides of {sides} m with corners of "
        "{corners} degrees.",
        **words,
        sides=", ".join(f"{side.length_m:.2f}" for side in sides[:8]),
        corners=", ".join(f"{found:.0f}" for _, found in turns[:8]) or "0",
    )
    if wrong_turns:
        help_ = msg("In each corner it turns by 360 / {n} = {turn:g} degrees.", turn=turn, **words)
        evidence = path.evidence(wrong_turns[0].last, msg("this corner"))
    elif wrong:
        help_ = msg("A side is speed times duration; without commands a turtle stops after 1 s.")
        evidence = path.evidence(wrong[0].last, msg("the side that ends here"))
    else:
        help_ = msg("Does it end where it began?")
        evidence = path.evidence(-1, msg("{gap:.2f} m from where it began", gap=gap))
    return Finding(share, text, help_, (evidence,)) if share < 1 else Finding(1, text)
