"""What was exchanged is judged: what is right passes, what is not is told, and parts are fair."""

from __future__ import annotations

from typing import Any

import pytest

from grader.exercise import asking
from grader.exercise.cases import RunCase
from grader.exercise.check import Checks, judge
from grader.exercise.expect.checks import add_checks
from grader.exercise.expect.judging import LISTED
from grader.exercise.known_types import KnownTypes
from grader.exercise.verdict import Finding
from grader.limited import WorkLimits
from grader.recording.recording import Recording, Recordings
from tests.grader.exercise.expect.traces import (
    endpoint,
    event,
    judged,
    line,
    number,
    text,
    trace,
    transform,
)

TALKS = endpoint("topic /chatter")
FIVE = [text(0.5 * n + 0.5, "/chatter", f"Hello {n}") for n in range(5)]


def fails(found: Finding, words: str, share: float = 0.0) -> None:
    """Check that something is missing, that it is told, and what is earned."""
    assert words in str(found.rationale)
    assert found.share == share


# Nodes and topics -----------------------------------------------------------------------------


def test_a_node_is_known_by_its_name() -> None:
    assert judged({"node": "node"}, TALKS).share == 1
    fails(judged({"node": "talker"}, TALKS), "There is no node /talker; there is /node.")
    fails(judged({"node": "talker"}), "there is none")


def test_a_topic_needs_messages() -> None:
    assert judged({"topic": "chatter"}, TALKS, *FIVE).share == 1
    fails(judged({"topic": "chatter"}, TALKS), "0 messages on /chatter came, expected at least 1")
    few = {"topic": "chatter", "count": {"at_most": 3}}
    fails(judged(few, TALKS, *FIVE), "5 messages on /chatter came, expected at most 3")


def test_messages_before_the_begin_do_not_count() -> None:
    late = {"topic": "chatter", "begin": 2, "count": {"at_least": 3}}
    fails(judged(late, TALKS, *FIVE), "2 messages")


def test_a_topic_that_is_not_there_is_told_with_what_is() -> None:
    found = judged({"topic": "chater"}, TALKS, *FIVE)
    fails(found, "Nothing publishes on /chater, only on /chatter.")
    assert "yours is /chatter" in str(found.help)
    fails(judged({"topic": "chatter"}), "nor on any other topic")


def test_of_very_many_names_a_few_are_told() -> None:
    many = [endpoint(f"topic /{'n' * 300}{n}") for n in range(5_000)]
    said = str(judged({"topic": "chatter"}, *many).rationale)
    assert f"{5_000 - LISTED:,} more" in said
    assert len(said) < 4_000


def test_a_topic_of_another_type_is_told() -> None:
    wanted = {"topic": "chatter", "type": "std_msgs/msg/Float64"}
    fails(
        judged(wanted, TALKS, *FIVE),
        "has the type std_msgs/msg/String, expected std_msgs/msg/Float64",
    )


def test_values_may_depend_on_number_time_and_what_was_heard() -> None:
    assert judged({"topic": "chatter", "values": "Hello {n}"}, TALKS, *FIVE).share == 1
    found = judged({"topic": "chatter", "values": "Hello {n + 1}"}, TALKS, *FIVE)
    fails(found, "Message 0 on /chatter, at 0.50 s: data was 'Hello 0', expected 'Hello 1'.")
    assert found.evidence[0].time_s == 0.5
    assert judged({"topic": "chatter", "values": "/^Hello [0-9]$/"}, TALKS, *FIVE).share == 1


def test_a_value_may_be_the_mean_of_what_was_heard() -> None:
    data = [number(n, "/data", n, node="/peer") for n in range(1, 6)]
    mean = {"topic": "mean", "values": "=mean([each.data for each in heard['/data'][-3:]])"}
    talks = endpoint("topic /mean", "std_msgs/msg/Float64")
    assert judged(mean, talks, *data, number(5.5, "/mean", 4.0)).share == 1
    fails(judged(mean, talks, *data, number(5.5, "/mean", 3.0)), "data was 3, expected 4")
    # nothing came yet: a finding, and no failure of the exercise
    fails(judged(mean, talks, *data, number(0.5, "/mean", 3.0)), "cannot be told")


