"""Judges expectations by what was exchanged in a run.

Each looks for what is missing or wrong first, and says with numbers what came, when, and what was
expected. A part of the points is earned where the main thing is right and only how is not: the
rate, the quality of service, a line that was printed instead of logged.
"""

from __future__ import annotations

import re
import statistics
from bisect import bisect_left
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from itertools import pairwise, zip_longest
from typing import Any, Final

from grader.exercise.cases import USUAL
from grader.exercise.comparing import LONGEST_MATCHED, differences, shown
from grader.exercise.expect import expectations as e
from grader.exercise.verdict import Evidence, Finding
from grader.recording.recording import Drawn, Recording, Recordings
from grader.ros.fields import field_lines
from grader.scenes.cast.script import absolute
from grader.scenes.cast.trace import ROSOUT, TRANSIENT_LOCAL, CastTrace, Event, SentMessage
from grader.scenes.scene import STEP_NS
from grader.system.expressions import MOST_STEPS, ExpressionError, filled, looked_up
from grader.text.message import Message, joined, msg
from grader.text.strings import listed, nearest

#: What to do where nothing better is known.
COMPARE: Final = msg("Compare it with what the exercise asks for.")
#: What a line shows that was logged instead of a value -> what to do.
_OBJECTS: Final = (
    (re.compile(r"\w\.msg\.\w+\("), msg("That is the whole message: log its field, as msg.data.")),
    (re.compile(r"<rclpy\.parameter"), msg("Log its value: self.get_parameter('NAME').value.")),
)
#: Ends the output of a program that has shut ROS down itself, and then went on spinning.
_SHUT_DOWN: Final = "rclpy.executors.ExternalShutdownException"
#: What is earned where the main thing is right.
PART: Final = 0.5
#: An expression over all messages of a topic may take so many steps: some seconds.
STEPS_FOR_ALL: Final = 2_000_000
#: In real time, how much later something may be, and how much longer all messages may take [s].
REAL_LATE_S, REAL_LONGER_S = 1.0, 0.3
_DURABILITY: Final = {TRANSIENT_LOCAL: "transient_local", 2: "volatile"}
_RELIABILITY: Final = {1: "reliable", 2: "best_effort"}
_LEVELS: Final = {"debug": 10, "info": 20, "warn": 30, "error": 40, "fatal": 50}
INF: Final = float("inf")
#: So many lines are compared with one that is missing; so many characters of a name are shown.
SEARCHED, LONGEST_NAME = 100, 200
#: Of a service that every node has.
_EVERY_NODE: Final = ("parameter", "get_type_description", "_action/")


