"""What comes from the process that looks is taken only in the one form that it has."""

import json
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from grader.recording.reading import load
from grader.recording.recording import Recording, Recordings, Run
from grader.recording.saving import save_all
from grader.submission.package_trace import (
    MOST_BYTES,
    Description,
    Lacking,
    LaunchedNode,
    LaunchFile,
    NamedMesh,
    Obstacle,
    PackageTrace,
    Parameter,
    Setup,
    Varied,
    decode,
    encode,
)
from grader.text.message import NOTHING, Message

SETUP = Setup(
    "a", "a", "", "ament_python", NOTHING, ("b",), None, (), (), (), "", ("x",), ("y",), ()
)
NODE = LaunchedNode(
    "p", "e", "", "", ("-d",), (Parameter("robot_description", "", 0, True),), (), False
)
LACKING = Lacking("file", "/prefix/x", "", "launch/a.py")
PROBLEM = Obstacle("error", Message.of("NameError"), "a.py", 3)
TRACE = PackageTrace(
    SETUP,
    ("other",),
    (LaunchFile("launch/a.py", PROBLEM, (NODE,), (), (), (), (), (LACKING,), (), ""),),
    (
        Description(
            0, "launch/a.py", True, "a.urdf", None, (NamedMesh("u", "found", "p", True),), True
        ),
    ),
    (Varied(0, "length", 1),),
    ("<robot/>", "<robot name='é'/>"),
)


def changed(**parts):
    return json.dumps({**json.loads(encode(TRACE)), **parts}).encode()


def test_a_trace_comes_back_as_it_was():
    assert decode(encode(TRACE)) == TRACE
    assert encode(decode(encode(TRACE))) == encode(TRACE)
    assert TRACE.sha256() != replace(TRACE, others=()).sha256()


@pytest.mark.parametrize(
    "data",
    [
        b"",
        b"[]",
        b"\xff",
        b"NaN",
        b'"' + b"[" * 100_000,
        b"[" * 100_000,
        b" " * (MOST_BYTES + 1),
        changed(more=1),
        changed(setup=[]),
        changed(setup={"name": "a"}),
        changed(others="other"),
        changed(others=["x" * 3000]),
        changed(others=[""] * 6000),
        changed(texts=[3]),
        changed(texts=["x" * 2_000_001, ""]),
        changed(texts=[]),
        changed(varied=[{"of": 1, "name": "a", "text": 0}]),
        changed(varied=[{"of": True, "name": "a", "text": 0}]),
        changed(varied=[{"of": 10**30, "name": "a", "text": 0}]),
        changed(setup={**json.loads(encode(TRACE))["setup"], "sources": []}),
    ],
)
def test_what_is_no_trace_is_refused(data):
    with pytest.raises(ValueError):
        decode(data)


@given(
    st.binary(max_size=200)
    | st.recursive(st.none() | st.text(), st.lists).map(repr).map(str.encode)
)
def test_nothing_else_than_a_value_error_comes_of_nonsense(data):
    with pytest.raises(ValueError):
        decode(data)


def test_a_recording_of_it_is_written_and_read_again(tmp_path):
    recording = Recording(TRACE, Run(trace_sha256=TRACE.sha256()), scene="package")
    save_all(Recordings(recording), tmp_path)
    again = load(tmp_path)
    assert again.trace == TRACE
    assert not (tmp_path / "scenario.json").exists()