def test_what_a_program_says_itself_is_not_what_it_has_heard_of_peers() -> None:
    mean = {"topic": "mean", "values": "=heard['/data'][-1].data"}
    talks = endpoint("topic /mean", "std_msgs/msg/Float64")
    heard, own = number(1, "/data", 7, node="/peer"), number(2, "/data", 0)
    assert judged(mean, talks, heard, own, number(3, "/mean", 7)).share == 1
    assert judged(mean, talks, heard, own, number(3, "/mean", 0)).share == 0
    # where no peer publishes, the program's other node does
    assert judged(mean, talks, own, number(3, "/mean", 0)).share == 1


@pytest.mark.parametrize(
    ("values", "sends"),
    [
        *(("=1 / heard['/in'][-1].data", 0.0), ("=sqrt(heard['/in'][-1].data)", -1.0)),
        *(("=int(heard['/in'][-1].data)", float("nan")), ("=exp(heard['/in'][-1].data)", 1e9)),
        *(("=2 ** heard['/in'][-1].data", 1e9), ("=range(int(heard['/in'][-1].data))", 2.0**63)),
        ("=heard['/in'][-1].data.x", 1.0),
    ],
)
def test_what_a_program_sends_makes_an_expression_fail_and_not_the_grader(
    values: str, sends: float
) -> None:
    talks = endpoint("topic /out", "std_msgs/msg/Float64")
    wanted = {"topic": "out", "values": values}
    fails(judged(wanted, talks, number(1, "/in", sends), number(2, "/out", 1)), "cannot be told")


def test_a_text_between_strokes_that_a_program_sends_is_no_pattern() -> None:
    wanted = {"topic": "out", "values": "=heard['/in'][-1].data"}
    talks = endpoint("topic /out")
    for sent in ("/.*/", "/(/", "/(a+)+$/"):
        assert judged(wanted, talks, text(1, "/in", sent), text(2, "/out", "aaa")).share == 0
        assert judged(wanted, talks, text(1, "/in", sent), text(2, "/out", sent)).share == 1


# Rates and quality: what earns a part ---------------------------------------------------------

RATE = {"topic": "chatter", "rate": {"hz": 2, "tolerance": 0.05}}


def test_a_rate_is_right_within_its_tolerance_and_without_pauses() -> None:
    assert judged(RATE, TALKS, *FIVE, length_s=3).share == 1
    paused = [*FIVE, text(9.9, "/chatter", "")]
    fails(judged(RATE, TALKS, *paused), "a longest pause of 7.40 s; expected 2 times a second")


@pytest.mark.parametrize("period_s", [1.0, 0.25, 0.4, 0.01])
def test_half_a_rate_is_not_half_of_the_points(period_s: float) -> None:
    other = [text(period_s * n, "/chatter", f"Hello {n}") for n in range(1, 6)]
    fails(judged(RATE, TALKS, *other), f"came {1 / period_s:.2f} times a second")
    # where the values count as well, they are right
    fails(judged({**RATE, "values": "Hello {n + 1}"}, TALKS, *other), "times a second", 0.5)
    assert judged({**RATE, "values": "Hello"}, TALKS, *other).share == 0


@pytest.mark.parametrize("hz", [25.0, 50.0, 100.0])
def test_a_rate_is_the_mean_of_all_periods(hz: float) -> None:
    wanted = {"topic": "chatter", "rate": {"hz": hz, "tolerance": 0.02}}
    uneven = [text((n + 0.4 * (n % 2)) / hz, "/chatter", "") for n in range(100)]
    assert judged(wanted, TALKS, *uneven, length_s=100 / hz).share == 1
    slower = [text(n / (0.97 * hz), "/chatter", "") for n in range(100)]
    fails(judged(wanted, TALKS, *slower, length_s=100 / hz), f"came {0.97 * hz:.2f} times")


