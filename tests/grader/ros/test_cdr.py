"""Bytes: what they are is compared in test_compiled.py; here, that hostile ones are bounded."""

import struct

import pytest
from hypothesis import given
from hypothesis import strategies as st

from grader.ros.cdr import MARK
from grader.ros.definitions import Definitions
from grader.ros.messages import deserialise, serialise

TEXTS = {
    "mine/msg/E": "",
    "mine/msg/Many": "E[] many\n",
    "mine/msg/Fixed": "E[60000] many\n",
    "mine/msg/All": (
        "bool b\nuint64 u\nstring<=3 s\nwstring w\nbyte[] o\nfloat32[<=2] f\nint16[3] i\nE[] e\n"
        "string[] texts\nMany[2] within\n"
    ),
    "mine/msg/Padded": "bool b\nint64 u\n",
}


@pytest.fixture(scope="module")
def made():
    interfaces = Definitions(TEXTS)
    assert interfaces.errors == {}
    return lambda name: interfaces.type(f"mine/msg/{name}")


def test_what_is_between_fields_is_zero(made):
    message = made("Padded")(b=True, u=-1)
    assert serialise(message) == MARK + b"\1" + bytes(7) + b"\xff" * 8


def test_a_wstring_is_utf_16_in_four_bytes_each(made):
    kind = made("All")
    message = kind(w="a🐢")
    data = serialise(message)
    units = struct.pack("<IIII", 3, ord("a"), 0xD83D, 0xDC22)
    assert units in data
    assert deserialise(data, kind) == message


@pytest.mark.parametrize("name", ["Many", "All", "Fixed"])
def test_what_promises_more_than_it_has_is_refused_at_once(made, name):
    data = MARK + b"\xff" * 40
    with pytest.raises(ValueError, match=r"cut off|at most"):
        deserialise(data, made(name))


@pytest.mark.parametrize("data", [b"", b"\0\1\0", b"\0\0\0\0\0", b"\0\3\0\0\0"])
def test_other_heads_are_refused(made, data):
    with pytest.raises(ValueError, match="no plain little-endian CDR"):
        deserialise(data, made("E"))


@given(data=st.binary(max_size=200))
def test_any_bytes_are_a_message_or_a_value_error(made, data):
    for name in ("E", "Many", "All", "Padded"):
        kind = made(name)
        try:
            message = deserialise(MARK + data, kind)
        except ValueError:
            continue
        assert deserialise(serialise(message), kind) == message or "nan" in repr(message)


@given(at=st.integers(min_value=0))
def test_each_end_of_a_message_is_noticed(made, at):
    kind, many, empty = (made(name) for name in ("All", "Many", "E"))
    within = [many(many=[empty()] * 3), many(many=[empty()])]
    values = {"s": "abc", "w": "é", "o": [b"a"], "f": [1.0], "e": [empty()], "texts": ["x"]}
    whole = serialise(kind(**values, within=within))
    with pytest.raises(ValueError):
        deserialise(whole[: at % len(whole)], kind)


def test_bounds_hold(made):
    for longer, most in (({"s": "abcd"}, 3), ({"f": [1.0, 2.0, 3.0]}, 2)):
        with pytest.raises(ValueError, match=f"at most {most}"):
            serialise(made("All")(check_fields=False, **longer))


@pytest.mark.parametrize(
    "wrong", [{"u": -1}, {"u": "x"}, {"u": None}, {"within": [1, 2]}, {"w": "\ud800"}, {"o": [b""]}]
)
def test_what_does_not_fit_is_a_value_error(made, wrong):
    with pytest.raises(ValueError):
        serialise(made("All")(check_fields=False, **wrong))
