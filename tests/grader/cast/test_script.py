"""Each mistake in a cast is told with its place and what is allowed there."""

from __future__ import annotations

from typing import Any

import pytest
import yaml

from grader.cast import script
from grader.cli import main
from grader.exercise.known_types import KnownTypes, check_cast
from grader.yaml_file import Mistake

STRING, ADD = "std_msgs/msg/String", "example_interfaces/srv/AddTwoInts"
EXERCISE = """exercise: small
title: A small one
scene: graph
cast:
{cast}
limits: {{first_motion_s: 1, rest_s: 0, total_s: 2}}
expect:
{expect}
points: {{it: 1}}
"""


TWIST, SCAN = "geometry_msgs/msg/Twist", "sensor_msgs/msg/LaserScan"
FIBONACCI = "example_interfaces/action/Fibonacci"
#: A peer that says what does not fit -> words of the sentence.
UNFIT = {
    f"calls: {{x: {{service: y, type: {ADD}, request: {{c: 1}}}}}}": "has no field c, only a, b",
    f"calls: {{x: {{service: y, type: {ADD}, request: {{a: 1.5}}}}}}": "a whole number",
    f"calls: {{x: {{service: y, type: {ADD}, at: 60}}}}": "60 s is after the end of a run",
    f"services: {{x: {{type: {ADD}, response: {{sum: '=a + c'}}}}}}": "no value c here",
    f"services: {{x: {{type: {ADD}, response: 'ok'}}}}": "a whole number",
    f"publishers: {{x: {{type: {STRING}, rate: 1, message: {{dat: x}}}}}}": "has no field dat",
    f"publishers: {{x: {{type: {STRING}, rate: 1, messages: [a, {{data: 2}}]}}}}": "a text",
    f"publishers: {{x: {{type: {TWIST}, rate: 1, message: {{linear: {{w: 1}}}}}}}}": "no field w",
    f"publishers: {{x: {{type: {TWIST}, rate: 1, message: {{linear: 1}}}}}}": "fields with values",
    f"publishers: {{x: {{type: {TWIST}, rate: 1, message: 1}}}}": "values of linear, angular",
    f"publishers: {{x: {{type: {SCAN}, rate: 1, message: {{ranges: 1}}}}}}": "expected a list",
    f"goals: {{x: {{action: y, type: {FIBONACCI}, goal: {{orders: 1}}}}}}": "has no field orders",
}


def parsed(cast: str) -> dict[str, script.Peer]:
    return script.parse(yaml.safe_load(cast))


