import importlib
import sys
from itertools import pairwise
from pathlib import Path

import pytest
import yaml
from rclpy.serialization import deserialize_message, serialize_message
from rclpy.type_support import NoTypeSupportImportedException

from grader.errors import SubmissionError
from grader.ros.classes import described, parts
from grader.ros.definitions import DEEPEST, LONGEST, LONGEST_LINE, Definitions, parse
from grader.ros.messages import deserialise, serialise


def fields(text):
    members = parse("mine/msg/Num", text).structure.members
    return {member.name: described(member.type) for member in members}


def mistake(text, name="mine/msg/Num"):
    with pytest.raises(SubmissionError) as error:
        parse(name, text)
    return str(error.value)


def errors(**messages):
    """What is wrong with the messages of a package `mine`."""
    made = Definitions({f"mine/msg/{name}": text for name, text in messages.items()})
    return {name.removeprefix("mine/msg/"): str(error) for name, error in made.errors.items()}


def test_all_that_the_language_has():
    assert fields(
        "bool b\nbyte o\nchar c\nfloat32 f\nfloat64 d\nuint64 u\nstring s\nwstring w\n"
        "string<=5 sb\nwstring<=6 wb\nint32[] i\nint32[3] i3\nint32[<=4] i4\nstring<=5[<=2] sl\n"
        "Other own\nmine/Other[] more\ngeometry_msgs/Point[2] points\nbuiltin_interfaces/Time t\n"
    ) == {
        **{"b": "boolean", "o": "octet", "c": "uint8", "f": "float", "d": "double", "u": "uint64"},
        **{"s": "string", "w": "wstring", "sb": "string<5>", "wb": "wstring<6>"},
        **{"i": "sequence<int32>", "i3": "int32[3]", "i4": "sequence<int32, 4>"},
        **{"sl": "sequence<string<5>, 2>", "own": "mine/Other", "more": "sequence<mine/Other>"},
        **{"points": "geometry_msgs/Point[2]", "t": "builtin_interfaces/Time"},
    }
    assert fields("") == fields("# nothing\n\n   # at all") == {}


def test_constants_and_defaults():
    text = 'int8 LOW=-0x10\nbyte B=7\nstring WHO = "it\'s me" \nbool b true\nfloat32[] f [1, 2e1]\n'
    made = Definitions({"mine/msg/Num": text})
    kind = made.type("mine/msg/Num")
    assert (kind.LOW, kind.B, kind().WHO) == (-16, b"\x07", "it's me")
    assert (kind().b, kind().f.tolist()) == (True, [1.0, 20.0])


def test_services_and_actions_have_parts():
    service = parse("mine/srv/Add", "int64 a\n---\nint64 sum\n")
    names = [each.structure.namespaced_type.name for each in parts(service)]
    assert names == ["Add_Request", "Add_Response", "Add_Event"]
    assert len(parts(parse("mine/action/Fib", "---\n---\n"))) == 10


MISTAKES = yaml.safe_load(Path(__file__).with_name("mistakes.yaml").read_text(encoding="utf-8"))


@pytest.mark.parametrize("case", MISTAKES, ids=lambda case: case["said"])
def test_a_mistake_is_told_with_its_line_and_what_to_do(case):
    found = mistake(case["text"])
    assert found.startswith("Num.msg") and case["said"] in found


@pytest.mark.parametrize(
    "name",
    [
        *("mine/msg/num", "mine/msg/__init__", "mine/msg/../Num", "mine/msg/a/Num", "mine/Num"),
        *("mine/txt/Num", "/msg/Num", "mine/msg/My_Num", "mine/msg/Num\n", "../msg/Num"),
        *("My/msg/Num", "a__b/msg/Num", "os.path/msg/Num", "a-b/msg/Num"),
        *("mine/msg/None", "class/msg/Num"),
    ],
)
def test_a_file_is_called_as_its_type(name):
    assert "expected a name such as my_interfaces/msg/Num" in mistake("", name)
    assert list(Definitions({name: ""}).errors) == [name]


@pytest.fixture
def importable(monkeypatch):
    def importable(texts):
        monkeypatch.setattr(sys, "meta_path", [*sys.meta_path, Definitions(texts)])

    before = set(sys.modules)
    yield importable
    for name in set(sys.modules) - before:
        if name.startswith("mine_own"):
            del sys.modules[name]


def test_programs_import_them(importable):
    importable(
        {
            "mine_own/msg/Num": "int64 num 3\n",
            "mine_own/srv/Add": "Num[] nums\n---\nNum sum\n",
        }
    )
    from mine_own.msg import Num
    from mine_own.msg._num import Metaclass_Num
    from mine_own.srv import Add
    from mine_own.srv._add import Add_Request

    assert repr(Num()) == "mine_own.msg.Num(num=3)"
    assert type(Num) is Metaclass_Num
    assert Add.Request is Add_Request
    request = Add.Request(nums=[Num(num=1), Num()])
    assert deserialise(serialise(request), Add_Request) == request
    with pytest.raises(AssertionError, match="The 'num' field must be of type 'int'"):
        Num(num=1.5)
    scope = {}
    exec("from mine_own.msg import *", scope)
    assert scope["Num"] is Num


