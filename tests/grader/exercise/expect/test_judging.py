"""What was exchanged is judged: what is right passes, what is not is told, and parts are fair."""

from typing import Any

import pytest

from grader.exercise import asking
from grader.exercise.cases import RunCase
from grader.exercise.check import Checks, judge
from grader.exercise.expect import judging
from grader.exercise.expect.checks import add_checks
from grader.exercise.known_types import KnownTypes
from grader.exercise.verdict import Finding
from grader.recording.recording import Recording, Recordings
from grader.system.limited import WorkLimits
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
HEARS = endpoint("topic /chatter", writes=False)
FIVE = [text(0.5 * n + 0.5, "/chatter", f"Hello {n}") for n in range(5)]


def passes(expected: dict[str, Any], *parts: Any, **more: Any) -> None:
    assert judged(expected, *parts, **more).share == 1


def fails(
    words: str, expected: dict[str, Any], *parts: Any, share: float = 0.0, **more: Any
) -> Finding:
    """Check that something is missing, that it is told, and what is earned."""
    found = judged(expected, *parts, **more)
    assert words in str(found.rationale)
    assert found.share == share
    return found


# Nodes and topics -----------------------------------------------------------------------------


def test_a_node_or_topic_that_is_not_there_or_another_is_told_with_what_is():
    passes({"node": "node"}, TALKS)
    fails("There is no node /talker; there is /node.", {"node": "talker"}, TALKS)
    fails("there is none", {"node": "talker"})
    words = "Nothing publishes on /chater, only on /chatter."
    found = fails(words, {"topic": "chater"}, TALKS, *FIVE)
    assert "yours is /chatter" in str(found.help)
    fails("nor on any other topic", {"topic": "chatter"})
    many = [endpoint(f"topic /{'n' * 300}{n}") for n in range(5_000)]
    said = str(judged({"topic": "chatter"}, *many).rationale)
    assert "4,990 more" in said
    assert len(said) < 4_000
    wanted = {"topic": "chatter", "type": "std_msgs/msg/Float64"}
    fails("has the type std_msgs/msg/String, expected std_msgs/msg/Float64", wanted, TALKS, *FIVE)


def test_a_topic_needs_messages_after_the_begin():
    passes({"topic": "chatter"}, TALKS, *FIVE)
    fails("0 messages on /chatter came, expected at least 1", {"topic": "chatter"}, TALKS)
    few = {"topic": "chatter", "count": {"at_most": 3}}
    fails("5 messages on /chatter came, expected at most 3", few, TALKS, *FIVE)
    late = {"topic": "chatter", "begin": 2, "count": {"at_least": 3}}
    fails("2 messages", late, TALKS, *FIVE)


def test_values_may_depend_on_number_time_and_what_was_heard():
    passes({"topic": "chatter", "values": "Hello {n}"}, TALKS, *FIVE)
    words = "Message 0 on /chatter, at 0.50 s: data was 'Hello 0', expected 'Hello 1'."
    found = fails(words, {"topic": "chatter", "values": "Hello {n + 1}"}, TALKS, *FIVE)
    assert found.evidence[0].time_s == 0.5
    passes({"topic": "chatter", "values": "/^Hello [0-9]$/"}, TALKS, *FIVE)


def test_a_value_may_depend_on_what_was_heard_of_peers():
    data = [number(n, "/data", n, node="/peer") for n in range(1, 6)]
    mean = {"topic": "mean", "values": "=mean([each.data for each in heard['/data'][-3:]])"}
    talks = endpoint("topic /mean", "std_msgs/msg/Float64")
    ends = (talks, endpoint("topic /data", "std_msgs/msg/Float64", writes=False))
    passes(mean, *ends, *data, number(5.5, "/mean", 4.0))
    fails("data was 3, expected 4", mean, *ends, *data, number(5.5, "/mean", 3.0))
    # nothing came yet: a finding, and no failure of the exercise
    fails("cannot be told", mean, *ends, *data, number(0.5, "/mean", 3.0))
    mean = {"topic": "mean", "values": "=heard['/data'][-1].data"}
    heard, own = number(1, "/data", 7, node="/peer"), number(2, "/data", 0)
    passes(mean, *ends, heard, own, number(3, "/mean", 7))
    assert judged(mean, *ends, heard, own, number(3, "/mean", 0)).share == 0
    # where no peer publishes, the program's other node does
    passes(mean, talks, own, number(3, "/mean", 0))


