"""Rules about connections: publishers, subscriptions and clients that meet no other end.

A rule applies only where it can name what was meant: an endpoint of the scene that has nearly this
name, or this type. A program that has the right end as well tries several, and is not reported.
"""

from __future__ import annotations

import re
from dataclasses import replace
from difflib import SequenceMatcher

from grader.exercise import Diagnosis
from grader.recording import Endpoint
from grader.recording.observations import End, EndKind
from grader.text import NOTHING, Message, msg, shown
from grader_diagnosis import lint_findings, standstill
from grader_diagnosis.case import OPPOSITE, Case, at, diagnosed, of_kind, since
from grader_diagnosis.crash import misses_message

#: So alike two names have to be, 0 to 1, for one to be meant by the other.
_ALIKE = 0.75
_UNTIL_IT_IS_THERE = {
    "client": "while not client.wait_for_service(timeout_sec=1.0): pass",
    "action_client": "client.wait_for_server()",
}
#: A turtle that a program has to spawn.
_TURTLE = re.compile(r"/(turtle(?:[2-9]|\d\d))/")
#: A longer name is nobody's mistake.
_LONGEST_NAME = 100
#: rclpy's warning that the QoS of two ends of a topic is incompatible, from either side.
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
#: Whether it is a publisher, and whether it is known what is too little -> the cause.
_UNFIT_BY = {
    (True, True): msg(
        "Your publisher on {topic}{where} is {sends}, {the_thing} listens {wants}: nothing arrives."
    ),
    (False, True): msg(
        "Your subscription on {topic}{where} asks for {wants}, but it is published {sends}: "
        "nothing reaches you."
    ),
    (True, False): msg(
        "Your publisher on {topic}{where} does not fit the other end's, by its {policy}: "
        "nothing arrives."
    ),
    (False, False): msg(
        "Your subscription on {topic}{where} does not fit the other end's, by its {policy}: "
        "nothing arrives."
    ),
}


def waits_in_vain(case: Case) -> Diagnosis | None:
    """The program waits to the end for a service or an action that nobody offers."""
    for wait in case.observed.waits:
        if wait.lasted_s is not None or "/msg/" in wait.type:
            continue
        there = [e for e in case.all_have if e.kind in ("service", "action")]
        kind: EndKind = "action_client" if "/action/" in wait.type else "client"
        end = End(kind, wait.name, wait.type, False, 0)
        near = nearest(end, case)
        if near is not None and near.name == wait.name:
            if near.type == wait.type:
                continue
            rest = msg(
                " as {type}, but it is of type {wanted}", type=shown(wait.type), wanted=near.type
            )
        elif any(e.name == wait.name for e in there):
            continue
        elif near is not None:
            rest = msg(", which nobody offers; there is {name}", name=near.name)
        else:
            rest = msg(", which nobody offers")
        named = (each.place for each in case.ends if (each.kind, each.name) == (kind, wait.name))
        place = next(named, None) or wait.place  # the line to be fixed is the one with the name
        return diagnosed(
            "waits_in_vain",
            msg("You wait for {what}{since}{rest}{where}."),
            _fix(end, near) if near else msg("Compare the name with `ros2 service list`."),
            place,
            wait.since_s,
            what=_served(kind, wait.name),
            since=since(wait.since_s),
            rest=rest,
        )
    return None


def is_too_early(case: Case) -> Diagnosis | None:
    """The program asks for what comes later only, or has ended by then."""
    begins = {
        (e.name, e.type): e.begin_s for e in case.scene_has if e.kind in ("service", "action")
    }
    ended_s = case.ended_s if case.raised is None else case.raised.time_s
    for wait in case.observed.waits:
        begin_s = begins.get((wait.name, wait.type), 0.0)
        mine = [e for e in case.ends if (e.name, e.type) == (wait.name, wait.type)]
        is_lost = wait.lasted_s is None and any(end.used for end in mine)
        if wait.since_s >= begin_s or not (is_lost or (ended_s or begin_s) < begin_s):
            continue
        place = next((end.used_at for end in mine if end.used), None) or wait.place
        kind: EndKind = "action_client" if "/action/" in wait.type else "client"
        cause = msg(
            "Your program ended{at}{where}, and {what} came at {begin_s:.1f} s only.",
            at=at(ended_s),
        )
        if is_lost:
            cause = msg(
                "You call {what}{where} before it is there, which is at {begin_s:.1f} s: what you "
                "ask is lost."
            )
        return diagnosed(
            "is_too_early",
            cause,
            msg("Wait for it first, as long as it takes: {loop}."),
            place,
            wait.since_s,
            what=_served(kind, wait.name),
            begin_s=begin_s,
            loop=_UNTIL_IT_IS_THERE[kind],
        )
    return None


