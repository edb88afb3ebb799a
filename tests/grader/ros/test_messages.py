"""Messages are made of plain data and back, of every kind of field; what does not fit is told."""

import json
import math

import pytest

from grader.ros.bag_types import BagTypes
from grader.ros.messages import deserialise, make, plain, serialise
from grader.scenes.cast.recorder import NoType, Types
from tests.grader.recording.slow_bag import plain as plain_of_rosbags
from tests.grader.recording.slow_bag import types_of

TEXTS = {
    "own/msg/Inner": "float64 x\nstring[] names",
    "own/msg/All": """
bool truth
byte octet
char letter
int8 small
uint8 tiny
int64 great
uint64 greatest
float32 single
float64 twice
string text
string<=5 brief "abc"
wstring wide "x"
wstring<=5 narrow
int32 FIVE=5
string TEXT="a\\"b"
byte[] octets
uint8[3] three
int32[] many
float64[<=2] few
bool[2] truths
string[] texts
builtin_interfaces/Time stamp
Inner inner
Inner[] inners
Inner[2] two
""",
}
WIDE = "é\U0001f600"
ALL = {
    **{"truth": True, "octet": 7, "letter": 65, "small": -128, "tiny": 255, "great": -(2**63)},
    **{"greatest": 2**64 - 1, "single": 0.5, "twice": 1e308, "text": WIDE, "brief": "abcde"},
    **{"wide": WIDE, "narrow": "b", "octets": [1, 255], "three": [1, 2, 3], "many": [-1, 2]},
    **{"few": [0.5], "truths": [True, False], "texts": ["", "a"]},
    **{"stamp": {"sec": 1, "nanosec": 2}, "inner": {"x": 1.0, "names": ["n"]}},
    "inners": [{"x": 2.0, "names": []}],
    "two": [{"x": 3.0, "names": []}, {"x": 4.0, "names": ["m"]}],
}


@pytest.fixture(scope="module")
def types():
    return Types(TEXTS)


@pytest.mark.parametrize("name", ALL)
def test_every_kind_of_field_comes_back_as_it_was(types, name):
    kind = types.find("own/msg/All")
    made = make(kind, {name: ALL[name]})
    assert plain(made)[name] == ALL[name]
    assert plain(deserialise(serialise(made), kind))[name] == ALL[name]


def test_fields_that_are_not_named_have_their_defaults(types):
    made = plain(make(types.find("own/msg/All"), {}))
    assert (made["great"], made["text"], made["two"][1]) == (0, "", {"x": 0.0, "names": []})


def test_a_whole_number_is_a_number_and_a_value_alone_the_only_field():
    types = Types({})
    assert plain(make(types.find("std_msgs/msg/Float64"), 3)) == {"data": 3.0}
    assert plain(make(types.find("std_msgs/msg/String"), "a")) == {"data": "a"}
    goal = types.find("example_interfaces/action/Fibonacci").Result
    assert plain(make(goal, [0, 1])) == {"sequence": [0, 1]}
    assert plain(make(types.find("std_msgs/msg/Empty"), {})) == {}


def test_what_json_does_not_have_is_a_text():
    kind = Types({}).find("std_msgs/msg/Float64MultiArray")
    made = plain(make(kind, {"data": [math.nan, math.inf, -math.inf]}))
    assert made["data"] == ["nan", "inf", "-inf"]
    json.dumps(made, allow_nan=False)


WRONG = {
    "no such field": ({"missing": 1}, "All has no field missing, only truth, octet"),
    "no fields": (5, "expected values of truth, octet"),
    "a text for a number": ({"great": "5"}, "great"),
    "a float for a whole number": ({"great": 1.5}, "great"),
    "too great": ({"small": 128}, "small"),
    "an octet too great": ({"octet": 256}, "octet"),
    "a number for a text": ({"text": 5}, "text"),
    "a text too long": ({"brief": "abcdef"}, "brief"),
    "too few": ({"three": [1, 2]}, "three"),
    "too many": ({"few": [1.0, 2.0, 3.0]}, "few"),
    "no list": ({"many": 5}, "expected a list, found 5"),
    "no fields within": ({"inner": 5}, "expected fields with values, found 5"),
    "a wrong field within": ({"inners": [{"y": 1}]}, "Inner has no field y, only x, names"),
    "a number for true": ({"truth": 1}, "truth"),
    "beyond float32": ({"single": 1e39}, "single"),
    "half a character": ({"text": "\ud83d"}, "surrogates"),
}


@pytest.mark.parametrize("what", WRONG)
def test_a_value_that_does_not_fit_is_told_with_its_field(types, what):
    values, words = WRONG[what]
    with pytest.raises(ValueError, match=r"\w") as caught:
        make(types.find("own/msg/All"), values)
    assert words in str(caught.value)


@pytest.mark.parametrize(
    "name", ["own/msg/None", "no_such/msg/String", "std_msgs/srv/String", "antigravity/msg/A"]
)
def test_a_type_that_is_nowhere_is_none(types, name):
    with pytest.raises(NoType, match="there is no"):
        types.find(name)


def test_by_the_definitions_of_a_type_and_its_fields_its_messages_are_read(types):
    made = make(types.use("own/msg/All"), ALL)
    assert types.used.keys() == {"own/msg/All", "own/msg/Inner", "builtin_interfaces/msg/Time"}
    assert types.used["own/msg/Inner"] == "float64 x\nstring[] names\n"
    read = BagTypes(types.used).values(serialise(made), "own/msg/All")
    wide = {"wide": [0xE9, 0xD83D, 0xDE00], "narrow": [ord("b")]}  # as numbers
    assert read == {**ALL, **wide}
    theirs = types_of(types.used).deserialize_cdr(serialise(made), "own/msg/All")
    assert plain_of_rosbags(theirs) == read


def test_what_no_reader_of_bags_knows_is_no_type():
    types = Types({"own/msg/Odd": "wstring[] texts", "own/msg/Outer": "Odd odd"})
    with pytest.raises(NoType, match="lists of wstring"):
        types.use("own/msg/Outer")
    assert types.used == {}


def test_an_empty_message_can_be_read():
    types = Types({})
    made = make(types.use("std_msgs/msg/Empty"), {})
    assert BagTypes(types.used).values(serialise(made), "std_msgs/msg/Empty") == {}
