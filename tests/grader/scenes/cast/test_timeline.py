"""What was exchanged, hop by hop, as data and in the text of the page that plays it."""

import re

from grader.recording.recording import Recording, Recordings
from grader.reports import playback
from grader.scenes.cast import timeline
from grader.scenes.cast.trace import CastTrace
from grader.scenes.scene import load_scene
from tests import archive
from tests.grader.exercise.expect.traces import endpoint, event, line, text, trace

HOSTILE = "</script><img src=x onerror=alert(1)> \u202e\x1b[2J"


def items(exercise, kind):
    """What the right solution of an exercise has exchanged."""
    found = timeline.items(archive.recordings(exercise, "right").nominal.trace)
    return [each for each in found if each["kind"] == kind]


def test_a_message_goes_from_the_node_to_who_hears_it():
    first = items("talker", "message")[0]
    assert (first["from"], first["to"]) == ("/minimal_publisher", ["/listener"])
    assert (first["what"], first["text"]) == ("/topic", "Hello World: 0")


def test_a_log_line_stands_with_its_node_and_level():
    first = items("talker", "log")[0]
    assert (first["from"], first["what"]) == ("/minimal_publisher", "INFO")
    assert first["text"] == 'Publishing: "Hello World: 0"'


def test_calls_and_goals_last_from_the_question_to_the_answer():
    (call,) = items("service_client", "call")
    assert call["to"] == ["/server"]
    assert call["end"] >= call["t"]
    assert re.fullmatch(r'\{"a": \d+, "b": \d+\} → \d{4,}', call["text"])
    goal = items("action_server", "goal")[0]
    assert goal["from"] == "/caller"
    assert goal["t"] < min(goal["marks"]) <= max(goal["marks"]) < goal["end"]


def test_each_of_several_programs_has_its_lanes():
    made = archive.recordings("talker_listener", "right").nominal.trace
    assert timeline.lanes(made) == ["/minimal_publisher", "/minimal_subscriber"]
    assert timeline.labels(made)["/minimal_subscriber"] == "[listener-2] /minimal_subscriber"


def test_what_a_program_says_is_no_element_of_the_page():
    made = trace(endpoint("topic /chatter"), text(1, "/chatter", HOSTILE), line(1, HOSTILE))
    played = playback.of(HOSTILE, Recordings(Recording(made, scene="graph")), None)
    page = load_scene("graph").player(played)
    assert "<img" not in page
    assert page.count("<script") == page.count("</script>")


def test_what_came_late_is_told_with_the_last():
    first, late, last = (text(n, "/chatter", str(n)) for n in (1, 2, 3))
    told = {each["id"]: each for each in timeline.items(trace(first, last))}
    told |= {each["id"]: each for each in timeline.items(trace(first, late, last), 2_000_000_000)}
    assert [each["text"] for each in told.values()] == ["1", "2", "3"]


def test_a_parameter_is_set_or_got_and_a_refusal_says_why():
    answers = {"node": "/node", "sent_ns": 0, "answered_ns": 1}
    events = (
        event("parameter", **answers, values={"p": "world", "q": 0.5}),
        event("parameter", **answers, set={"p": "", "q": "too large"}),
    )
    told = [each["text"] for each in timeline.items(trace(*events))]
    assert told == ["get p → world, get q → 0.5", "set p, set q → too large"]


def test_a_program_of_many_nodes_has_as_many_lanes_as_can_be_seen():
    nodes = (endpoint("topic /chatter", node=f"/n{number:04}") for number in range(5_000))
    lanes = timeline.lanes(trace(*nodes))
    assert len(lanes) == timeline.MOST_NODES + 1
    assert lanes[-2:] == [timeline.OTHERS, "/peer"]


def test_a_run_without_anything_has_the_program_s_lane():
    assert timeline.items(CastTrace()) == []
    assert timeline.lanes(CastTrace()) == [timeline.PROGRAM]