def test_only_a_message_that_a_subscription_could_get_was_heard():
    logs = {"log": 'Publishing: "{data}"', "heard": "chatter"}
    relays = {"topic": "out", "values": "=heard['/chatter'][-1]"}
    out, five = endpoint("topic /out"), [each._replace(node="/peer") for each in FIVE]
    parts = [*five, *LOGGED, out, text(2.1, "/out", "Hello 3")]
    other = endpoint("topic /other", writes=False)
    late = endpoint("topic /chatter", writes=False, time_ns=1_100_000_000)
    float_ = endpoint("topic /chatter", "std_msgs/msg/Float64", writes=False)
    for wanted in (logs, relays):
        fails("Nothing subscribes to /chatter, nor to any", wanted, *parts)
        fails("Nothing subscribes to /chatter, only to /other.", wanted, *parts, other)
        fails("expected std_msgs/msg/String", wanted, *parts, float_)
        passes(wanted, *parts, late)
    # what came before is neither asked for, nor counted, nor known
    passes(logs, late, *five, *LOGGED[2:])
    fails("3 messages on /chatter", {**logs, "count": {"at_least": 4}}, late, *five, *LOGGED)
    fails("cannot be told", relays, late, out, *five, text(1.05, "/out", "Hello 1"))
    # a latched one came later, all the same
    latched = {**late, "durability": 1}
    passes({**logs, "count": {"at_least": 5}}, latched, *five, *LOGGED)


def test_what_is_sent_without_a_subscription_of_what_it_depends_on_does_not_count():
    wanted = {"topic": "chatter", "heard": "/tf", "count": {"at_least": 3}}
    tf = {"kind": "tf2_msgs/msg/TFMessage", "writes": False}
    fails("Nothing subscribes to /tf", wanted, TALKS, *FIVE)
    passes(wanted, TALKS, *FIVE, endpoint("topic /tf", **tf))
    late = endpoint("topic /tf", time_ns=1_600_000_000, **tf)
    fails("2 messages on /chatter", wanted, TALKS, *FIVE, late)


def test_in_real_time_a_check_says_that_it_knows_no_more_than_a_subscription():
    wanted = {"log": 'Publishing: "{data}"', "heard": "chatter"}
    found = judged(wanted, HEARS, *FIVE, *LOGGED, time="real")
    assert found.share == 1
    assert "nobody can tell more than that your program had a subscr" in str(found.rationale)
    assert "nobody" not in str(judged(wanted, HEARS, *FIVE, *LOGGED).rationale)


def test_in_real_time_all_messages_together_may_take_a_little_longer():
    wanted = {"topic": "chatter", "rate": {"hz": 2, "tolerance": 0.05}}
    late = [text(at_s, "/chatter", "Hello") for at_s in (0.5, 1.0, 1.7, 2.0, 2.8)]
    slow = [text(0.6 * n, "/chatter", "Hello") for n in range(1, 9)]
    passes(wanted, TALKS, *late, time="real", length_s=3)
    fails("1.74 times a second", wanted, TALKS, *late, length_s=3)
    fails("1.67 times a second", wanted, TALKS, *slow, time="real", length_s=5)


