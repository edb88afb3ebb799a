"""Whether what checks return is in order, whatever it says: the mistakes that authors make."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from grader.exercise.asking import Answers, NoFinding, NotReached
from grader.exercise.check import judge_by, rounds
from grader.exercise.exercise import Exercise
from grader.exercise.places import describe
from grader.exercise.verdict import Evidence, Finding, Verdict
from grader.language.phrase import say
from grader.recording.recording import Recordings
from grader.scenes import load_scene


class Fault(NamedTuple):
    """Something to mend; `check` is "" where it is none of one check."""

    check: str
    text: str


def examine(exercise: Exercise, recordings: Recordings) -> tuple[list[Verdict], list[Fault]]:
    """The verdicts on recordings, and what is wrong with the checks that made them."""
    faults: list[Fault] = []
    is_whole = True

    def judged(answered: Answers) -> list[Verdict]:
        def watched(name: str) -> Finding:
            nonlocal is_whole
            try:
                finding = answered(name)
            except NoFinding as error:
                text = error.args[0]
                faults.append(
                    Fault(name, say("raises {error}", error=text) if error.was_raised else text)
                )
                return Finding(0, "The check found nothing.")
            except NotReached as hit:
                is_whole = False
                if hit.by == name:
                    faults.append(Fault(name, hit.args[0]))
                return Finding(0, "The check found nothing.")
            odd = list(_odd_about(finding, exercise, recordings))
            faults.extend(Fault(name, text) for text in odd)
            return finding

        return judge_by(watched, exercise.checks, exercise.points)

    def told(_: object, error: BaseException) -> str:
        return describe(error, exercise.folder)

    # both times in the same process, which may remember what it should not
    asked = rounds(recordings, exercise.checks, exercise.points, exercise.tolerances, told, many=2)
    first, second = map(judged, asked)
    for once, again in zip(first, second, strict=True):
        if is_whole and repr(once) != repr(again):  # not a number is none but looks like itself
            text = say("finds something else when it is asked again about the same recordings")
            faults.append(Fault(once.check, text))
    return first, list(dict.fromkeys(faults))


def _odd_about(finding: Finding, exercise: Exercise, recordings: Recordings) -> Iterator[str]:
    if not finding.rationale.strip():
        yield say("has an empty rationale: what was seen?")
    if finding.share < 1 and not finding.help.strip():
        yield say("fails without help: what is there to look at?")
    for item in finding.evidence:
        yield from _odd_about_evidence(item, exercise, recordings)


def _odd_about_evidence(
    item: Evidence, exercise: Exercise, recordings: Recordings
) -> Iterator[str]:
    scene = load_scene(exercise.scene)
    if item.tick > list(recordings)[item.run].run.ticks:
        yield say("evidence: tick {tick} is outside the recording", tick=item.tick)
    elif abs(item.time_s - item.tick * scene.tick_ns / 1e9) > 0.001:
        yield say(
            "evidence: time_s is not that of the tick: {time_s} s at tick {tick}",
            time_s=item.time_s,
            tick=item.tick,
        )
    if not scene.plane.holds(item.x, item.y):
        yield say("evidence: the place ({x}, {y}) is outside the picture", x=item.x, y=item.y)
    if not item.note:
        yield say("evidence: has an empty note")
