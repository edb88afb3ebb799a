from contextlib import suppress

from hypothesis import given
from hypothesis import strategies as st

from grader.run.lockstep.protocol import (
    TICK_NS,
    Advance,
    EndpointInfo,
    Hello,
    Kind,
    Note,
    ProtocolError,
    Reply,
    State,
    Table,
    decode,
    encode,
)
from turtlesim_py.world import arena

U32, U64 = st.integers(0, 2**32 - 1), st.integers(0, 2**64 - 1)
COUNTS = st.lists(st.tuples(U32, U64))


def test_a_tick_is_as_long_as_the_world_s() -> None:
    assert TICK_NS == arena.TICK_NS


@given(
    st.one_of(
        st.builds(Advance, U64, U32, COUNTS),
        st.builds(Hello, COUNTS, U64),
        st.builds(Reply, U64, st.sampled_from(State), COUNTS),
        st.builds(Note, st.sampled_from(Kind), st.text(max_size=100)),
    )
)
def test_packets_survive_the_link(packet: Advance | Hello | Reply | Note) -> None:
    assert decode(encode(packet)) == packet


def test_tables_survive_the_link() -> None:
    endpoint = EndpointInfo(3, "topic /turtle1/pose", "turtlesim/msg/Pose", True, 1, 2)
    table = Table((endpoint,), (1, 2))
    assert decode(encode(table)) == table


@given(st.binary(max_size=200))
def test_nonsense_is_a_protocol_error_and_nothing_else(data: bytes) -> None:
    with suppress(ProtocolError):
        decode(data)
