import json
from contextlib import suppress

import pytest
from hypothesis import given
from hypothesis import strategies as st

from grader.run.lockstep.protocol import (
    TICK_NS,
    Advance,
    EndpointInfo,
    Kind,
    Mail,
    Note,
    Parcel,
    ProtocolError,
    Reply,
    Table,
    decode,
    encode,
)
from grader.text.message import Message, msg
from turtlesim_py.world import arena

U32, U64 = st.integers(0, 2**32 - 1), st.integers(0, 2**64 - 1)
#: What can be shown: nothing that a terminal would stumble over.
TEXTS = st.text(st.characters(exclude_categories=("C", "Z")), max_size=100)
NUMBERS = st.integers(-(2**60), 2**60) | st.floats(allow_nan=False, allow_infinity=False)
CLAUSES = st.builds(msg, st.just("starts {what} {n:,} times"), what=TEXTS, n=NUMBERS)
REMARKS = TEXTS.map(Message.of) | st.builds(
    msg, st.just("the submission {does}"), does=TEXTS | CLAUSES
)
PARCELS = st.lists(st.builds(Parcel, U32, U32, U64, U64, st.binary(max_size=50)))


def test_a_tick_is_as_long_as_the_world_s():
    assert TICK_NS == arena.TICK_NS


@given(
    st.one_of(
        st.builds(Advance, U64, st.booleans(), U64, U64, st.booleans()),
        st.builds(Mail, PARCELS),
        st.builds(Reply, U64, st.booleans(), U64, U64, PARCELS),
        st.builds(Note, st.sampled_from(Kind), REMARKS),
    )
)
def test_packets_survive_the_link(packet):
    assert decode(encode(packet)) == packet


def test_tables_survive_the_link():
    own = EndpointInfo("/a/talker", "topic /chatter", "std_msgs/msg/String", True, 1, 2, 0, 7)
    node = EndpointInfo("/", "node /a/talker", "", True, id=8)
    table = Table((own, own._replace(writes=False, is_hidden=True), node), (1, 2))
    assert decode(encode(table)) == table


NO_TABLES = (
    b'T[[["/a", "topic /a\\u001b[31m", "a/msg/A", true, 1, 2, 0]], []]',
    b'T[[["/a", "topic pose", "a/msg/A", true, 1, 2, 0]], []]',
    b'T[[["/a b", "topic /a", "a/msg/A", true, 1, 2, 0]], []]',
    b'T[[["/a", "topic /a", "String", true, 1, 2, 0]], []]',
    b'T[[["/a", "topic /a", "a/msg/A", 1, 1, 2, 0]], []]',
    b'T[[["/a", "topic /a", "a/msg/A", true, 1, 2, -1]], []]',
    b'T[[["/a", "topic /a", "a/msg/A", true, 1, 2, "0"]], []]',
    b'T[[["/a", "topic /a", "a/msg/A", true, 1, 2, 0, 0, 0]], []]',
    b'T[[["/a", "topic /a", "a/msg/A", true, 1, 2, 0, 0, true, 0]], []]',
    b'T[[], ["1"]]',
    b"T[[], 3]",
    b"T[[], [], []]",
    b'T[[["/a", 3, "a/msg/A", true]], []]',
    b"T[[3], []]",
    b"T3",
    b"T" + b"[" * 100_000,
)


def test_names_that_ros_does_not_allow_are_no_table():
    for data in NO_TABLES:
        with pytest.raises(ProtocolError):
            decode(data)


def test_a_parcel_that_is_cut_off_is_a_protocol_error():
    with pytest.raises(ProtocolError):
        decode(encode(Mail([Parcel(1, 0, 1, 5, b"12345")]))[:-1])


def note(remark: object) -> bytes:
    """The packet of a note with a remark that somebody has made up."""
    return encode(Note(Kind.UNSUPPORTED)).removesuffix(b'""') + json.dumps(remark).encode()


@pytest.mark.parametrize(
    "remark",
    [
        *(3, None, ["a"], {}, {"key": 3}, {"key": "{a}"}, {"key": "{a:.1f}", "values": {"a": []}}),
        *({"key": "{a[0]}", "values": {"a": "x"}}, {"key": "{a:99999d}", "values": {"a": 1}}),
        {"key": "{a}", "values": {"a": {"key": "{b}"}}},
    ],
)
def test_a_remark_that_is_no_message_is_a_protocol_error(remark):
    with pytest.raises(ProtocolError):
        decode(note(remark))


def test_of_a_remark_that_somebody_has_made_up_so_much_is_taken_as_can_be_shown():
    made = {"key": "starts\x1b[2J {what}", "values": {"what": "a\n" + "b" * 3000}}
    packet = decode(note(made))
    assert isinstance(packet, Note)
    assert str(packet.remark) == "starts?[2J a?" + "b" * 998


@given(st.binary(max_size=200))
def test_nonsense_is_a_protocol_error_and_nothing_else(data):
    with suppress(ProtocolError):
        decode(data)