MISTAKES = {
    # keys that lead there, and words of the sentence -> the cast
    ("cast", "names of nodes"): "[a, b]",
    ("cast", "at most 20 nodes"): str({f"n{n}": {} for n in range(21)}),
    ("cast: 1", "name of a node"): "1: {}",
    ("cast: a b", "name of a node"): "a b: {}",
    ("cast: a", "publishers, subscriptions, services"): "a: {publishes: {}}",
    ("cast: a: calls", "at most 100"): "a: {calls: {}}",
    ("cast: a: publishers", "each with what it is"): "a: {publishers: [x]}",
    ("cast: a: publishers: x", "object of type, topic, rate"): "a: {publishers: {x: {rat: 1}}}",
    ("cast: a: publishers: x", "rate: expected a number"): (
        f"a: {{publishers: {{x: {{type: {STRING}, rate: often}}}}}}"
    ),
    ("cast: a: publishers: x", "0 to 62.5 times"): (
        f"a: {{publishers: {{x: {{type: {STRING}, rate: 1.0e+9}}}}}}"
    ),
    ("cast: a: publishers: x", "begin: expected 0 or more"): (
        f"a: {{publishers: {{x: {{type: {STRING}, rate: 1, begin: .nan}}}}}}"
    ),
    (
        "cast: a: publishers: x",
        "`rate`, how often",
    ): f"a: {{publishers: {{x: {{type: {STRING}}}}}}}",
    ("cast: a: publishers: x: type", "such as std_msgs/msg/String"): (
        f"a: {{publishers: {{x: {{type: {ADD}, rate: 1}}}}}}"
    ),
    ("cast: a: services: x: type", "such as example_interfaces/srv"): (
        f"a: {{services: {{x: {{type: {STRING}}}}}}}"
    ),
    ("cast: a: subscriptions: x: type", "list of some"): "a: {subscriptions: {x: {type: []}}}",
    ("cast: a: subscriptions: 1x: topic", "such as chatter"): (
        f"a: {{subscriptions: {{1x: {{type: {STRING}}}}}}}"
    ),
    ("cast: a: subscriptions: /cast/events: topic", "such as chatter"): (
        f"a: {{subscriptions: {{/cast/events: {{type: {STRING}}}}}}}"
    ),
    ("cast: a: subscriptions: x", "reliability: expected one of reliable, best_effort"): (
        f"a: {{subscriptions: {{x: {{type: {STRING}, qos: {{reliability: best}}}}}}}}"
    ),
    ("cast: a: publishers: x: message", "no value m here, only n, t"): (
        f'a: {{publishers: {{x: {{type: {STRING}, rate: 1, message: "{{m}}"}}}}}}'
    ),
    ("cast: a: publishers: x: messages", "`import os` is no expression"): (
        f'a: {{publishers: {{x: {{type: {STRING}, rate: 1, messages: ["=import os"]}}}}}}'
    ),
    ("cast: a: publishers: x: message", "division by zero"): (
        f'a: {{publishers: {{x: {{type: {STRING}, rate: 1, message: {{data: "=1/0"}}}}}}}}'
    ),
    ("cast: a: services: x: response", "`lambda: a` is not allowed"): (
        f'a: {{services: {{x: {{type: {ADD}, response: {{sum: "=lambda: a"}}}}}}}}'
    ),
    ("cast: a: calls: x: request", "no value a here, only t"): (
        f'a: {{calls: {{x: {{service: y, type: {ADD}, request: {{a: "=a"}}}}}}}}'
    ),
    ("cast: a: parameters: x", "expected `set` or `get`"): "a: {parameters: {x: {node: n}}}",
    ("cast: a: parameters: x: set: p", "a list of some of one kind"): (
        "a: {parameters: {x: {node: n, set: {p: [1, a]}}}}"
    ),
    ("cast: a: parameters: x: set: q", "a list of some of one kind"): (
        "a: {parameters: {x: {node: n, set: {q: 9223372036854775808}}}}"
    ),
    ("cast: a: frames: x", "list of 3"): (
        "a: {frames: {x: {parent: p, child: c, translation: [1, 2]}}}"
    ),
}


@pytest.mark.parametrize(("keys", "words"), MISTAKES)
def test_a_mistake_in_a_cast_names_its_place_and_what_is_allowed(keys, words):
    with pytest.raises(Mistake) as caught:
        parsed(MISTAKES[keys, words])
    said = str(caught.value)
    assert said.startswith(f"{keys}: ")
    assert words in said


def test_a_peer_may_have_nothing_and_names_are_its_topics():
    assert parsed("a:") == {"a": script.Peer()}
    (entry,) = parsed(f"a: {{publishers: {{x: {{type: {STRING}, rate: 2}}}}}}")[
        "a"
    ].publishers.values()
    assert (entry.topic, entry.types) == ("x", (STRING,))


@pytest.mark.parametrize(
    ("rate", "begin", "count", "times"),
    [(2, 0, 100, [0.5, 1.0, 1.5, 2.0]), (1, 0.25, 100, [0.25, 1.25]), (4, 1, 2, [1.0, 1.25])],
)
def test_a_publisher_begins_after_its_period_or_when_it_is_told(rate, begin, count, times):
    made = script.PeerPublisher(type=STRING, rate=rate, begin=begin, count=count)
    assert made.times(2.0) == times


def test_a_publisher_may_be_told_when_and_says_nothing_after_the_end():
    assert script.PeerPublisher(type=STRING, at=(3.0, 1.0, 9.0)).times(5.0) == [1.0, 3.0]