@pytest.mark.parametrize("package", ["mine_own", "example_interfaces"])
def test_the_names_that_are_generated_beside_a_type_can_be_imported_as_of_an_installed_one(
    package, importable
):
    importable(
        {
            "mine_own/srv/AddTwoInts": "---\n",
            "mine_own/action/Fibonacci": "int32 order\n---\nint32[] sequence\n---\n",
            "mine_own/srv/Wrong": "text a\n---\n",
        }
    )
    services = (
        ("srv", "AddTwoInts"),
        ("action", "Fibonacci_SendGoal"),
        ("action", "Fibonacci_GetResult"),
    )
    for kind, service in services:
        for part in ("Request", "Response", "Event"):
            scope = {}
            exec(f"from {package}.{kind} import {service}_{part}", scope)
            exec(f"from {package}.{kind} import *", scope)
            assert scope[f"{service}_{part}"]().get_fields_and_field_types() is not None
    for name in ("Fibonacci_Goal", "Fibonacci_SendGoal", "Metaclass_Fibonacci"):
        with pytest.raises(ImportError, match=f"cannot import name '{name}'"):
            exec(f"from {package}.action import {name}")
    if package == "mine_own":
        with pytest.raises(ImportError, match="line 1: `text` is no type"):
            exec("from mine_own.srv import Wrong_Request")


def test_a_bad_file_leaves_the_others_importable(importable):
    importable(
        {
            "mine_own/msg/Good": "int8 a\n",
            "mine_own/msg/Bad": "int9 a\n",
            "mine_own/msg/Needs": "Bad b\n",
        }
    )
    from mine_own.msg import Good

    assert Good().a == 0
    with pytest.raises(ImportError, match=r"Bad\.msg, line 1: `int9 a` is not understood"):
        from mine_own.msg import Bad  # noqa: F401
    with pytest.raises(
        ImportError, match=r"Needs\.msg, line 1: `mine_own/Bad` has a mistake itself"
    ):
        from mine_own.msg import Needs  # noqa: F401
    with pytest.raises(ImportError, match="cannot import name 'Never'"):
        from mine_own.msg import Never  # noqa: F401
    with pytest.raises(ModuleNotFoundError):
        importlib.import_module("mine_own.srv._num")


def test_rclpy_refuses_them_with_an_exception(importable):
    importable({"mine_own/msg/Num": "int64 num\n"})
    from mine_own.msg import Num

    with pytest.raises(NoTypeSupportImportedException):
        serialize_message(Num())
    with pytest.raises(NoTypeSupportImportedException):
        deserialize_message(serialise(Num()), Num)


def test_types_of_other_packages_are_those_that_are_installed():
    from geometry_msgs.msg import Point

    made = Definitions({"mine/msg/At": "geometry_msgs/Point at\n"})
    kind = made.type("mine/msg/At")
    assert type(kind().at) is Point
    assert deserialise(serialise(kind(at=Point(x=1.0))), kind).at.x == 1.0


def test_an_unknown_type_is_told():
    found = errors(A="int8 a\nHeader h")["A"]
    assert "line 2: `mine/Header` is not known. Write std_msgs/Header." in found
    assert "`std_msgs/Nothing` is not known" in errors(A="std_msgs/Nothing h")["A"]
    # nothing is imported to look for it
    assert "is not known" in errors(A="antigravity/Nothing h")["A"]
    assert "antigravity" not in sys.modules


def test_a_message_does_not_contain_itself():
    assert "line 1: `mine/A` contains itself" in errors(A="A[] a")["A"]
    assert set(errors(A="B b", B="C[<=2] c", C="A a", D="int8 d")) == {"A", "B", "C"}


def test_a_message_that_is_too_large_is_refused():
    for text in ("uint8[3000000000] a", "E[3000000] a", "string[999999] a", "B[9999] b"):
        found = errors(E="", B="float64[9999] b", A=f"int8 x\n{text}")
        assert list(found) == ["A"]
        assert "A.msg, line 2: `" in found["A"] and "too large" in found["A"]
    doubling = {f"D{n}": f"D{n + 1}[2] a\nD{n + 1}[2] b" for n in range(20)}
    assert "D0" in errors(**doubling, D20="")
    assert errors(A="float64[36] a\nuint8[1000000] b\ngeometry_msgs/Point[1000] p") == {}


def test_messages_are_not_nested_without_end():
    names = [f"D{n:04}" for n in range(1000)]
    chain = {name: f"{deeper}[] a" for name, deeper in pairwise(names)}
    found = errors(**chain, D0999="")
    assert len(found) >= 1000 - DEEPEST and "D0999" not in found
    assert any("32 messages within each other" in said for said in found.values())
    upwards = errors(D0999="", **dict(reversed(chain.items())))
    assert len(upwards) == 1000 - DEEPEST


def test_definitions_without_end_are_refused():
    texts = {f"M{n}": "# nothing\n" * (LONGEST // 1000) for n in range(1000)}
    found = errors(**texts)
    assert "M99" not in found and "found more than 300,000 characters" in found["M100"]
    assert f"{LONGEST_LINE:,} in a line" in errors(A="string[] a [" + "'a'," * 9_999 + "]")["A"]


def test_a_default_is_made_anew():
    text = 'int32[] a [1]\nint8[2] b [1, 2]\nstring[] c ["x"]\n'
    kind = Definitions({"mine/msg/A": text}).type("mine/msg/A")
    one = kind()
    one.a.append(2)
    one.b[0] = 5
    one.c.append("y")
    assert kind() == kind(a=[1], b=[1, 2], c=["x"]) != one