class Lacks(Exception):
    """Something is not as expected.

    Attributes:
        finding: for the verdict.
    """

    def __init__(
        self, text: Message, help_: Message = COMPARE, time_ns: int | None = None, share: float = 0
    ) -> None:
        super().__init__(str(text))
        seen = () if time_ns is None else (Evidence(time_ns / 1e9, text, tick=time_ns // STEP_NS),)
        self.finding = Finding(share, text, help_, seen)


def judge(of_run: Callable[[Drawn], e.Expectation], recordings: Recordings) -> Finding:
    """Judge an expectation by each case in which it is expected; the worst counts.

    Args:
        of_run: returns what is expected in a run for which these values were drawn.
    """
    worst: Finding | None = None
    for number, recording in enumerate(recordings):
        case, expectation = recording.run.case or USUAL, of_run(recording.run.drawn)
        if not expectation.cases or case in expectation.cases:
            found = _in_case(_judged(expectation, recording), recording.run.case, number)
            if worst is None or found.share < worst.share:
                worst = found
    return worst or Finding(0.0, msg("No case was run in which that is expected."))


def _in_case(found: Finding, case: str, number: int) -> Finding:
    """Say in which case something was not as expected."""
    if not case or found.share == 1.0:
        return found
    seen = tuple(replace(each, run=number) for each in found.evidence)
    text = msg("In the case {case}: {what}", case=case, what=found.rationale)
    return replace(found, rationale=text, evidence=seen)


def _judged(expectation: e.Expectation, recording: Recording) -> Finding:
    trace = CastTrace.of(recording.cast or recording.trace)
    within = getattr(expectation, "within", None)
    if recording.run.time == "real" and within is not None:  # others have the processor, too
        expectation = replace(expectation, **{"within": within + REAL_LATE_S})
    try:
        if not isinstance(expectation, (e.ExpectedNode, e.ExpectedExit)):
            _expect_all(trace, recording.interfaces.texts)
        passed = _JUDGES[type(expectation)](trace, expectation, recording)
    except Lacks as lack:
        if expectation.help:
            return Finding(
                *(lack.finding.share, lack.finding.rationale, msg("{help}", help=expectation.help)),
                lack.finding.evidence,
            )
        return lack.finding
    if recording.run.time == "real" and getattr(expectation, "heard", None):
        more = msg("In real time nobody can tell more than that your program had a subscription.")
        passed = joined([passed, more], " ")
    return Finding(1.0, passed)


class PeerFault(Exception):
    """A peer could not say what the exercise has it say, which is no fault of the program's."""

    def __init__(self, event: Event) -> None:
        why = event["why"] if isinstance(event["why"], str) else str(Message.parse(event["why"]))
        what = f"{event['what']} at {event['time_ns'] / 1e9:.2f} s: {why}"
        super().__init__(f"{event['peer']} cannot say what the exercise asks of it, {what}")


def _expect_all(trace: CastTrace, theirs: Mapping[str, str]) -> None:
    """Expect that all was said, but in types of `theirs`, and recorded: anything may follow."""
    types = {name.rpartition("/")[2] for name in theirs}
    for event in trace.of_kind("unsaid"):
        if event["what"].partition("_")[0] not in types:
            raise PeerFault(event)
    for event in trace.of_kind("full"):
        raise Lacks(
            msg("Your program sent so much that nothing after {time} s was recorded.",
                time=_seconds(event["time_ns"])),
            msg("Does a loop publish, log or call without a pause?"),
            event["time_ns"],
        )  # fmt: skip


def _filled(
    template: Any, names: Mapping[str, Any], time_ns: int, most_steps: int = MOST_STEPS
) -> Any:
    """Fill in what is expected; what the program has sent may make that impossible."""
    try:
        return filled(template, names, has_patterns=True, most_steps=most_steps)
    except ExpressionError as error:
        raise Lacks(
            msg("What should have come then cannot be told: {why}.", why=error.message),
            msg("Look at what was sent before."),
            time_ns,
        ) from None


def _compare(
    what: Message, found: Any, expected: Any, tolerance: float | None, time_ns: int
) -> None:
    for path, value, right in differences(found, expected, tolerance):
        field = msg("{field} was", field=path) if path else msg("it was")
        values = {"what": what, "field": field, "value": shown(value), "right": right}
        raise Lacks(msg("{what}: {field} {value}, expected {right}.", **values), COMPARE, time_ns)


def _seconds(time_ns: int) -> str:
    return f"{time_ns / 1e9:.2f}"


# Nodes, topics, logs --------------------------------------------------------------------------


def _node(trace: CastTrace, wanted: e.ExpectedNode, _: Recording) -> Message:
    name = absolute(wanted.node)
    nodes = _nodes(trace)
    is_full = wanted.node.startswith("/")  # else it may be in any namespace
    if not any(node == name or (not is_full and node.endswith(name)) for node in nodes):
        raise Lacks(
            msg(
                "There is no node {name}; there is {nodes}.",
                name=name,
                nodes=listed(nodes) or msg("none"),
            ),
            msg("The name is what Node's __init__ gets."),
        )
    return msg("There is a node {name}.", name=name)


def _nodes(trace: CastTrace) -> list[str]:
    return sorted({event["node"] for event in trace.of_kind("endpoint")} - {"/"})


def _endpoints(trace: CastTrace, kind: str, *, writes: bool) -> list[Event]:
    return [
        event
        for event in trace.of_kind("endpoint", writes=writes)
        if event["channel"].startswith(f"{kind} ")
        and not any(part in event["channel"] for part in ("/rosout", *_EVERY_NODE))
    ]


def _named(events: Sequence[Event]) -> list[str]:
    return sorted({event["channel"].partition(" ")[2] for event in events})


def _no_such(name: str, events: Sequence[Event], none: Message, some: Message) -> Lacks:
    """Say that there is nothing of a name, and what there is instead."""
    names = _named(events)
    if near := nearest(name, names):
        help_ = msg("Compare the name: yours is {near}.", near=near[0])
    else:
        help_ = msg("Look at the name, and whether your program gets there.")
    if not names:
        return Lacks(none.given(name=name), help_)
    return Lacks(some.given(name=name, names=listed(names)), help_)


def _of_type(name: str, found: str, right: str, call: str) -> Lacks:
    return Lacks(
        msg("{name} has the type {found}, expected {type}.", name=name, found=found, type=right),
        msg("Look at what {call} gets.", call=call),
    )


def _since_heard(trace: CastTrace, topic: str) -> int:
    """Return since when the program has a subscription of a topic, of the type that it has [ns]."""
    readers = trace.readers(topic)
    if not readers:
        raise _no_such(
            topic,
            _endpoints(trace, "topic", writes=False),
            msg("Nothing subscribes to {name}, nor to any other topic."),
            msg("Nothing subscribes to {name}, only to {names}."),
        )
    kinds = {message.type for message in trace.messages if message.topic == topic}
    fit = [event["time_ns"] for event in readers if not kinds or event["type"] in kinds]
    if not fit:
        raise _of_type(topic, readers[0]["type"], min(kinds), "create_subscription")
    return int(min(fit))


def _expect_heard(trace: CastTrace, template: Any) -> None:
    """Expect subscriptions of what peers say and a template asks for."""
    for topic in sorted(looked_up(template, "heard") & trace.topics_of_peers):
        _since_heard(trace, topic)


def _topic(trace: CastTrace, wanted: e.ExpectedTopic, recording: Recording) -> Message:
    topic = absolute(wanted.topic)
    longer_s = REAL_LONGER_S if recording.run.time == "real" else 0.0
    writers = _endpoints(trace, "topic", writes=True)
    own = [event for event in writers if event["channel"] == f"topic {topic}"]
    if not own:
        raise _no_such(
            topic,
            writers,
            msg("Nothing publishes on {name}, nor on any other topic."),
            msg("Nothing publishes on {name}, only on {names}."),
        )
    kinds = sorted({event["type"] for event in own})
    if wanted.type and wanted.type not in kinds:
        raise _of_type(topic, kinds[0], wanted.type, "create_publisher")
    messages = [m for m in trace.sent(topic) if wanted.begin <= m.time_ns / 1e9 <= wanted.end]
    if wanted.heard:
        since_ns = _since_heard(trace, absolute(wanted.heard))
        messages = [each for each in messages if each.time_ns >= since_ns]
    _expect_heard(trace, wanted.values)
    if 2 < len(messages) < wanted.count.at_least:
        _expect_rate(trace, wanted, topic, messages, longer_s, 0.0)
    _expect_count(wanted.count, len(messages), msg("messages on {topic}", topic=topic))
    share = 0.0
    if wanted.values is not None:
        _expect_values(trace, wanted, topic, messages)
        share = PART
    if wanted.holds:
        all_ = [trace.values(each) for each in messages]
        last_ns = messages[-1].time_ns if messages else 0
        if not _filled(wanted.holds, {"messages": all_}, last_ns, STEPS_FOR_ALL):
            text = msg("Of the {n} messages on {topic} this does not hold: {what}.",
                       n=len(all_), topic=topic, what=wanted.holds[1:].strip())  # fmt: skip
            raise Lacks(text)
    _expect_rate(trace, wanted, topic, messages, longer_s, share)
    _expect_quality(wanted.qos, topic, own, share)
    values = {"n": len(messages), "topic": topic}
    return msg("{n} messages came on {topic}, as expected.", **values)


def _expect_count(wanted: e.ExpectedCount, found: int, what: Message) -> None:
    if not wanted.at_least <= found <= wanted.at_most:
        right = wanted.at_least if found < wanted.at_least else wanted.at_most
        text = msg("{found} {what} came, expected at least {right}.")
        if found > wanted.at_most:
            text = msg("{found} {what} came, expected at most {right}.")
        raise Lacks(text.given(found=found, what=what, right=right))


def _expect_values(
    trace: CastTrace, wanted: e.ExpectedTopic, topic: str, messages: Sequence[SentMessage]
) -> None:
    places = {id(message): place for place, message in enumerate(trace.messages)}
    heard = _Heard(trace)
    for n, message in enumerate(messages):
        values = trace.values(message)
        heard.until(places[id(message)])
        names = {"n": n, "t": message.time_ns / 1e9, "heard": heard.by_topic, "message": values}
        expected = _filled(wanted.values, names, message.time_ns)
        what = msg(
            "Message {n} on {topic}, at {time} s",
            n=n, topic=topic, time=_seconds(message.time_ns),
        )  # fmt: skip
        _compare(what, values, expected, wanted.tolerance, message.time_ns)


class _Heard:
    """What can have been heard before some message.

    Of a topic on which peers publish it is what they have sent: else a program could say itself
    what it is to answer.

    Attributes:
        by_topic: the values of messages, by their topic.
    """

    def __init__(self, trace: CastTrace) -> None:
        self.by_topic: dict[str, list[Any]] = {}
        self._trace, self._next = trace, 0

    def until(self, place: int) -> None:
        """Add the messages before this place among all."""
        for each in self._trace.messages[self._next : place]:
            is_heard = each.topic not in self._trace.topics_of_peers or (
                self._trace.is_peer(each) and self._trace.is_heard(each)
            )
            if each.topic != ROSOUT and is_heard:
                self.by_topic.setdefault(each.topic, []).append(self._trace.values(each))
        self._next = max(self._next, place)


def _expect_rate(
    trace: CastTrace,
    wanted: e.ExpectedTopic,
    topic: str,
    messages: Sequence[SentMessage],
    longer_s: float,
    share: float,
) -> None:
    """Expect messages so often, evenly, and to the end."""
    if wanted.rate is None:
        return
    times_s = [each.time_ns / 1e9 for each in messages]
    gaps = [b - a for a, b in pairwise(times_s)]
    right_s, worst = 1 / wanted.rate.hz, max(gaps, default=0.0)
    found_s = statistics.fmean(gaps) if gaps else 0.0
    end_s = min(wanted.end, trace.duration_ns / 1e9)
    values = {"topic": topic, "worst": worst, "right": wanted.rate.hz}
    help_, at_ns = msg("Look at the period of the timer, in seconds."), None
    slack_s = wanted.rate.tolerance * right_s + longer_s / max(len(gaps), 1)
    is_off = abs(found_s - right_s) > slack_s
    usual_s = statistics.median(gaps) if gaps else 0.0
    if gaps and usual_s < min(right_s, found_s) / 2:
        text = msg("{topic} came several times at once, with pauses of {worst:.2f} s; expected "
                   "{right:g} times a second, one by one.")  # fmt: skip
    elif not gaps or is_off or worst > 2 * right_s:
        text = msg(
            "{topic} came {hz} times a second, with a longest pause of {worst:.2f} s; expected "
            "{right:g} times a second.",
            hz=f"{1 / found_s:.2f}" if found_s else "0",
        )
        at_ns = messages[gaps.index(worst)].time_ns if gaps else None
    elif len(messages) < wanted.count.at_most and end_s - times_s[-1] > 2 * right_s:
        text = msg("{topic} came no more after {last:.2f} s; expected {right:g} times a second, to "
                   "the end at {end:g} s.", last=times_s[-1], end=end_s)  # fmt: skip
        help_, at_ns = msg("What keeps your node from sending on?"), messages[-1].time_ns
    else:
        return
    raise Lacks(text.given(**values), help_, at_ns, share)


def _expect_quality(
    wanted: e.ExpectedQuality, topic: str, own: Sequence[Event], share: float
) -> None:
    help_ = msg("Look at the QoSProfile of the publisher.")
    for event in own:
        offered = {
            "reliability": _RELIABILITY.get(event["reliability"], "?"),
            "durability": _DURABILITY.get(event["durability"], "?"),
            "depth": event["depth"] or wanted.depth,  # 0: DDS does not tell it
        }
        for name, found in offered.items():
            right = getattr(wanted, name)
            if right and found != right:
                values = {"topic": topic, "name": name, "found": found, "right": right}
                text = msg("{topic} has the {name} {found}, expected {right}.", **values)
                raise Lacks(text, help_, None, share)


def _got(trace: CastTrace, wanted: e.ExpectedReceipt, _: Recording) -> Message:
    peer, topic = absolute(wanted.by), absolute(wanted.got)
    found = trace.of_kind("got", peer=peer, topic=topic)
    _expect_count(
        wanted.count, len(found), msg("messages on {topic} for {peer}", topic=topic, peer=peer)
    )
    return msg("{peer} got {n} messages on {topic}.", peer=peer, n=len(found), topic=topic)


class _Log:
    """The lines that the program has logged, by time.

    Args:
        heard: a topic: of several programs those count that hear it.
    """

    def __init__(self, trace: CastTrace, level: str, heard: str = "") -> None:
        self.lines: list[tuple[int, str]] = []
        self._by_text: dict[str, list[int]] = {}
        programs = {node: {*names.split(", ")} for node, names in trace.programs.items()}
        hearing = [programs.get(each["node"], set()) for each in trace.readers(heard)]
        known = [node for node, names in programs.items() if any(names & each for each in hearing)]
        for sent in trace.sent(ROSOUT):
            values = trace.values(sent)
            logger = f"/{values['name'].replace('.', '/')}/"
            if programs and heard and not any(logger.startswith(f"{node}/") for node in known):
                continue
            if not level or values["level"] == _LEVELS[level]:
                self.lines.append((sent.time_ns, values["msg"]))
                self._by_text.setdefault(values["msg"], []).append(sent.time_ns)

    def times(self, text: str | re.Pattern[str], begin_ns: float, end_ns: float) -> list[int]:
        """Return when there was such a line, of those in a stretch of time."""
        if isinstance(text, str):
            found = self._by_text.get(text, [])
            return found[bisect_left(found, begin_ns) : bisect_left(found, end_ns + 1)]
        near = bisect_left(self.lines, (begin_ns, "")), bisect_left(self.lines, (end_ns + 1, ""))
        lines = self.lines[slice(*near)]
        return [at for at, line in lines if not list(differences(line, text))]


def _log(trace: CastTrace, wanted: e.ExpectedLog, recording: Recording) -> Message:
    heard = absolute(wanted.heard) if wanted.heard else ""
    log = _Log(trace, wanted.level, heard)
    if not wanted.each and not wanted.heard:
        texts = _filled((wanted.log, *wanted.also), {}, 0)
        said = [_line(trace, wanted, log, text, recording) for text in texts]
        return joined(said, " ")
    topic = heard or absolute(wanted.each)
    sent = trace.sent(topic, by_peers=heard in trace.topics_of_peers)
    if heard:
        _since_heard(trace, topic)
        sent = [each for each in sent if trace.is_heard(each)]
    known = [(each.time_ns, trace.values(each)) for each in sent]
    if not known:
        raise Lacks(msg("Nothing came on {topic} that could be logged.", topic=topic))
    within_ns = round(wanted.within * 1e9)
    missing: list[tuple[int | None, str | re.Pattern[str]]] = []
    for n, (time_ns, values) in enumerate(known):
        text = _filled(wanted.log, {**values, "n": n, "message": values}, time_ns)
        is_over = time_ns <= trace.duration_ns - within_ns
        if is_over and not log.times(text, time_ns - within_ns, time_ns + within_ns):
            missing.append((time_ns, text))
    if missing:
        raise _not_logged(missing, log, trace, wanted, recording)
    _expect_count(wanted.count, len(known), msg("messages on {topic}", topic=topic))
    return msg("{n} lines were logged, one for each message.", n=len(known))


def _line(
    trace: CastTrace, wanted: e.ExpectedLog, log: _Log, text: Any, recording: Recording
) -> Message:
    """Expect one of the lines that are not asked for each message."""
    found = log.times(text, 0, trace.duration_ns + STEP_NS)
    if 0 < len(found) < wanted.count.at_least:
        raise Lacks(
            msg("{text} was logged {found} times, expected at least {right}; the last line was "
                "{last}.", text=shown(text), found=len(found), right=wanted.count.at_least,
                last=shown(log.lines[-1][1])),
            msg("What keeps your node from logging it again?"),
        )  # fmt: skip
    if len(found) < wanted.count.at_least:
        raise _not_logged([(None, text)], log, trace, wanted, recording)
    _expect_count(wanted.count, len(found), msg("such lines"))
    return msg("A line like {text} was logged.", "{n} lines like {text} were logged.",
               n=len(found), text=shown(text))  # fmt: skip


def _not_logged(
    missing: Sequence[tuple[int | None, str | re.Pattern[str]]],
    log: _Log,
    trace: CastTrace,
    wanted: e.ExpectedLog,
    recording: Recording,
) -> Lacks:
    """Say which line is missing first; what is half right has to be so for each."""
    time_ns, text = missing[0]
    of_all = _Log(trace, wanted.level) if wanted.heard else log
    if all(of_all.times(e, 0, INF) and not log.times(e, 0, INF) for _, e in missing):
        said = msg("{text} was logged, by a program that does not hear {topic}.")
        help_ = msg("Log it in the callback of the subscription.")
        return Lacks(said.given(text=shown(text), topic=wanted.heard), help_, time_ns)
    of_any_level = _Log(trace, "")
    is_elsewhere = [bool(of_any_level.times(each, 0, INF)) for _, each in missing]
    if wanted.level and all(is_elsewhere):
        return Lacks(
            msg("{text} was logged, but not as {level}.", text=shown(text), level=wanted.level),
            msg("Log it with self.get_logger().{level}(...).", level=wanted.level),
            time_ns,
            PART,
        )
    if not any(is_elsewhere) and all(_is_printed(each, recording.output) for _, each in missing):
        return Lacks(
            msg("{text} was printed and not logged.", text=shown(text)),
            msg("Log it with self.get_logger().info(...)."),
            time_ns,
            PART,
        )
    lines = [line for _, line in log.lines]
    if time_ns is not None and (found := log.times(text, 0, INF)):
        nearest_ns = min(found, key=lambda each: abs(each - time_ns))
        said = msg("{text} was logged at {at} s, for what came at {time} s.", text=shown(text),
                   at=_seconds(nearest_ns), time=_seconds(time_ns))  # fmt: skip
        return Lacks(said, msg("Log it when that comes, or goes."), time_ns)
    help_ = msg("Does your program get to where it logs that?")
    if near := [] if isinstance(text, re.Pattern) else nearest(text, lines[-SEARCHED:]):
        said = msg("{text} was not logged; there is {near}.", text=shown(text), near=shown(near[0]))
        help_ = msg("Compare the text letter by letter.")
    elif lines:
        last = shown(lines[-1])
        said = msg("{text} was not logged; the last line was {last}.", text=shown(text), last=last)
    else:
        said = msg("{text} was not logged; nothing was.", text=shown(text))
    line = next(iter([*near, *lines[-1:]]), "")
    help_ = next((advice for sign, advice in _OBJECTS if sign.search(line)), help_)
    for event in trace.of_kind("parameter") if near else ():
        if event.get("set") and "answered_ns" in event:
            help_ = msg("{name} was set from outside at {time} s: is it read each time?",
                        name=", ".join(event["set"]),
                        time=_seconds(event["answered_ns"]))  # fmt: skip
    if recording.run.exit_code is not None:
        for event in trace.of_kind("action", accepted=True):
            if "ended_ns" not in event:
                help_ = msg("Your program ended before the result came: let it spin until then.")
    return Lacks(said, help_, time_ns)


def _is_printed(text: str | re.Pattern[str], output: str) -> bool:
    """Whether a line of the output has a text."""
    if isinstance(text, str):
        return text in output
    return any(text.search(line[:LONGEST_MATCHED]) for line in output.splitlines())


# Services, actions, parameters ----------------------------------------------------------------


def _only(trace: CastTrace, kind: str, key: str) -> Event:
    """Return what a peer did under an id."""
    for event in trace.of_kind(kind, id=key):
        return event
    raise Lacks(msg("Nothing was recorded of {name}.", name=key))


def _expect_answers(trace: CastTrace, peer: str, right: Any = None, sent: Any = ()) -> None:
    """Expect that a peer could use what the program `sent`; not its fault where that is `right`."""
    for event in (*trace.of_kind("refused", peer=peer), *trace.of_kind("unsaid", peer=peer)):
        if right and not any(next(differences(each, right), None) for each in sent):
            raise PeerFault(event)
        is_ours = not isinstance(event["why"], str)
        why = Message.parse(event["why"]) if is_ours else shown(event["why"])
        raise Lacks(
            msg("{peer} could not use what came from your program: {why}.", peer=peer, why=why),
            msg("Look at the types and the values of what it sends and serves."),
            event["time_ns"],
        )


def _call(trace: CastTrace, wanted: e.ExpectedAnswer, _: Recording) -> Message:
    event = _only(trace, "call", wanted.call)
    service = event["service"]
    if "sent_ns" not in event:
        _expect_answers(trace, event["peer"])
        raise no_service(trace, service, event["type"])
    if "response" not in event:
        raise Lacks(
            msg("{service} was called at {time} s and never answered.",
                service=service, time=_seconds(event["sent_ns"])),
            msg("Does the node spin, and does the callback return its response?"),
            event["sent_ns"],
        )  # fmt: skip
    names = {**event["request"], "request": event["request"]}
    right = _filled(wanted.response, names, event["sent_ns"])
    what = msg("The answer of {service} to {request}",
               service=service, request=shown(event["request"]))  # fmt: skip
    _compare(what, event["response"], right, wanted.tolerance, event["answered_ns"])
    took_s = (event["answered_ns"] - event["sent_ns"]) / 1e9
    if took_s > wanted.within:
        raise Lacks(
            msg("The answer took {took:.2f} s, expected at most {right:g}.",
                took=took_s, right=wanted.within),
            COMPARE, event["answered_ns"], PART,
        )  # fmt: skip
    return msg("{service} answered as expected.", service=service)


def no_service(trace: CastTrace, service: str, kind: str) -> Lacks:
    """Say why a service of this name and type could not be called."""
    servers = _endpoints(trace, "request", writes=False)
    own = [event["type"] for event in servers if event["channel"] == f"request {service}"]
    if own:
        return _of_type(service, own[0], kind, "create_service")
    return _no_such(
        service,
        servers,
        msg("Nothing serves {name}, nor any other service."),
        msg("Nothing serves {name}, only {names}."),
    )


def _served(trace: CastTrace, wanted: e.ExpectedRequest, _: Recording) -> Message:
    service = absolute(wanted.served)
    events = trace.of_kind("served", service=service)
    if not events:
        clients = _endpoints(trace, "request", writes=True)
        raise _no_such(
            service,
            [c for c in clients if c["channel"] != f"request {service}"],
            msg("{name} was never called."),
            msg("{name} was never called; the program has clients of {names}."),
        )
    first = events[0]
    what = msg("The request to {service} at {time} s",
               service=service, time=_seconds(first["time_ns"]))  # fmt: skip
    right = _filled(wanted.request, {}, first["time_ns"])
    _compare(what, first["request"], right, wanted.tolerance, first["time_ns"])
    _expect_answers(trace, first["peer"], right, [each["request"] for each in events])
    _expect_count(wanted.count, len(events), msg("calls of {service}", service=service))
    return msg("{service} was called as expected.", service=service)


def _goal(trace: CastTrace, wanted: e.ExpectedOutcome, _: Recording) -> Message:
    event = _only(trace, "goal", wanted.goal)
    action = event["action"]
    if "sent_ns" not in event:
        _expect_answers(trace, event["peer"])
        servers = [
            {**each, "channel": each["channel"].replace("/_action/send_goal", "")}
            for each in trace.of_kind("endpoint", writes=False)
            if each["channel"].endswith("/_action/send_goal")
        ]
        raise _no_such(
            action,
            servers,
            msg("Nothing serves the action {name}, nor any other."),
            msg("Nothing serves the action {name} of that type, only {names}."),
        )
    sent_ns = event["sent_ns"]
    if event.get("accepted") is not wanted.accepted:
        right = msg("accepted") if wanted.accepted else msg("refused")
        found = msg("accepted") if event.get("accepted") else msg("refused")
        help_ = msg("What a goal_callback returns says so: GoalResponse.ACCEPT or REJECT.")
        if "accepted" not in event:
            found, help_ = msg("not answered"), msg("Does the node spin?")
        raise Lacks(
            msg("The goal {goal} was {found}, expected that it is {right}.",
                goal=shown(event["goal"]), found=found, right=right),
            help_, sent_ns,
        )  # fmt: skip
    names = {**event["goal"], "goal": event["goal"]}
    is_to_end = wanted.result is not None or wanted.status or wanted.feedback is not None
    if is_to_end and "ended_ns" not in event and wanted.accepted:
        raise Lacks(
            msg("The goal {goal} was accepted and never ended.", goal=shown(event["goal"])),
            msg("Does the callback of the goal return a result?"),
            sent_ns,
        )
    ended_ns = event.get("ended_ns", sent_ns)
    if wanted.result is not None:
        right_result = _filled(wanted.result, names, ended_ns)
        what = msg("The result of {goal}", goal=shown(event["goal"]))
        _compare(what, event.get("result"), right_result, wanted.tolerance, ended_ns)
    if wanted.feedback is not None:
        expected = _filled(wanted.feedback, names, ended_ns)
        what = msg("The feedback to {goal}", goal=shown(event["goal"]))
        found_feedback = [values for _, values in event["feedback"]]
        if len(found_feedback) != len(expected):
            raise Lacks(
                msg("Feedback to {goal} came {n} times, expected {right}.",
                    goal=shown(event["goal"]), n=len(found_feedback), right=len(expected)),
                msg("goal_handle.publish_feedback(...) sends it: how often is it reached?"),
                ended_ns,
            )  # fmt: skip
        _compare(what, found_feedback, expected, wanted.tolerance, ended_ns)
    if wanted.status and event.get("status") != wanted.status:
        raise Lacks(
            msg("The goal ended as {found}, expected {right}.",
                found=event.get("status", "?"), right=wanted.status),
            msg("goal_handle.succeed(), canceled() or abort() say how."),
            ended_ns, PART if wanted.result is not None else 0,
        )  # fmt: skip
    return msg("The goal {goal} went as expected.", goal=shown(event["goal"]))


def _sends(trace: CastTrace, wanted: e.ExpectedGoal, _: Recording) -> Message:
    action = absolute(wanted.sends)
    events = trace.of_kind("action", action=action)
    if not events:
        raise Lacks(
            msg("The action {action} got no goal.", action=action),
            msg("Look at the action's name, and whether the client waits for its server."),
        )
    what = msg("The goal for {action}", action=action)
    right = _filled(wanted.values, {}, events[0]["time_ns"])
    _compare(what, events[0]["goal"], right, None, events[0]["time_ns"])
    _expect_answers(trace, events[0]["peer"], right, [each["goal"] for each in events])
    return msg("The action {action} got its goal.", action=action)


def _parameter(trace: CastTrace, wanted: e.ExpectedParameters, _: Recording) -> Message:
    event = _only(trace, "parameter", wanted.parameter)
    if "answered_ns" not in event:
        nodes = _nodes(trace)
        raise Lacks(
            msg("The parameters of {node} could not be asked for; there is {nodes}.",
                node=event["node"], nodes=listed(nodes) or msg("no node")),
            msg("Does a node of this name spin?"),
        )  # fmt: skip
    for name, is_taken in wanted.set.items():
        why = event.get("set", {}).get(name, "-")
        if (why == "") is not is_taken:
            text = msg("The parameter {name} was taken, expected that it is refused.")
            if is_taken:
                text = msg("The parameter {name} was refused: {why}.")
            raise Lacks(
                text.given(name=name, why=shown(why)),
                msg("Is it declared, with a default of that type?"),
                event["answered_ns"],
            )
    for name in wanted.values if isinstance(wanted.values, Mapping) else ():
        if event.get("values", {}).get(name) is None:
            raise Lacks(
                msg("The node {node} has no parameter {name}.", node=event["node"], name=name),
                msg("declare_parameter('{name}', VALUE) makes it: compare the name.", name=name),
                event["answered_ns"],
            )
    what = msg("The parameters of {node} at {time} s",
               node=event["node"], time=_seconds(event["answered_ns"]))  # fmt: skip
    right = _filled(wanted.values, {}, event["answered_ns"])
    _compare(what, event.get("values", {}), right, None, event["answered_ns"])
    return msg("The parameters of {node} are as expected.", node=event["node"])


# Transforms, the end --------------------------------------------------------------------------


def _transform(trace: CastTrace, wanted: e.ExpectedTransform, _: Recording) -> Message:
    topic = "/tf_static" if wanted.is_static else "/tf"
    found = trace.transforms(topic)
    own = [
        (time_ns, each)
        for time_ns, each in found
        if each["child_frame_id"] == wanted.transform
        and each["header"]["frame_id"] == wanted.parent
    ]
    names = {"parent": wanted.parent, "child": wanted.transform, "topic": topic}
    if not own:
        other = "/tf" if wanted.is_static else "/tf_static"
        for time_ns, each in trace.transforms(other):
            if each["child_frame_id"] == wanted.transform:
                right = "StaticTransformBroadcaster" if wanted.is_static else "TransformBroadcaster"
                raise Lacks(
                    msg("The transform to {child} came on {other}, expected on {topic}.",
                        **names, other=other),
                    msg("Send it by a {right}.", right=right),
                    time_ns,
                )  # fmt: skip
        frames = sorted(
            {f"{t['header']['frame_id']} to {t['child_frame_id']}"[:LONGEST_NAME] for _, t in found}
        )
        raise Lacks(
            msg("There is no transform from {parent} to {child} on {topic}; there is {frames}.",
                **names, frames=listed(frames) or msg("none")),
            msg("header.frame_id is the parent, child_frame_id the child."),
        )  # fmt: skip
    _expect_heard(trace, [wanted.translation, wanted.rotation])
    _expect_count(wanted.count, len(own), msg("transforms from {parent} to {child}", **names))
    heard, times = _Heard(trace), [each.time_ns for each in trace.messages]
    for time_ns, each in own:
        heard.until(bisect_left(times, time_ns + 1))
        known = {"t": time_ns / 1e9, "heard": heard.by_topic}
        for part, template in (("translation", wanted.translation), ("rotation", wanted.rotation)):
            if template is not None:
                right = _filled(template, known, time_ns)
                what = msg("The {part} from {parent} to {child} at {time} s",
                           part=part, **names, time=_seconds(time_ns))  # fmt: skip
                value = each["transform"][part]
                opposite = {axis: -number for axis, number in value.items()}
                if part == "rotation" and not list(differences(opposite, right, wanted.tolerance)):
                    continue  # the same rotation
                _compare(what, value, right, wanted.tolerance, time_ns)
    return msg("{n} transforms from {parent} to {child} were right.", n=len(own), **names)


def _interface(_: CastTrace, wanted: e.ExpectedInterface, recording: Recording) -> Message:
    own, name = recording.interfaces, wanted.interface
    if fault := own.faults.get(name):
        raise Lacks(msg("{name} is not generated: {why}", name=name, why=fault))
    if name not in own.texts:
        text = msg("There is no {name} in what you handed in; there is {names}.")
        raise Lacks(text.given(name=name, names=listed(sorted(own.texts)) or msg("none")))
    both = own.texts[name], wanted.definition
    for found, right in zip_longest(*map(field_lines, both), fillvalue="-"):
        if found != right:
            raise Lacks(
                msg("{name} has `{found}`, expected `{right}`.",
                    name=name, found=found[:LONGEST_NAME], right=right),
            )  # fmt: skip
    return msg("{name} is as expected.", name=name)


def _exits(trace: CastTrace, wanted: e.ExpectedExit, recording: Recording) -> Message:
    found = recording.run.exit_code
    if found is None:
        raise Lacks(
            msg("The program still ran after {time} s.", time=_seconds(trace.duration_ns)),
            msg("It is to end once it has what it asked for."),
        )
    is_shut_down = found == 1 and recording.output.rstrip().endswith(_SHUT_DOWN)
    if found != wanted.exits and not is_shut_down:
        raise Lacks(
            msg("The program ended with the exit code {found}, expected {right}.",
                found=found, right=wanted.exits)
        )  # fmt: skip
    return msg("The program ended by itself.")


_JUDGES: Final[Mapping[type, Callable[[CastTrace, Any, Recording], Message]]] = {
    e.ExpectedNode: _node,
    e.ExpectedInterface: _interface,
    e.ExpectedTopic: _topic,
    e.ExpectedLog: _log,
    e.ExpectedReceipt: _got,
    e.ExpectedAnswer: _call,
    e.ExpectedRequest: _served,
    e.ExpectedOutcome: _goal,
    e.ExpectedGoal: _sends,
    e.ExpectedParameters: _parameter,
    e.ExpectedTransform: _transform,
    e.ExpectedExit: _exits,
}