CAST = f"  a: {{calls: {{x: {{service: y, type: {ADD}}}}}}}"
#: What is wrong in a whole file -> its line, and words of the sentence.
FILES = {
    ("  a: {calls: {x: {service: y}}}", "  it: {node: n}"): (5, "object of type, service"),
    (CAST, "  it: {node: n, nod: 1}"): (8, "object of title, rubric"),
    (CAST, "  it: {topic: t, holds: len(messages) > 3}"): (8, "an expression such as"),
    (CAST, "  it: {topic: t, values: {at_least: a}}"): (8, "a number or an expression"),
    (CAST, "  it: {topic: t, values: [{x: {at_most: [1]}}]}"): (8, "a number or an expression"),
    (CAST.replace("AddTwoInts", "AddTwoInt"), "  it: {node: n}"): (5, "it has example_interfaces"),
    (CAST, "  it: {nod: n}"): (8, "one of node, topic"),
    (CAST, "  it: {call: z}"): (8, "among its calls, x; found 'z'"),
    (CAST, "  it: {goal: x}"): (8, "among its goals, none; found 'x'"),
    (CAST, "  it: {topic: t, rate: {hz: 0}}"): (8, "above 0"),
    (CAST, '  it: {topic: t, values: "=m"}'): (8, "no value m here, only heard, message, n, t"),
    (CAST, '  it: {log: "{n}"}'): (8, "no value n here, only none"),
    (CAST, '  it: {log: "/(/"}'): (8, "/(/ is no pattern"),
    (CAST, "  it: {log: a, level: loud}"): (8, "one of , debug, info, warn"),
    (CAST, "  it: {topic: t, qos: {depth: -1}}"): (8, "0 or more"),
    (CAST, "  it: {call: x, response: {sum: '=1 << 2'}}"): (8, "`1 << 2` is not allowed"),
    (CAST, "  it: {node: n, after: [other]}"): (8, "no check above is named other"),
    (CAST, "  it: {node: my node}"): (8, "a name such as chatter, found 'my node'"),
    (CAST, "  it: {topic: t, type: std_msgs/String}"): (8, "such as std_msgs/msg/String"),
    (CAST, "  it: {topic: t, type: std_msgs/msg/Text}"): (8, "std_msgs has no std_msgs/msg/Text"),
    (CAST, "  it: {topic: t, count: {at_least: 3, at_most: 2}}"): (8, "at_least is 3, more than"),
    (CAST, "  it: {topic: t, begin: 60}"): (8, "60 s is after the end of a run"),
    (CAST, "  it: {topic: t, begin: 1, end: 0.5}"): (8, "0.5 s is before `begin`, 1 s"),
    (CAST, "  it: {served: y}"): (8, "among its services, none; found 'y'"),
    (CAST, "  it: {got: t, by: a}"): (8, "among its subscriptions, none; found 't'"),
    (CAST, "  it: {got: t, by: b}"): (8, "a node of the cast, a; found 'b'"),
    (CAST, "  it: {log: x, heard: t}"): (8, "among its publishers, none; found 't'"),
    (CAST, "  it: {topic: t, values: '=heard[\"/u\"][-1].data'}"): (
        8,
        "nobody hears '/u' here, only",
    ),
    (CAST, "  it: {call: x, response: {total: 3}}"): (8, "has no field total, only sum"),
    (CAST, "  it: {call: x, response: {sum: three}}"): (8, "a number, since it is a int64"),
    (CAST, "  it: {call: x, response: {sum: '=a + c'}}"): (
        8,
        "no value c here, only a, b, request",
    ),
}


@pytest.mark.parametrize("peer", UNFIT)
def test_what_a_peer_says_has_to_fit_its_type_and_the_run(peer):
    with pytest.raises(Mistake) as caught:
        check_cast(parsed(f"a: {{{peer}}}"), KnownTypes({}), 20, ("cast",))
    assert UNFIT[peer] in str(caught.value)


@pytest.mark.parametrize(
    ("cast", "expects", "verb"),
    [*((*file, "run") for file in FILES), (*next(iter(FILES)), "check-exercise")],
)
def test_a_mistake_in_a_file_is_told_with_its_line_and_ends_with_2(
    cast, expects, verb, tmp_path, capsys
):
    line, words = FILES[cast, expects]
    path = tmp_path / "small"
    path.mkdir()
    (path / "exercise.yaml").write_text(EXERCISE.format(cast=cast, expect=expects))
    (tmp_path / "node.py").write_text("import rclpy\n")
    said: list[Any] = [verb, str(tmp_path / "node.py"), "--exercise", str(path)]
    code = main(said if verb == "run" else [verb, str(path)])
    captured = capsys.readouterr()
    assert code == 2
    assert f"exercise.yaml, line {line}: " in captured.out + captured.err
    assert words in " ".join((captured.out + captured.err).split())
