import math

from hypothesis import given
from hypothesis import strategies as st

from turtlesim_py.world.arena import Arena
from turtlesim_py.world.floats import PI, float32, json_number, normalize_angle, printf_f
from turtlesim_py.world.turtle import SIZE_M

finite = st.floats(-1e6, 1e6)
anything = st.floats(width=32)
commands = st.lists(st.tuples(finite, finite, finite), min_size=1, max_size=20)


def driven(steps, holonomic=False, name="turtle1"):
    arena = Arena(sprite="rolling")
    arena.holonomic = holonomic
    if name != "turtle1":
        arena.kill("turtle1")
        arena.spawn(SIZE_M / 2, SIZE_M / 2, 0.0, name)
    poses = []
    for x, y, turn in steps:
        arena.command(name, (x, y, 0.0), (0.0, 0.0, turn))
        poses += [arena.tick()[name].pose for _ in range(3)]
    return arena, poses


@given(commands, st.booleans())
def test_finite_commands_keep_the_turtle_inside_and_its_heading_normalised(steps, holonomic):
    for pose in driven(steps, holonomic)[1]:
        assert 0.0 <= pose.x <= SIZE_M and 0.0 <= pose.y <= SIZE_M
        assert -PI - 1e-6 <= pose.theta <= PI + 1e-6
        assert pose.linear_velocity >= 0.0
        assert all(value == float32(value) for value in pose)


@given(commands)
def test_a_turtles_name_does_not_change_its_motion(steps):
    assert driven(steps)[1] == driven(steps, name="zoe")[1]


@given(st.lists(st.tuples(anything, anything, anything), max_size=8))
def test_no_input_whatever_stops_the_world(values):
    arena = Arena(sprite="rolling")
    for x, y, theta in values:
        arena.teleport_absolute("turtle1", x, y, theta)
        arena.teleport_relative("turtle1", x, theta)
        arena.command("turtle1", (x, y, 0.0), (0.0, 0.0, theta))
        arena.rotate_absolute("turtle1", theta, "goal")
        arena.spawn(x, y, theta)
        arena.tick()
    assert arena.tick()


@given(st.permutations(["Zoe", "alice", "bob", "turtle10"]))
def test_the_order_of_spawning_does_not_change_the_order_of_updates(names):
    arena = Arena(sprite="rolling")
    for name in names:
        arena.spawn(1.0, 1.0, 0.0, name)
    assert list(arena.tick()) == ["Zoe", "alice", "bob", "turtle1", "turtle10"]


@given(finite)
def test_a_normalised_angle_differs_by_whole_turns(angle):
    turns = (angle - normalize_angle(angle)) / (2 * PI)
    assert math.isclose(turns, round(turns), abs_tol=1e-6)


@given(st.floats())
def test_a_number_is_printed_as_c_prints_it(value):
    text = printf_f(value)
    assert math.isnan(value) == text.endswith("nan")
    assert (math.copysign(1.0, value) < 0) == text.startswith("-")


def test_a_speed_beyond_a_single_is_published_as_infinite():
    arena = Arena(sprite="rolling")
    arena.command("turtle1", (1e200, 0.0, 0.0), (0.0, 0.0, -1e300))
    pose = arena.tick()["turtle1"].pose
    assert (pose.linear_velocity, pose.angular_velocity) == (math.inf, -math.inf)


@given(st.floats(allow_nan=False, allow_infinity=False) | st.integers(-(2**53), 2**53))
def test_a_number_of_17_digits_in_json_is_the_number(value):
    found = json_number(value, 17)
    assert found == value == float(f"{value:.17g}")
    assert isinstance(found, int) == (float(value).is_integer() and abs(value) < 1e15)


@given(
    st.lists(st.tuples(st.sampled_from(["drive", "put", "turn"]), anything, anything), max_size=6)
)
def test_a_turtle_at_rest_publishes_what_its_sums_would_give(inputs):
    shortcut, summed = Arena(sprite="rolling"), Arena(sprite="rolling")
    for kind, x, angle in inputs:
        for arena in (shortcut, summed):
            if kind == "drive":
                arena.command("turtle1", (x, 0.0, 0.0), (0.0, 0.0, angle))
            elif kind == "put":
                arena.teleport_absolute("turtle1", x, 1.0, angle)
            else:
                arena.rotate_absolute("turtle1", angle, "goal")
        for _ in range(70):  # longer than a command moves it
            summed.turtles["turtle1"]._rest = None
            expected, found = (repr(arena.tick()["turtle1"]) for arena in (summed, shortcut))
            assert found == expected
    assert (shortcut.canvas.rgba() == summed.canvas.rgba()).all()