def test_of_several_programs_the_lines_of_those_count_that_hear():
    wanted = {"log": 'Publishing: "{data}"', "heard": "chatter"}
    programs = {"/talker": "talker-1", "/ns/listener": "listener-2"}
    hears = endpoint("topic /chatter", writes=False, node="/ns/listener")
    for logger in ("ns.listener", "ns.listener.child"):
        lines = [line(0.5 * n + 0.5, f'Publishing: "Hello {n}"', name=logger) for n in range(5)]
        passes(wanted, hears, *FIVE, *lines, programs=programs)
    for logger in ("talker", "another", "ns.listener2"):
        lines = [line(0.5 * n + 0.5, f'Publishing: "Hello {n}"', name=logger) for n in range(5)]
        words = "by a program that does not hear chatter"
        fails(words, wanted, hears, *FIVE, *lines, programs=programs)
        passes(wanted, hears, *FIVE, *lines)


@pytest.mark.parametrize(
    ("values", "sends"),
    [
        *(("=1 / heard['/in'][-1].data", 0.0), ("=sqrt(heard['/in'][-1].data)", -1.0)),
        *(("=int(heard['/in'][-1].data)", float("nan")), ("=exp(heard['/in'][-1].data)", 1e9)),
        *(("=2 ** heard['/in'][-1].data", 1e9), ("=range(int(heard['/in'][-1].data))", 2.0**63)),
        ("=heard['/in'][-1].data.x", 1.0),
    ],
)
def test_what_a_program_sends_makes_an_expression_fail_and_not_the_grader(values, sends):
    talks = endpoint("topic /out", "std_msgs/msg/Float64")
    wanted = {"topic": "out", "values": values}
    fails("cannot be told", wanted, talks, number(1, "/in", sends), number(2, "/out", 1))


def test_a_text_between_strokes_that_a_program_sends_is_no_pattern():
    wanted = {"topic": "out", "values": "=heard['/in'][-1].data"}
    talks = endpoint("topic /out")
    for sent in ("/.*/", "/(/", "/(a+)+$/"):
        assert judged(wanted, talks, text(1, "/in", sent), text(2, "/out", "aaa")).share == 0
        passes(wanted, talks, text(1, "/in", sent), text(2, "/out", sent))


# Rates and quality: what earns a part ---------------------------------------------------------

RATE = {"topic": "chatter", "rate": {"hz": 2, "tolerance": 0.05}}


