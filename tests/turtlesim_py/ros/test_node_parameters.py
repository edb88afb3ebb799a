"""A real node's parameters: what they are, and in whose words they are refused."""

from __future__ import annotations

from typing import Any

import pytest
from geometry_msgs.msg import Twist, Vector3
from rcl_interfaces.msg import IntegerRange, Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import (
    DescribeParameters,
    GetParameters,
    ListParameters,
    SetParameters,
    SetParametersAtomically,
)
from turtlesim.msg import Pose

from tests.graph import Graph

pytestmark = pytest.mark.usefixtures("simulator")

STRING = ParameterValue(type=ParameterType.PARAMETER_STRING, string_value="red")
DOUBLE = ParameterValue(type=ParameterType.PARAMETER_DOUBLE, double_value=7.0)
BOOL = ParameterValue(type=ParameterType.PARAMETER_BOOL, bool_value=True)
ARRAY = ParameterValue(type=ParameterType.PARAMETER_INTEGER_ARRAY, integer_array_value=[1, 2])
NOT_SET = ParameterValue()
OUT_OF_RANGE = "Parameter {{{}}} doesn't comply with integer range."


def integer(value: int) -> ParameterValue:
    return ParameterValue(type=ParameterType.PARAMETER_INTEGER, integer_value=value)


def set_each(graph: Graph, **values: ParameterValue) -> list[tuple[bool, str]]:
    """Set several in one call: success and reason of each."""
    parameters = [Parameter(name=name, value=value) for name, value in values.items()]
    answer: Any = graph.call(SetParameters, "/turtlesim/set_parameters", parameters=parameters)
    return [(result.successful, result.reason) for result in answer.results]


def get(graph: Graph, *names: str) -> list[Any]:
    answer: Any = graph.call(GetParameters, "/turtlesim/get_parameters", names=names)
    return [value.integer_value for value in answer.values]


def test_it_has_the_originals_parameters_and_some_of_its_own(graph: Graph) -> None:
    names = graph.call(ListParameters, "/turtlesim/list_parameters").result.names
    assert sorted(names) == [
        "background_b",
        "background_g",
        "background_r",
        "canvas_folder",
        "holonomic",
        "image_rate",
        "interfaces",
        "start_type_description_service",
        "turtle_image",
        "use_sim_time",
        "view_host",
        "view_port",
        "view_read_only",
        "view_token",
    ]


@pytest.mark.parametrize(
    ("name", "description"),
    [
        ("background_r", "Red channel of the background color"),
        ("background_g", "Green channel of the background color"),
        ("background_b", "Blue channel of the background color"),
    ],
)
def test_the_background_is_described_as_in_the_original(
    graph: Graph, name: str, description: str
) -> None:
    answer = graph.call(DescribeParameters, "/turtlesim/describe_parameters", names=[name])
    (found,) = answer.descriptors
    assert (found.name, found.type) == (name, ParameterType.PARAMETER_INTEGER)
    assert found.description == description
    assert found.integer_range == [IntegerRange(from_value=0, to_value=255, step=1)]
    assert not found.read_only and not found.dynamic_typing


def test_holonomic_is_described_as_in_the_original(graph: Graph) -> None:
    answer = graph.call(DescribeParameters, "/turtlesim/describe_parameters", names=["holonomic"])
    (found,) = answer.descriptors
    assert found.type == ParameterType.PARAMETER_BOOL
    assert found.description == "If true, then turtles will be holonomic"
    assert not found.integer_range


def test_the_background_starts_in_the_originals_blue(graph: Graph) -> None:
    assert get(graph, "background_r", "background_g", "background_b") == [69, 86, 255]