def publishes_to_nobody(case: Case) -> Diagnosis | None:
    """The program publishes under a name or with a type that the scene does not subscribe to."""
    return _first(
        case,
        "publisher",
        "publishes_to_nobody",
        msg("You publish {type} on {name}, but {the_thing} listens to {wanted} there{where}."),
        msg(
            "You publish {type} on {name}, where nobody listens; {the_thing} listens to "
            "{wanted}{where}."
        ),
    )


def hears_nobody(case: Case) -> Diagnosis | None:
    """The program subscribes under a name or with a type that nobody publishes."""
    return _first(
        case,
        "subscription",
        "hears_nobody",
        msg(
            "You subscribe to {name} as {type}, but {wanted} is published there, so no "
            "message reaches you{where}."
        ),
        msg("You subscribe to {name}, which nobody publishes; there is {wanted}{where}."),
    )


def misses_what_it_hears(case: Case) -> Diagnosis | None:
    """The program crashed for want of a message: nobody sends it, or the program never spins."""
    if not misses_message(case) or case.raised is None:
        return None
    # an attribute that is not there may be set too late, in a program that spins afterwards
    is_spinless = "NoneType" in case.raised.text or any(of_kind(case, "no_spin"))
    return hears_nobody(case) or (standstill.is_deaf(case) if is_spinless else None)


def is_defined_otherwise(case: Case) -> Diagnosis | None:
    """A type of the program's own has the name of one of the exercise's, and other fields."""
    keys: dict[EndKind, str] = {"publisher": "publishes_to_nobody", "subscription": "hears_nobody"}
    for end in case.ends:
        if not end.is_met and (how := case.recording.interfaces.unlike.get(end.type)):
            return diagnosed(
                keys.get(end.kind, "calls_nobody"),
                msg(
                    "Your {type} is not the exercise's, and the two exchange nothing: {how}{where}."
                ),
                msg("Define it as the exercise does, or leave the package out."),
                end.place,
                type=shown(end.type),
                how=how,
            )
    return None


def is_of_another_type(case: Case) -> Diagnosis | None:
    """The program crashed by what it sent: its publisher or client was made for another type."""
    raised = case.raised
    if raised is None or raised.type != "TypeError" or case.run.outcome != "crashed":
        return None
    if raised.place is None or not re.search(r"\.(?:publish|call|call_async)\(", raised.place.text):
        return None
    names = {each.name for each in case.scene_has}
    for found in (publishes_to_nobody(case), calls_nobody(case)):
        if found is not None and any(e.place == found.place and e.name in names for e in case.ends):
            return replace(found, time_s=raised.time_s)
    return None


def calls_nobody(case: Case) -> Diagnosis | None:
    """The program calls a service or an action under a name or with a type that nobody offers."""
    sentences = (
        msg("You call {what} as {type}, but it is {wanted}{where}."),
        msg("You call {what}, which nobody offers; there is {wanted}{where}."),
        msg("You have a client for {what} as {type}, but it is {wanted}{where}."),
        msg("You have a client for {what}, which nobody offers; there is {wanted}{where}."),
    )
    return _first(case, "client", "calls_nobody", *sentences) or _first(
        case, "action_client", "calls_nobody", *sentences
    )


def _first(
    case: Case,
    kind: EndKind,
    key: str,
    other_type: Message,
    other_name: Message,
    unused_of_type: Message = NOTHING,
    unused_of_name: Message = NOTHING,
) -> Diagnosis | None:
    """Diagnose the first end of a kind that meets nobody and is near an endpoint of the scene.

    Args:
        other_type, other_name: the cause where that is the difference.
        unused_of_type, unused_of_name: the same where the end was never used, if that is another.
    """
    for end in case.ends:
        if end.kind != kind:
            continue
        near = nearest(end, case)
        if near is None:
            continue
        if any(e.kind == kind and (e.name, e.type) == near[1:3] for e in case.ends):
            continue  # it has the right one as well
        if end.name != near.name and (end.is_met or _meets_itself(case, end)):
            continue
        if end.kind == "subscription" and end.used:
            continue  # somebody has published
        if end.kind == "publisher" and end.name in case.heard and near not in case.scene_has:
            continue  # as it is asked for: another program has the wrong name
        if end.name == near.name:
            place = lint_findings.imported_at(case, end.type, near.type) or end.place
            cause, of_unused = other_type, unused_of_type
        else:
            place = lint_findings.named_at(case, end.name, end.place)
            cause, of_unused = other_name, unused_of_name
        fix = _fix(end, near)
        if (other := _TURTLE.match(end.name)) and near.name.startswith("/turtle1/"):
            fix = msg("Is {turtle} spawned? Else write '{name}' there.", turtle=other[1],
                      name=near.name)  # fmt: skip
        return diagnosed(
            key,
            cause if end.used else of_unused or cause,
            fix,
            place,
            name=shown(end.name),
            type=shown(end.type),
            what=_served(kind, end.name),
            the_thing=case.whose(near),
            wanted=near.type if end.name == near.name else _near(end, near),
        )
    return None


