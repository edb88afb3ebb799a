"""Rules about what rclpy and Python have warned of in the output: the program went on, in vain."""

from __future__ import annotations

import re
from pathlib import PurePath

from grader.diagnosis import printed
from grader.diagnosis.case import OPPOSITE, Case, line, told
from grader.diagnosis.diagnosis import Diagnosis
from grader.language.phrase import say
from grader.recording.conduct import EndKind, Place

#: rclpy's warning that two ends of a topic do not fit, from either side.
_UNFIT = re.compile(
    r"New (?P<other>subscription|publisher) discovered on topic '(?P<topic>[\w/~]{1,256})', "
    r"(?:requesting|offering) incompatible QoS\.[^\n]{0,100}"
    r"Last incompatible policy: (?P<policy>\w{1,40})"
)
#: A policy -> what the publisher has of it, and what the subscription has that this is too little
#: for.
_TOO_LITTLE = {
    "RELIABILITY": ("BEST_EFFORT", "RELIABLE"),
    "DURABILITY": ("VOLATILE", "TRANSIENT_LOCAL"),
}
_NEVER_AWAITED = re.compile(
    r"^(?P<file>[^\n:]{1,1000}):(?P<line>\d{1,9}): RuntimeWarning: "
    r"coroutine '(?P<name>[\w.<>]{1,200})' was never awaited(?:\n  (?P<text>[^\n]{1,300}))?",
    re.MULTILINE,
)


def has_unfit_qos(case: Case) -> Diagnosis | None:
    """An end of a topic that nothing goes through, for its QoS does not fit the other's."""
    for found in _UNFIT.finditer(printed.end(case.recording.output)):
        kind: EndKind = "publisher" if found["other"] == "subscription" else "subscription"
        topic = found["topic"]
        if not any(e.kind == OPPOSITE[kind] and e.name == topic for e in case.scene_has):
            continue
        mine = [end for end in case.conduct.ends if (end.kind, end.name) == (kind, topic)]
        place = mine[0].place if mine else None
        return Diagnosis(
            "has_unfit_qos",
            _unfit(case, kind, topic, found["policy"], line(place)),
            say("Write 10 instead of the QoS profile."),
            place=place,
        )
    return None


def _unfit(case: Case, kind: EndKind, topic: str, policy: str, where: str) -> str:
    """In what a publisher or subscription and the other end differ."""
    sends, wants = _TOO_LITTLE.get(policy, ("", ""))
    words = {"topic": topic, "where": where, "sends": sends, "wants": wants, "policy": policy}
    if kind == "publisher" and sends:
        return say(
            "Your publisher on {topic}{where} is {sends}, {the_thing} listens {wants}: nothing "
            "arrives.",
            the_thing=case.the_thing,
            **words,
        )
    if sends:
        return say(
            "Your subscription on {topic}{where} asks for {wants}, but it is published {sends}: "
            "nothing reaches you.",
            **words,
        )
    if kind == "publisher":
        return say(
            "Your publisher on {topic}{where} does not fit the other end's, by its {policy}: "
            "nothing arrives.",
            **words,
        )
    return say(
        "Your subscription on {topic}{where} does not fit the other end's, by its {policy}: "
        "nothing arrives.",
        **words,
    )


def never_awaits(case: Case) -> Diagnosis | None:
    """It calls an `async def` like any function: nothing of it is ever run."""
    for found in _NEVER_AWAITED.finditer(printed.end(case.recording.output)):
        if printed.is_library(found["file"]):
            continue
        text = (found["text"] or "").strip()
        place = Place(PurePath(found["file"]).name, int(found["line"]), "", text)
        name = told(found["name"].rpartition(".")[2])
        return Diagnosis(
            "never_awaits",
            say(
                "An `async def` that nobody awaits was called{where}: nothing of {name}() was run.",
                where=line(place),
                name=name,
            ),
            say(
                "Make it a plain `def {name}`: call_async(request) in it sends the "
                "request, and you go on without waiting for the answer.",
                name=name,
            ),
            place=place,
        )
    return None