def test_a_rate_lasts_to_the_end_or_to_the_last_message_without_pauses():
    passes(RATE, TALKS, *FIVE, length_s=3)
    paused = [*FIVE, text(9.9, "/chatter", "")]
    fails("a longest pause of 7.40 s; expected 2 times a second", RATE, TALKS, *paused)
    pairs = [text(n // 2 * 1.0, "/chatter", "") for n in range(20)]
    fails("several times at once, with pauses of 1.00 s", RATE, TALKS, *pairs)
    words = "came no more after 2.50 s; expected 2 times a second, to the end at 10 s"
    fails(words, RATE, TALKS, *FIVE)
    passes({**RATE, "end": 3}, TALKS, *FIVE)
    passes({**RATE, "count": {"at_most": 5}}, TALKS, *FIVE)
    fails("came 0 times a second", RATE, TALKS, FIVE[0])


@pytest.mark.parametrize("period_s", [1.0, 0.25, 0.4, 0.01])
def test_half_a_rate_is_not_half_of_the_points(period_s):
    other = [text(period_s * n, "/chatter", f"Hello {n}") for n in range(1, 6)]
    fails(f"came {1 / period_s:.2f} times a second", RATE, TALKS, *other)
    # where the values count as well, they are right
    fails("times a second", {**RATE, "values": "Hello {n + 1}"}, TALKS, *other, share=0.5)
    assert judged({**RATE, "values": "Hello"}, TALKS, *other).share == 0


@pytest.mark.parametrize("hz", [25.0, 50.0, 100.0])
def test_a_rate_is_the_mean_of_all_periods(hz):
    wanted = {"topic": "chatter", "rate": {"hz": hz, "tolerance": 0.02}}
    uneven = [text((n + 0.4 * (n % 2)) / hz, "/chatter", "") for n in range(100)]
    passes(wanted, TALKS, *uneven, length_s=100 / hz)
    slower = [text(n / (0.97 * hz), "/chatter", "") for n in range(100)]
    fails(f"came {0.97 * hz:.2f} times", wanted, TALKS, *slower, length_s=100 / hz)


def test_a_wrong_rate_is_told_before_the_count_that_it_makes():
    wanted = {**RATE, "count": {"at_least": 8}}
    slow = [text(n, "/chatter", "Hello") for n in range(1, 6)]
    fails("/chatter came 1.00 times a second", wanted, TALKS, *slow)
    fails("5 messages on /chatter came, expected at least 8", wanted, TALKS, *FIVE, length_s=3)


@pytest.mark.parametrize(
    ("qos", "words"),
    [
        ({"reliability": "best_effort"}, "has the reliability reliable, expected best_effort"),
        ({"durability": "transient_local"}, "has the durability volatile, expected transient"),
        ({"depth": 1}, "has the depth 10, expected 1"),
    ],
)
def test_quality_that_is_not_as_expected_is_told(qos, words):
    passes({"topic": "chatter", "qos": {"depth": 10}}, TALKS, *FIVE)
    fails(words, {"topic": "chatter", "qos": qos}, TALKS, *FIVE)
    wanted = {"topic": "chatter", "qos": qos, "values": "Hello {n}"}
    fails(words, wanted, TALKS, *FIVE, share=0.5)


def test_what_a_late_peer_gets_is_counted():
    wanted = {"got": "chatter", "by": "peer", "count": {"at_most": 1}}
    one = event("got", topic="/chatter", values={})
    passes(wanted, one)
    fails("0 messages on /chatter for /peer came, expected at least 1", wanted)
    fails("expected at most 1", wanted, one, one)


# Lines ----------------------------------------------------------------------------------------


def test_a_line_is_logged_so_many_times():
    passes({"log": "Hi"}, line(1, "Hi"))
    passes({"log": "/H.$/"}, line(1, "Hi"))
    fails("'Hi' was not logged; nothing was.", {"log": "Hi"})
    fails("the last line was 'Ho!'", {"log": "Hi"}, line(1, "Ho!"))
    fails("there is 'Hallo'", {"log": "Hello"}, line(1, "Hallo"))
    twice = {"log": "Hi", "count": {"at_least": 2}}
    words = "'Hi' was logged 1 times, expected at least 2; the last line was 'Ho'."
    fails(words, twice, line(1, "Hi"), line(2, "Ho"))
    fails("at most 1", {"log": "Hi", "count": {"at_most": 1}}, line(1, "Hi"), line(2, "Hi"))


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
def test_a_line_that_is_missing_is_told_with_what_may_be_wrong(said, more, help_):
    assert help_ in str(judged({"log": "Hi you!"}, line(1, said), *more).help)


EACH = {"log": 'Publishing: "{data}"', "each": "chatter"}
LOGGED = [line(0.5 * n + 0.5, f'Publishing: "Hello {n}"') for n in range(5)]


def test_each_message_has_its_line_in_time():
    passes(EACH, *FIVE, *LOGGED)
    fails("'Publishing: \"Hello 4\"' was not logged", EACH, *FIVE, *LOGGED[:4])
    late = [*LOGGED[:4], line(9, 'Publishing: "Hello 4"')]
    fails("was logged at 9.00 s, for what came at 2.50 s.", EACH, *FIVE, *late)
    fails("Nothing came on /chatter that could be logged.", EACH, *LOGGED)
    heard = [each._replace(node="/peer") for each in FIVE]
    wanted = {"log": 'Publishing: "{data}"', "heard": "chatter"}
    passes(wanted, HEARS, *heard, *LOGGED)
    fails("was not logged", wanted, HEARS, *heard, *LOGGED[1:])


def test_a_print_or_another_level_earns_half_and_one_line_for_all_nothing():
    printed = "".join(f'Publishing: "Hello {n}"\n' for n in range(5))
    found = fails("was printed and not logged", EACH, *FIVE, share=0.5, output=printed)
    assert "get_logger().info" in str(found.help)
    fails("/H.$/ was printed and not logged", {"log": "/H.$/"}, share=0.5, output="x\nHi\n")
    assert judged(EACH, *FIVE, output='Publishing: "Hello 0"\n').share == 0
    assert judged(EACH, *FIVE, *LOGGED[:2], output='Publishing: "Hello 2"\n').share == 0
    wanted, said = {"log": "Hi", "level": "info"}, line(1, "Hi", level=30)
    fails("'Hi' was logged, but not as info.", wanted, said, share=0.5, output="[WARN] Hi")
    passes({"log": "Hi", "level": "warn"}, line(1, "Hi", level=30))


def test_very_many_lines_and_very_long_ones_are_judged_at_once():
    messages = [text(1, "/chatter", f"{n}" * 20) for n in range(3_000)]
    lines = [line(1, f"I said {n}" * 20) for n in range(3_000)]
    assert judged({"log": "I say {data}", "each": "chatter"}, *messages, *lines).share == 0
    long = [text(1, "/chatter", "ab" * 500_000), line(1, "ba" * 500_000)]
    assert judged({"log": "{data}", "each": "chatter"}, *long).share == 0
    lines = [line(1, "a" * 1_000_000 + "!") for _ in range(9)]
    assert judged({"log": "/.*a.*a.*b$/"}, *lines).share == 0


# Services, actions, parameters ----------------------------------------------------------------

CALL = {"call": "adds", "response": {"sum": "=a + b"}}
ASKED = {"id": "adds", "service": "/add", "type": "example_interfaces/srv/AddTwoInts"}
SENT = {**ASKED, "request": {"a": 2, "b": 3}, "sent_ns": 10**9}


def test_an_answer_is_compared_and_what_keeps_it_away_is_told():
    right = event("call", **SENT, response={"sum": 5}, answered_ns=10**9)
    passes(CALL, right)
    wrong = event("call", **SENT, response={"sum": 6}, answered_ns=10**9)
    fails("The answer of /add to {'a': 2, 'b': 3}: sum was 6, expected 5.", CALL, wrong)
    late = event("call", **SENT, response={"sum": 5}, answered_ns=3 * 10**9)
    fails("The answer took 2.00 s, expected at most 1.", CALL, late, share=0.5)
    refused = event("refused", what="x", why="AddTwoInts_Request has no field a, only x")
    fails("has no field a, only x", CALL, event("call", **ASKED), refused)
    fails("no field a", GOAL, event("goal", **{**ASKED, "id": "counts", "action": "/fib"}), refused)
    fails("/add was called at 1.00 s and never answered", CALL, event("call", **SENT))
    fails("Nothing serves /add, nor any other service.", CALL, event("call", **ASKED))
    other = endpoint("request /ad", ASKED["type"], writes=False)
    fails("Nothing serves /add, only /ad.", CALL, event("call", **ASKED), other)
    trigger = endpoint("request /add", "std_srvs/srv/Trigger", writes=False)
    fails("has the type std_srvs/srv/Trigger", CALL, event("call", **ASKED), trigger)


@pytest.mark.parametrize(
    "expected",
    [CALL, {"goal": "adds"}, {"parameter": "adds"}, {"served": "add"}, {"sends": "add"},
     {"topic": "t"}, {"log": "a"}, {"got": "t", "by": "peer"}, {"node": "n"}, EACH,
     {"transform": "a", "parent": "b"}],
)  # fmt: skip
def test_an_empty_recording_fails_and_breaks_nothing(expected):
    assert judged(expected).share == 0


def test_a_request_to_a_peer_is_compared():
    wanted = {"served": "add", "request": {"a": 2, "b": 3}, "count": {"at_most": 1}}
    right = event("served", service="/add", request={"a": 2, "b": 3})
    passes(wanted, right)
    fails("a was 3, expected 2", wanted, event("served", service="/add", request={"a": 3, "b": 3}))
    fails("2 calls of /add came, expected at most 1", wanted, right, right)
    fails("/add was never called.", wanted)
    other = endpoint("request /ad", ASKED["type"])
    fails("the program has clients of /ad", wanted, other)


def test_what_a_type_of_the_hand_in_s_does_not_hold_is_no_fault_of_the_exercise():
    unsaid = event("unsaid", what="AddTwoInts_Request", why="AddTwoInts_Request has no field a")
    own = {"example_interfaces/srv/AddTwoInts": "int64 x\n---\n"}
    fails("has no field a", CALL, event("call", **ASKED), unsaid, own=own)
    with pytest.raises(judging.PeerFault, match="/peer cannot say what the exercise asks of it"):
        judged(CALL, event("call", **ASKED), unsaid)


@pytest.mark.parametrize("expected", [{"served": "add"}, {"sends": "add"}])
def test_what_a_peer_cannot_answer_is_told_as_what_the_program_has_sent(expected):
    asked = [
        event("served", service="/add", request={"a": 0}),
        event("action", action="/add", goal={}),
    ]
    refused = event("refused", what="=1 / a", why="division by zero")
    passes(expected, *asked)
    fails("/peer could not use what came from your program: 'division", expected, *asked, refused)


GOAL = {"goal": "counts", "result": [0, 1], "feedback": [[0], [0, 1]], "status": "succeeded"}
HANDLED = {
    **{"id": "counts", "action": "/fib", "type": "t", "goal": {"order": 2}, "sent_ns": 10**9},
    **{"accepted": True, "feedback": [[10**9, {"sequence": [0]}], [10**9, {"sequence": [0, 1]}]]},
    **{"status": "succeeded", "result": {"sequence": [0, 1]}, "ended_ns": 2 * 10**9},
}


def goal(*without: str, **values: Any) -> Any:
    return event("goal", **{k: v for k, v in HANDLED.items() if k not in without}, **values)


def test_a_goal_is_judged_by_answer_feedback_result_and_status():
    passes(GOAL, goal())
    none = goal("sent_ns", "accepted", "feedback", "status", "result", "ended_ns")
    fails("Nothing serves the action /fib, nor any other.", GOAL, none)
    other = endpoint("request /fibo/_action/send_goal", "t", writes=False)
    fails("only /fibo", GOAL, none, other)
    fails("was not answered, expected that it is accepted", GOAL, goal("accepted", "ended_ns"))
    fails("was refused, expected that it is accepted", GOAL, goal("accepted", accepted=False))
    fails("was accepted and never ended", GOAL, goal("status", "result", "ended_ns"))
    fails("The result of {'order': 2}: sequence", GOAL, goal("result", result={"sequence": [0]}))
    fails("ended as aborted, expected succeeded", GOAL, goal("status", status="aborted"), share=0.5)
    fails("was [], expected 2 values", GOAL, goal("result", result={"sequence": []}))
    wanted = {"goal": "counts", "accepted": False}
    refused = goal("accepted", "feedback", "status", "result", accepted=False)
    passes(wanted, refused)
    fails("was accepted, expected that it is refused", wanted, goal())
    one = [10**9, {"sequence": [0]}]
    fails("Feedback to {'order': 2} came 0 times, expected 2.", GOAL, goal("feedback", feedback=[]))
    fails("Feedback to {'order': 2} came 1 times", GOAL, goal("feedback", feedback=[one]))
    fails("The feedback to {'order': 2}: ", GOAL, goal("feedback", feedback=[[10**9, {}]] * 2))


def test_the_goal_that_a_program_sends_is_compared():
    wanted = {"sends": "fib", "values": {"order": 10}}
    passes(wanted, event("action", action="/fib", goal={"order": 10}))
    fails("order was 1, expected 10", wanted, event("action", action="/fib", goal={"order": 1}))
    fails("The action /fib got no goal.", wanted)


def test_parameters_are_compared_told_taken_and_refused():
    wanted = {"parameter": "asks", "values": {"p": "world"}}
    asks = {"id": "asks", "node": "/node"}
    right = event("parameter", **asks, values={"p": "world"}, answered_ns=10**9)
    passes(wanted, right)
    wrong = event("parameter", **asks, values={"p": None}, answered_ns=10**9)
    fails("The node /node has no parameter p.", wanted, wrong)
    other = event("parameter", **asks, values={"p": "earth"}, answered_ns=10**9)
    fails("parameters of /node at 1.00 s: p was 'earth', expected 'world'.", wanted, other)
    fails("could not be asked for; there is no node", wanted, event("parameter", **asks))
    taken = event("parameter", id="sets", node="/node", set={"p": ""}, answered_ns=10**9)
    refused = event("parameter", id="sets", node="/node", set={"p": "no"}, answered_ns=10**9)
    passes({"parameter": "sets", "set": {"p": True}}, taken)
    passes({"parameter": "sets", "set": {"p": False}}, refused)
    fails("p was refused: 'no'", {"parameter": "sets", "set": {"p": True}}, refused)
    fails("p was taken, expected that it is", {"parameter": "sets", "set": {"p": False}}, taken)


# Transforms, the end, and what was too much ---------------------------------------------------

FRAME = {
    **{"transform": "turtle1", "parent": "world", "translation": {"x": 1}},
    "rotation": {"z": 0.6, "w": 0.8},
}


def test_a_transform_is_right_with_either_sign_and_the_right_way_round():
    for sign in (1, -1):
        numbers = (1, 0, 0, 0, 0, 0.6 * sign, 0.8 * sign)
        passes(FRAME, transform(1, "world", "turtle1", *numbers))
    turned = transform(1, "world", "turtle1", 1, 0, 0, 0, 0, 0.6, -0.8)
    fails("The rotation from world to turtle1 at 1.00 s: w was -0.8", FRAME, turned)
    moved = transform(1, "world", "turtle1", 2, 0, 0, 0, 0, 0.6, 0.8)
    fails("The translation from world to turtle1 at 1.00 s: x was 2", FRAME, moved)
    words = "There is no transform from world to turtle1 on /tf; there is turtle1 to world."
    fails(words, FRAME, transform(1, "turtle1", "world", 1, 0, 0, 0, 0, 0.6, 0.8))
    static = {**FRAME, "is_static": True}
    fails("on /tf_static; there is none.", static)
    words = "The transform to turtle1 came on /tf, expected on /tf_static."
    moving = fails(words, static, transform(1, "world", "turtle1", *[0.0] * 7))
    assert "StaticTransformBroadcaster" in str(moving.help)


def test_the_end_a_flood_and_the_hint_of_the_author_are_told():
    passes({"exits": 0})
    fails("the exit code 1, expected 0", {"exits": 0}, code=1)
    fails("The program still ran after 10.00 s.", {"exits": 0}, code=None)
    full = event("full")
    fails("nothing after 1.00 s was recorded", {"topic": "chatter"}, TALKS, *FIVE, full)
    passes({"node": "node"}, TALKS, full)
    assert str(judged({"node": "talker", "help": "Look here."}).help) == "Look here."


def test_a_pattern_of_the_author_that_never_ends_is_ended(monkeypatch):
    monkeypatch.setattr(asking, "LIMITS", WorkLimits(cpu_s=0.3, wall_s=30.0))
    checks = Checks()
    add_checks(checks, {"logs": {"log": "/^(a+)+$/"}}, [RunCase()], KnownTypes({}), 10, {})
    recording = Recording(trace(line(1, "a" * 60 + "!")), scene="graph")
    (verdict,) = judge(Recordings(recording), checks, {"logs": 1}, {})
    assert verdict.status == "not_judged"
    assert "did not come to an end" in str(verdict.rationale)