def has_unfit_qos(case: Case) -> Diagnosis | None:
    """An end of a topic gets no message through, because its QoS does not fit the other end's."""
    for found in _UNFIT.finditer(case.tail):
        kind: EndKind = "publisher" if found["other"] == "subscription" else "subscription"
        topic = f"/{found['topic'].lstrip('~/')}"  # as the program wrote it
        named = (e.name for e in case.ends if e.kind == kind and e.name.endswith(topic))
        topic = next(named, topic)
        others = [e for e in case.all_have if e.kind == OPPOSITE[kind] and e.name == topic]
        if not others:
            continue
        mine = [end for end in case.observed.ends if (end.kind, end.name) == (kind, topic)]
        place = mine[0].place if mine else None
        sends, wants = _TOO_LITTLE.get(found["policy"], ("", ""))
        return diagnosed(
            "has_unfit_qos",
            _UNFIT_BY[kind == "publisher", bool(sends)],
            _fitting(found["policy"], wants if kind == "publisher" else sends),
            place,
            topic=topic,
            policy=found["policy"],
            sends=sends,
            wants=wants,
            the_thing=case.whose(others[0]),
        )
    return None


def _fitting(policy: str, right: str) -> Message:
    """Say what to write for a QoS policy that differs from the other end's."""
    if not right:
        return msg("Write 10 instead of the QoS profile.")
    setting = f"{policy.lower()}={policy.capitalize()}Policy.{right}"
    if right in ("RELIABLE", "VOLATILE"):
        return msg("Write 10 instead of the QoS profile, or {setting} in it.", setting=setting)
    return msg("Give it a QoSProfile with {setting}.", setting=setting)


def nearest(end: End, case: Case) -> Endpoint | None:
    """Return the endpoint that was meant; None where the end is right, or nothing is near."""
    there = [each for each in case.all_have if each.kind == OPPOSITE[end.kind]]
    same = [each for each in there if each.name == end.name]
    if same:
        return None if any(each.type == end.type for each in same) else same[0]
    if len(end.name) > _LONGEST_NAME:
        return None
    there = [each for each in there if each in case.near_misses]
    by_name = [(_likeness(end, each), each) for each in there]
    best = max(by_name, key=lambda found: found[0], default=None)
    if best is not None and best[0] >= _ALIKE:
        return best[1]
    of_type = [each for each in there if each.type == end.type]
    return of_type[0] if of_type and len({_last(e.name) for e in of_type}) == 1 else None


def _likeness(end: End, other: Endpoint) -> float:
    """How alike two names are, from 0 to 2; more than 1 where only their namespaces differ."""
    a, b = end.name.lower(), other.name.lower()
    alike = SequenceMatcher(None, a, b).ratio()
    return 1 + alike if _last(a) == _last(b) else alike


def _last(name: str) -> str:
    return name.rpartition("/")[2]


def _meets_itself(case: Case, end: End) -> bool:
    """Whether the submission has the other end of a topic itself."""
    other = {"publisher": "subscription", "subscription": "publisher"}.get(end.kind)
    return any(each.kind == other and each.name == end.name for each in case.ends)


def _served(kind: EndKind, name: str) -> Message:
    """Name what a client of this kind calls: 'the service /spawn'."""
    if kind == "action_client":
        return msg("the action {name}", name=shown(name))
    return msg("the service {name}", name=shown(name))


def _near(end: End, near: Endpoint) -> str | Message:
    """Name the scene's endpoint, with its type where that differs."""
    if end.type == near.type:
        return near.name
    return msg("{name} of type {type}", name=near.name, type=near.type)


def _fix(end: End, near: Endpoint) -> Message:
    package, kind, name = near.type.split("/")
    imported = f"`from {package}.{kind} import {name}`"
    if near.name == "/tf_static":
        return msg("Send it by a {right}.", right="StaticTransformBroadcaster")
    if end.type == near.type:
        return msg("Write '{name}' there.", name=near.name)
    if end.name == near.name:
        return msg("Make it with {type}: {imported}.", type=name, imported=imported)
    return msg(
        "Write '{name}' there, and make it with {type}: {imported}.",
        name=near.name,
        type=name,
        imported=imported,
    )
