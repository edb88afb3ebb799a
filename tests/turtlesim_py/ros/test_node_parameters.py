import pytest
from rcl_interfaces.msg import IntegerRange, Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import (
    DescribeParameters,
    GetParameters,
    ListParameters,
    SetParameters,
    SetParametersAtomically,
)

pytestmark = pytest.mark.usefixtures("simulator")

STRING = ParameterValue(type=ParameterType.PARAMETER_STRING, string_value="red")
BOOL = ParameterValue(type=ParameterType.PARAMETER_BOOL, bool_value=True)
ARRAY = ParameterValue(type=ParameterType.PARAMETER_INTEGER_ARRAY, integer_array_value=[1, 2])


def integer(value):
    return ParameterValue(type=ParameterType.PARAMETER_INTEGER, integer_value=value)


def double(value):
    return ParameterValue(type=ParameterType.PARAMETER_DOUBLE, double_value=value)


def set_each(graph, **values):
    parameters = [Parameter(name=name, value=value) for name, value in values.items()]
    answer = graph.call(SetParameters, "/turtlesim/set_parameters", parameters=parameters)
    return [(result.successful, result.reason) for result in answer.results]


def get(graph, *names):
    answer = graph.call(GetParameters, "/turtlesim/get_parameters", names=names)
    return [value.integer_value for value in answer.values]


def test_it_has_the_originals_parameters_and_some_of_its_own(graph):
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


def test_they_are_described_as_in_the_original(graph):
    def described(*names):
        answer = graph.call(DescribeParameters, "/turtlesim/describe_parameters", names=names)
        return list(answer.descriptors)

    for color in ("red", "green", "blue"):
        (found,) = described(f"background_{color[0]}")
        assert found.type == ParameterType.PARAMETER_INTEGER
        assert found.description == f"{color.capitalize()} channel of the background color"
        assert found.integer_range == [IntegerRange(from_value=0, to_value=255, step=1)]
        assert not found.read_only and not found.dynamic_typing
    (found,) = described("holonomic")
    assert found.type == ParameterType.PARAMETER_BOOL
    assert found.description == "If true, then turtles will be holonomic"
    assert not found.integer_range


OUT_OF_RANGE = "Parameter {{{}}} doesn't comply with {} range."
OF_TYPE = (
    "Wrong parameter type, parameter {{{}}} is of type {{{}}}, setting it to {{{}}} is not allowed."
)
READ_ONLY = "parameter '{}' cannot be set because it is read-only"


@pytest.mark.parametrize(
    ("name", "value", "reason", "words"),
    [
        ("background_r", integer(256), OUT_OF_RANGE, ["integer"]),
        ("background_b", integer(-1), OUT_OF_RANGE, ["integer"]),
        ("image_rate", double(-1.0), OUT_OF_RANGE, ["floating point"]),
        ("background_r", STRING, OF_TYPE, ["integer", "string"]),
        ("background_g", double(7.0), OF_TYPE, ["integer", "double"]),
        ("background_g", ARRAY, OF_TYPE, ["integer", "integer_array"]),
        ("holonomic", integer(1), OF_TYPE, ["bool", "integer"]),
        ("holonomic", ParameterValue(), "cannot undeclare a statically typed parameter", []),
        ("foo", BOOL, "parameter '{}' cannot be set because it was not declared", []),
        ("start_type_description_service", BOOL, READ_ONLY, []),
        ("interfaces", STRING, READ_ONLY, []),
        ("turtle_image", STRING, READ_ONLY, []),
    ],
)
def test_a_refusal_has_the_originals_reason(graph, name, value, reason, words):
    assert set_each(graph, **{name: value}) == [(False, reason.format(name, *words))]


def test_a_value_of_an_unknown_type_is_refused_and_an_atomic_call_sets_all_or_none(graph):
    unknown = ParameterValue(type=10)
    refused = set_each(graph, background_r=unknown, nothing=unknown)
    assert refused == [(False, "Unknown type: 10")] * 2
    undeclared = "parameter 'foo' cannot be set because it was not declared"
    for other, reason in (("background_g", "Unknown type: 10"), ("foo", undeclared)):
        values = {"background_r": integer(5), other: BOOL if other == "foo" else unknown}
        parameters = [Parameter(name=name, value=value) for name, value in values.items()]
        name = "/turtlesim/set_parameters_atomically"
        found = graph.call(SetParametersAtomically, name, parameters=parameters).result
        assert (found.successful, found.reason) == (False, reason)
        assert get(graph, "background_r") == [69]


def test_several_parameters_of_one_call_are_judged_each_alone(graph):
    assert get(graph, "background_r", "background_g", "background_b") == [69, 86, 255]
    results = set_each(
        graph, background_r=integer(1), foo=BOOL, background_g=integer(300), background_b=integer(2)
    )
    assert [successful for successful, _ in results] == [True, False, False, True]
    assert get(graph, "background_r", "background_g", "background_b") == [1, 86, 2]
    set_each(graph, background_r=integer(69), background_b=integer(255))