def test_messages_that_come_together_have_not_the_rate_of_their_mean() -> None:
    pairs = [text(n // 2 * 1.0, "/chatter", "") for n in range(20)]
    fails(judged(RATE, TALKS, *pairs), "several times at once, with pauses of 1.00 s")


def test_a_rate_lasts_to_the_end_or_to_the_last_message_that_is_expected() -> None:
    words = "came no more after 2.50 s; expected 2 times a second, to the end at 10 s"
    fails(judged(RATE, TALKS, *FIVE), words)
    assert judged({**RATE, "end": 3}, TALKS, *FIVE).share == 1
    assert judged({**RATE, "count": {"at_most": 5}}, TALKS, *FIVE).share == 1


def test_one_message_has_no_rate() -> None:
    fails(judged(RATE, TALKS, FIVE[0]), "came 0 times a second")


def test_a_wrong_rate_is_told_before_the_count_that_it_makes() -> None:
    wanted = {**RATE, "count": {"at_least": 8}}
    slow = [text(n, "/chatter", "Hello") for n in range(1, 6)]
    fails(judged(wanted, TALKS, *slow), "/chatter came 1.00 times a second")
    few = judged(wanted, TALKS, *FIVE, length_s=3)
    fails(few, "5 messages on /chatter came, expected at least 8")


@pytest.mark.parametrize(
    ("qos", "words"),
    [
        ({"reliability": "best_effort"}, "has the reliability reliable, expected best_effort"),
        ({"durability": "transient_local"}, "has the durability volatile, expected transient"),
        ({"depth": 1}, "has the depth 10, expected 1"),
    ],
)
def test_quality_that_is_not_as_expected_is_told(qos: dict[str, Any], words: str) -> None:
    fails(judged({"topic": "chatter", "qos": qos}, TALKS, *FIVE), words)
    wanted = {"topic": "chatter", "qos": qos, "values": "Hello {n}"}
    fails(judged(wanted, TALKS, *FIVE), words, 0.5)


def test_quality_of_any_kind_passes_and_of_the_right_one() -> None:
    assert judged({"topic": "chatter", "qos": {"depth": 10}}, TALKS, *FIVE).share == 1


def test_what_a_late_peer_gets_is_counted() -> None:
    wanted = {"got": "chatter", "by": "peer", "count": {"at_most": 1}}
    one = event("got", topic="/chatter", values={})
    assert judged(wanted, one).share == 1
    fails(judged(wanted), "0 messages on /chatter for /peer came, expected at least 1")
    fails(judged(wanted, one, one), "expected at most 1")


# Lines ----------------------------------------------------------------------------------------


def test_a_line_is_logged_so_many_times() -> None:
    assert judged({"log": "Hi"}, line(1, "Hi")).share == 1
    assert judged({"log": "/H.$/"}, line(1, "Hi")).share == 1
    fails(judged({"log": "Hi"}), "'Hi' was not logged; nothing was.")
    fails(judged({"log": "Hi"}, line(1, "Ho!")), "the last line was 'Ho!'")
    fails(judged({"log": "Hello"}, line(1, "Hallo")), "there is 'Hallo'")
    few = judged({"log": "Hi", "count": {"at_least": 2}}, line(1, "Hi"), line(2, "Ho"))
    fails(few, "'Hi' was logged 1 times, expected at least 2; the last line was 'Ho'.")
    fails(judged({"log": "Hi", "count": {"at_most": 1}}, line(1, "Hi"), line(2, "Hi")), "at most 1")


@pytest.mark.parametrize(
    ("said", "more", "help_"),
    [
        ("Hi std_msgs.msg.String(data='you')", (), "log its field"),
        ("Hi <rclpy.parameter.Parameter object at 0x7f>", (), "self.get_parameter('NAME').value"),
        ("Hi you", (), "letter by letter"),
        (
            "Hi me!",
            (event("parameter", id="a", node="/node", set={"who": ""}, answered_ns=2 * 10**9),),
            "who was set from outside at 2.00 s",
        ),
        ("Accepted.", (event("action", action="/a", accepted=True),), "before the result came"),
    ],
)
def test_a_line_that_is_missing_is_told_with_what_may_be_wrong(
    said: str, more: Any, help_: str
) -> None:
    assert help_ in str(judged({"log": "Hi you!"}, line(1, said), *more).help)


EACH = {"log": 'Publishing: "{data}"', "each": "chatter"}
LOGGED = [line(0.5 * n + 0.5, f'Publishing: "Hello {n}"') for n in range(5)]


def test_each_message_has_its_line_in_time() -> None:
    assert judged(EACH, *FIVE, *LOGGED).share == 1
    fails(judged(EACH, *FIVE, *LOGGED[:4]), "'Publishing: \"Hello 4\"' was not logged")
    late = [*LOGGED[:4], line(9, 'Publishing: "Hello 4"')]
    fails(judged(EACH, *FIVE, *late), "was not logged")


def test_no_message_is_no_line() -> None:
    fails(judged(EACH, *LOGGED), "Nothing came on /chatter that could be logged.")


def test_what_peers_send_is_logged_by_who_hears_it() -> None:
    heard = [each._replace(node="/peer") for each in FIVE]
    wanted = {"log": 'Publishing: "{data}"', "heard": "chatter"}
    assert judged(wanted, *heard, *LOGGED).share == 1
    fails(judged(wanted, *heard, *LOGGED[1:]), "was not logged")


def test_a_print_of_the_same_text_earns_half() -> None:
    printed = "".join(f'Publishing: "Hello {n}"\n' for n in range(5))
    found = judged(EACH, *FIVE, output=printed)
    fails(found, "was printed and not logged", 0.5)
    assert "get_logger().info" in str(found.help)
    fails(judged({"log": "/H.$/"}, output="x\nHi\n"), "/H.$/ was printed and not logged", 0.5)


def test_a_print_of_one_line_for_all_earns_nothing() -> None:
    assert judged(EACH, *FIVE, output='Publishing: "Hello 0"\n').share == 0
    assert judged(EACH, *FIVE, *LOGGED[:2], output='Publishing: "Hello 2"\n').share == 0


def test_a_line_of_another_level_earns_half() -> None:
    found = judged({"log": "Hi", "level": "info"}, line(1, "Hi", level=30), output="[WARN] Hi")
    fails(found, "'Hi' was logged, but not as info.", 0.5)
    assert judged({"log": "Hi", "level": "warn"}, line(1, "Hi", level=30)).share == 1


def test_very_many_lines_and_very_long_ones_are_judged_at_once() -> None:
    messages = [text(1, "/chatter", f"{n}" * 20) for n in range(3_000)]
    lines = [line(1, f"I said {n}" * 20) for n in range(3_000)]
    assert judged({"log": "I say {data}", "each": "chatter"}, *messages, *lines).share == 0
    long = [text(1, "/chatter", "ab" * 500_000), line(1, "ba" * 500_000)]
    assert judged({"log": "{data}", "each": "chatter"}, *long).share == 0


def test_a_pattern_does_not_search_a_text_without_end() -> None:
    lines = [line(1, "a" * 1_000_000 + "!") for _ in range(9)]
    assert judged({"log": "/.*a.*a.*b$/"}, *lines).share == 0


# Services, actions, parameters ----------------------------------------------------------------

CALL = {"call": "adds", "response": {"sum": "=a + b"}}
ASKED = {"id": "adds", "service": "/add", "type": "example_interfaces/srv/AddTwoInts"}
SENT = {**ASKED, "request": {"a": 2, "b": 3}, "sent_ns": 10**9}


def test_an_answer_is_compared_with_what_the_request_makes_it() -> None:
    right = event("call", **SENT, response={"sum": 5}, answered_ns=10**9)
    assert judged(CALL, right).share == 1
    wrong = event("call", **SENT, response={"sum": 6}, answered_ns=10**9)
    fails(judged(CALL, wrong), "The answer of /add to {'a': 2, 'b': 3}: sum was 6, expected 5.")
    late = event("call", **SENT, response={"sum": 5}, answered_ns=3 * 10**9)
    fails(judged(CALL, late), "The answer took 2.00 s, expected at most 1.", 0.5)


def test_a_type_with_other_fields_is_told() -> None:
    refused = event("refused", what="x", why="AddTwoInts_Request has no field a, only x")
    fails(judged(CALL, event("call", **ASKED), refused), "has no field a, only x")
    fails(
        judged(GOAL, event("goal", **{**ASKED, "id": "counts", "action": "/fib"}), refused),
        "no field a",
    )


def test_a_call_without_an_answer_is_told_with_the_reason() -> None:
    fails(judged(CALL, event("call", **SENT)), "/add was called at 1.00 s and never answered")
    fails(judged(CALL, event("call", **ASKED)), "Nothing serves /add, nor any other service.")
    other = endpoint("request /ad", ASKED["type"], writes=False)
    fails(judged(CALL, event("call", **ASKED), other), "Nothing serves /add, only /ad.")
    trigger = endpoint("request /add", "std_srvs/srv/Trigger", writes=False)
    fails(judged(CALL, event("call", **ASKED), trigger), "has the type std_srvs/srv/Trigger")


@pytest.mark.parametrize(
    "expected",
    [CALL, {"goal": "adds"}, {"parameter": "adds"}, {"served": "add"}, {"sends": "add"},
     {"topic": "t"}, {"log": "a"}, {"got": "t", "by": "peer"}, {"node": "n"}, EACH,
     {"transform": "a", "parent": "b"}],
)  # fmt: skip
def test_an_empty_recording_fails_and_breaks_nothing(expected: dict[str, Any]) -> None:
    assert judged(expected).share == 0


def test_a_request_to_a_peer_is_compared() -> None:
    wanted = {"served": "add", "request": {"a": 2, "b": 3}, "count": {"at_most": 1}}
    right = event("served", service="/add", request={"a": 2, "b": 3})
    assert judged(wanted, right).share == 1
    fails(
        judged(wanted, event("served", service="/add", request={"a": 3, "b": 3})),
        "a was 3, expected 2",
    )
    fails(judged(wanted, right, right), "2 calls of /add came, expected at most 1")
    fails(judged(wanted), "/add was never called.")
    other = endpoint("request /ad", ASKED["type"])
    fails(judged(wanted, other), "the program has clients of /ad")


@pytest.mark.parametrize("expected", [{"served": "add"}, {"sends": "add"}])
def test_what_a_peer_cannot_answer_is_told_as_what_the_program_has_sent(
    expected: dict[str, Any],
) -> None:
    asked = [
        event("served", service="/add", request={"a": 0}),
        event("action", action="/add", goal={}),
    ]
    refused = event("refused", what="=1 / a", why="division by zero")
    assert judged(expected, *asked).share == 1
    fails(
        judged(expected, *asked, refused),
        "/peer could not use what came from your program: 'division",
    )


GOAL = {"goal": "counts", "result": [0, 1], "feedback": [[0], [0, 1]], "status": "succeeded"}
HANDLED = {
    **{"id": "counts", "action": "/fib", "type": "t", "goal": {"order": 2}, "sent_ns": 10**9},
    **{"accepted": True, "feedback": [[10**9, {"sequence": [0]}], [10**9, {"sequence": [0, 1]}]]},
    **{"status": "succeeded", "result": {"sequence": [0, 1]}, "ended_ns": 2 * 10**9},
}


def goal(*without: str, **values: Any) -> Any:
    return event("goal", **{k: v for k, v in HANDLED.items() if k not in without}, **values)


def test_a_goal_is_judged_by_answer_feedback_result_and_status() -> None:
    assert judged(GOAL, goal()).share == 1
    none = goal("sent_ns", "accepted", "feedback", "status", "result", "ended_ns")
    fails(judged(GOAL, none), "Nothing serves the action /fib, nor any other.")
    other = endpoint("request /fibo/_action/send_goal", "t", writes=False)
    fails(judged(GOAL, none, other), "only /fibo")
    fails(
        judged(GOAL, goal("accepted", "ended_ns")), "was not answered, expected that it is accepted"
    )
    fails(
        judged(GOAL, goal("accepted", accepted=False)), "was refused, expected that it is accepted"
    )
    fails(judged(GOAL, goal("status", "result", "ended_ns")), "was accepted and never ended")
    fails(
        judged(GOAL, goal("result", result={"sequence": [0]})),
        "The result of {'order': 2}: sequence",
    )
    fails(
        judged(GOAL, goal("status", status="aborted")), "ended as aborted, expected succeeded", 0.5
    )


@pytest.mark.parametrize(
    ("feedback", "words"),
    [
        ([], "Feedback to {'order': 2} came 0 times, expected 2."),
        ([[10**9, {"sequence": [0]}]], "Feedback to {'order': 2} came 1 times, expected 2."),
        ([[10**9, {}], [10**9, {}]], "The feedback to {'order': 2}: "),
    ],
)
def test_an_empty_list_is_no_feedback(feedback: list[Any], words: str) -> None:
    fails(judged(GOAL, goal("feedback", feedback=feedback)), words)


def test_an_empty_result_is_no_result() -> None:
    fails(judged(GOAL, goal("result", result={"sequence": []})), "was [], expected 2 values")


def test_a_goal_that_is_to_be_refused_is() -> None:
    wanted = {"goal": "counts", "accepted": False}
    refused = goal("accepted", "feedback", "status", "result", accepted=False)
    assert judged(wanted, refused).share == 1
    fails(judged(wanted, goal()), "was accepted, expected that it is refused")


def test_the_goal_that_a_program_sends_is_compared() -> None:
    wanted = {"sends": "fib", "values": {"order": 10}}
    assert judged(wanted, event("action", action="/fib", goal={"order": 10})).share == 1
    fails(
        judged(wanted, event("action", action="/fib", goal={"order": 1})),
        "order was 1, expected 10",
    )
    fails(judged(wanted), "The action /fib got no goal.")


def test_parameters_are_compared_and_told() -> None:
    wanted = {"parameter": "asks", "values": {"p": "world"}}
    asks = {"id": "asks", "node": "/node"}
    right = event("parameter", **asks, values={"p": "world"}, answered_ns=10**9)
    assert judged(wanted, right).share == 1
    wrong = event("parameter", **asks, values={"p": None}, answered_ns=10**9)
    fails(judged(wanted, wrong), "The node /node has no parameter p.")
    other = event("parameter", **asks, values={"p": "earth"}, answered_ns=10**9)
    fails(judged(wanted, other), "parameters of /node at 1.00 s: p was 'earth', expected 'world'.")
    fails(judged(wanted, event("parameter", **asks)), "could not be asked for; there is no node")


def test_a_parameter_is_taken_or_refused_as_expected() -> None:
    taken = event("parameter", id="sets", node="/node", set={"p": ""}, answered_ns=10**9)
    refused = event("parameter", id="sets", node="/node", set={"p": "no"}, answered_ns=10**9)
    assert judged({"parameter": "sets", "set": {"p": True}}, taken).share == 1
    assert judged({"parameter": "sets", "set": {"p": False}}, refused).share == 1
    fails(judged({"parameter": "sets", "set": {"p": True}}, refused), "p was refused: 'no'")
    fails(
        judged({"parameter": "sets", "set": {"p": False}}, taken),
        "p was taken, expected that it is",
    )


# Transforms, the end, and what was too much ---------------------------------------------------

FRAME = {
    **{"transform": "turtle1", "parent": "world", "translation": {"x": 1}},
    "rotation": {"z": 0.6, "w": 0.8},
}


def test_a_transform_is_right_with_either_sign_of_its_quaternion() -> None:
    for sign in (1, -1):
        numbers = (1, 0, 0, 0, 0, 0.6 * sign, 0.8 * sign)
        assert judged(FRAME, transform(1, "world", "turtle1", *numbers)).share == 1
    turned = transform(1, "world", "turtle1", 1, 0, 0, 0, 0, 0.6, -0.8)
    fails(judged(FRAME, turned), "The rotation from world to turtle1 at 1.00 s: w was -0.8")
    moved = transform(1, "world", "turtle1", 2, 0, 0, 0, 0, 0.6, 0.8)
    fails(judged(FRAME, moved), "The translation from world to turtle1 at 1.00 s: x was 2")


def test_a_transform_the_wrong_way_round_is_told() -> None:
    found = judged(FRAME, transform(1, "turtle1", "world", 1, 0, 0, 0, 0, 0.6, 0.8))
    fails(found, "There is no transform from world to turtle1 on /tf; there is turtle1 to world.")
    fails(judged({**FRAME, "is_static": True}), "on /tf_static; there is none.")
    moving = judged({**FRAME, "is_static": True}, transform(1, "world", "turtle1", *[0.0] * 7))
    fails(moving, "The transform to turtle1 came on /tf, expected on /tf_static.")
    assert "StaticTransformBroadcaster" in str(moving.help)


def test_a_program_ends_with_its_code_or_not() -> None:
    assert judged({"exits": 0}).share == 1
    fails(judged({"exits": 0}, code=1), "the exit code 1, expected 0")
    fails(judged({"exits": 0}, code=None), "The program still ran after 10.00 s.")


def test_nothing_is_passed_by_flooding_the_recording() -> None:
    full = event("full")
    fails(judged({"topic": "chatter"}, TALKS, *FIVE, full), "nothing after 1.00 s was recorded")
    assert judged({"node": "node"}, TALKS, full).share == 1


def test_a_hint_of_the_author_takes_the_place_of_ours() -> None:
    assert str(judged({"node": "talker", "help": "Look here."}).help) == "Look here."


def test_a_pattern_of_the_author_that_never_ends_is_ended(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(asking, "LIMITS", WorkLimits(cpu_s=0.3, wall_s=30.0))
    checks = Checks()
    add_checks(checks, {"logs": {"log": "/^(a+)+$/"}}, [RunCase()], KnownTypes({}), 10)
    recording = Recording(trace(line(1, "a" * 60 + "!")), scene="graph")
    (verdict,) = judge(Recordings(recording), checks, {"logs": 1}, {})
    assert verdict.status == "not_judged"
    assert "did not come to an end" in str(verdict.rationale)
