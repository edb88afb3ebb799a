"""A recording loses the names in all of its texts, and is read, played and judged as before."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from grader import judging
from grader.batch.names.people import forms
from grader.batch.names.recorded import without_hash, without_names
from grader.batch.names.replacing import Names
from grader.cast.trace import CastTrace, SentMessage
from grader.message import msg
from grader.recording.observations import Observations, Raised, SourceLine
from grader.recording.recording import Provenance, PublishedTopic, Recording, Recordings, Run
from grader.rosidl.bag_types import BagTypes
from tests.grader.batch.names.accented import ZOE, ZOE_ID, forms_of, found_in

NAMES = Names({}, forms([ZOE, ZOE_ID], "studentab12", frozenset()))
DEFINITIONS = {
    "zoe_msgs/msg/Inner": "string who\nfloat64[2] at\n",
    "zoe_msgs/msg/Told": "string text\nstring[] more\nInner inner\nInner[] others\n",
}
EVENT = {"kind": "got", "time_ns": 3, "peer": "/asks", "topic": "/zoe", "values": {"data": ZOE}}


def told() -> Recording:
    made = {
        "text": f"hello {ZOE}",
        "more": ["a", ZOE_ID],
        "inner": {"who": ZOE, "at": [1.0, 2.0]},
        "others": [{"who": "bob", "at": [0.0, 0.0]}, {"who": "ZOË", "at": [0.0, 0.0]}],
    }
    data = BagTypes(DEFINITIONS).cdr(made, "zoe_msgs/msg/Told")
    sent = SentMessage(2, "/zoe_says", "zoe_msgs/msg/Told", "/zoe_node", data)
    trace = CastTrace(1, (sent,), (EVENT,), ("/asks",), DEFINITIONS)
    place = SourceLine("zoe/node.py", 3, "", f"raise {ZOE}")
    run = Run(
        ticks=1,
        simulated_s=trace.duration_ns / 1e9,
        trace_sha256=trace.sha256(),
        flags=(msg("{file} is left out", file="müller.py"),),
    )
    return Recording(
        trace,
        run,
        (PublishedTopic("/zoe_says", "zoe_msgs/msg/Told"),),
        f"by {ZOE}\n",
        scene="graph",
        observations=Observations(is_known=True, raised=Raised("ZoeError", ZOE, 1.0, place)),
        provenance=Provenance("2026-11-21T23:52:52Z", "1", "3", "7", submission="zoe_müller"),
    )


def test_no_text_of_a_recording_has_a_name_and_it_is_read_back(tmp_path: Path) -> None:
    made = without_names(Recordings(told()), NAMES)
    judging.save_recordings(made, tmp_path / "recording")
    assert not found_in(tmp_path, forms_of(ZOE, ZOE_ID))
    assert judging.load_recordings(tmp_path / "recording") == made
    trace = made.nominal.trace
    assert isinstance(trace, CastTrace)
    (sent,) = trace.messages
    assert sent.topic == "/studentab12x2_says"
    values = trace.values(sent)
    assert values["text"] == "hello studentab12"
    assert values["inner"] == {"who": "studentab12", "at": [1.0, 2.0]}
    assert values["others"][0] == {"who": "bob", "at": [0.0, 0.0]}
    assert trace.events[0]["values"] == {"data": "studentab12"}


def test_a_recording_without_names_stays_the_same_object() -> None:
    found = without_names(Recordings(told()), NAMES)
    assert without_names(found, NAMES) is found


def test_a_recording_is_saved_with_its_names_where_nobody_asks(tmp_path: Path) -> None:
    judging.save_recordings(Recordings(told()), tmp_path / "recording")
    files = found_in(tmp_path, forms_of(ZOE, ZOE_ID))
    written = ("circumstances.json", "metadata.yaml", "observations.json", "output.txt", "run.json")
    assert {f"recording/{each}" for each in (*written, "recording.mcap")} <= files.keys()


def test_what_is_said_of_varied_runs_has_no_names_either() -> None:
    varied = replace(told(), provenance=None, output=ZOE_ID)
    made = without_names(Recordings(told(), (varied,)), NAMES)
    assert made.varied[0].output == "studentab12"


def test_the_hash_of_what_was_handed_in_can_be_left_out(tmp_path: Path) -> None:
    origin = Provenance("2026-11-21T23:52:52Z", "1", "3", "7", submission_sha256="a" * 64)
    made = without_hash(Recordings(replace(told(), provenance=origin)))
    judging.save_recordings(made, tmp_path / "recording")
    assert found_in(tmp_path, [b"aaaaaaaa"]) == {}
    assert judging.load_recordings(tmp_path / "recording") == made