@pytest.mark.parametrize(
    ("name", "value", "reason"),
    [
        ("background_r", integer(256), OUT_OF_RANGE.format("background_r")),
        ("background_b", integer(-1), OUT_OF_RANGE.format("background_b")),
        (
            "background_r",
            STRING,
            "Wrong parameter type, parameter {background_r} is of type {integer}, "
            "setting it to {string} is not allowed.",
        ),
        (
            "background_g",
            DOUBLE,
            "Wrong parameter type, parameter {background_g} is of type {integer}, "
            "setting it to {double} is not allowed.",
        ),
        (
            "background_g",
            ARRAY,
            "Wrong parameter type, parameter {background_g} is of type {integer}, "
            "setting it to {integer_array} is not allowed.",
        ),
        (
            "holonomic",
            integer(1),
            "Wrong parameter type, parameter {holonomic} is of type {bool}, "
            "setting it to {integer} is not allowed.",
        ),
        ("holonomic", NOT_SET, "cannot undeclare a statically typed parameter"),
        ("foo", BOOL, "parameter 'foo' cannot be set because it was not declared"),
        (
            "start_type_description_service",
            BOOL,
            "parameter 'start_type_description_service' cannot be set because it is read-only",
        ),
        ("interfaces", STRING, "parameter 'interfaces' cannot be set because it is read-only"),
        ("turtle_image", STRING, "parameter 'turtle_image' cannot be set because it is read-only"),
        (
            "image_rate",
            ParameterValue(type=ParameterType.PARAMETER_DOUBLE, double_value=-1.0),
            "Parameter {image_rate} doesn't comply with floating point range.",
        ),
    ],
)
def test_a_refusal_has_the_originals_reason(
    graph: Graph, name: str, value: ParameterValue, reason: str
) -> None:
    assert set_each(graph, **{name: value}) == [(False, reason)]


def test_a_value_of_a_type_that_ros_does_not_have_is_refused(graph: Graph) -> None:
    unknown = ParameterValue(type=10)
    assert (
        set_each(graph, background_r=unknown, nothing=unknown) == [(False, "Unknown type: 10")] * 2
    )
    answer = graph.call(
        SetParametersAtomically,
        "/turtlesim/set_parameters_atomically",
        parameters=[
            Parameter(name="background_r", value=integer(5)),
            Parameter(name="background_g", value=unknown),
        ],
    )
    assert (answer.result.successful, answer.result.reason) == (False, "Unknown type: 10")
    assert get(graph, "background_r") == [69]


def test_several_parameters_of_one_call_are_judged_each_alone(graph: Graph) -> None:
    results = set_each(
        graph, background_r=integer(1), foo=BOOL, background_g=integer(300), background_b=integer(2)
    )
    assert [successful for successful, _ in results] == [True, False, False, True]
    assert get(graph, "background_r", "background_g", "background_b") == [1, 86, 2]
    set_each(graph, background_r=integer(69), background_b=integer(255))


def test_an_atomic_call_sets_all_or_none(graph: Graph) -> None:
    wanted = {"background_r": integer(5), "foo": BOOL}
    answer = graph.call(
        SetParametersAtomically,
        "/turtlesim/set_parameters_atomically",
        parameters=[Parameter(name=name, value=value) for name, value in wanted.items()],
    )
    assert not answer.result.successful
    assert answer.result.reason == "parameter 'foo' cannot be set because it was not declared"
    assert get(graph, "background_r") == [69]


def test_holonomic_lets_a_turtle_go_sideways(graph: Graph, turtle: str) -> None:
    poses = graph.listen(Pose, f"/{turtle}/pose")
    publisher = graph.publisher(Twist, f"/{turtle}/cmd_vel")
    assert set_each(graph, holonomic=BOOL) == [(True, "")]
    publisher.publish(Twist(linear=Vector3(y=1.0)))
    graph.until(lambda: poses and poses[-1].y > 5.6, "a way to the left")
    assert poses[-1].x == 5.5
    off = ParameterValue(type=ParameterType.PARAMETER_BOOL, bool_value=False)
    assert set_each(graph, holonomic=off) == [(True, "")]
