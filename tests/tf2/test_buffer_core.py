"""The rules of tf2's buffer, one by one, and the words that it has for everything.

They are those of geometry2 0.36, Jazzy's. Where ROS is sourced this looks at ROS's own tf2_py.
"""

import math
from pathlib import Path

import pytest
import yaml
from builtin_interfaces.msg import Time as TimeMessage
from rclpy.duration import Duration
from rclpy.time import Time
from tf2_py import (
    BufferCore,
    ConnectivityException,
    ExtrapolationException,
    InvalidArgumentException,
    LookupException,
    TimeoutException,
    TransformException,
)

from .transforms import UNTURNED, at, quaternion, stamp_s, transform, xyz

LATEST = Time()


@pytest.fixture
def buffer():
    return BufferCore()


def give(buffer: BufferCore, *transforms, static: bool = False) -> None:
    for one in transforms:
        (buffer.set_transform_static if static else buffer.set_transform)(one, "a test")


def x(buffer: BufferCore, target: str, source: str, time=LATEST) -> float:
    return buffer.lookup_transform_core(target, source, time).transform.translation.x


# what it keeps


def test_transforms_are_kept_for_ten_seconds_or_a_length_that_is_given(buffer, capfd):
    give(buffer, *(transform("odom", "base", t, (t, 0, 0)) for t in (1, 2, 11)))
    assert x(buffer, "odom", "base", at(1)) == 1  # exactly as old as may be
    give(buffer, transform("odom", "base", 12, (12, 0, 0)))
    give(buffer, transform("odom", "base", 12, (13, 0, 0)))  # looks what is too old, as all do
    with pytest.raises(ExtrapolationException, match=r"the earliest data is at time 2\.000000"):
        x(buffer, "odom", "base", at(1))
    assert capfd.readouterr().err == ""
    shorter = BufferCore(Duration(seconds=2))
    give(shorter, *(transform("odom", "base", t) for t in (1, 3, 4, 5)))
    with pytest.raises(ExtrapolationException, match=r"the earliest data is at time 3\.000000"):
        x(shorter, "odom", "base", at(1))


def test_what_is_older_than_that_is_refused_with_a_warning(buffer, capfd):
    give(buffer, transform("odom", "base", 20.5), transform("odom", "base", 10.5, (1, 0, 0)))
    assert x(buffer, "odom", "base", at(10.5)) == 1  # exactly as old as may be
    assert capfd.readouterr().err == ""
    give(buffer, transform("odom", "base", 10.4))
    lines = capfd.readouterr().err.splitlines()
    assert lines[:2] == [
        "Warning: TF_OLD_DATA ignoring data from the past for frame base at time 10.400000 "
        "according to authority a test",
        "Possible reasons are listed at http://wiki.ros.org/tf/Errors%20explained",
    ]
    with pytest.raises(ExtrapolationException, match=r"the earliest data is at time 10\.500000"):
        x(buffer, "odom", "base", at(10.4))


def test_what_comes_late_is_put_in_its_place(buffer):
    give(buffer, *(transform("odom", "base", t, (t, 0, 0)) for t in (1, 3, 2)))
    assert x(buffer, "odom", "base", at(2)) == 2
    assert x(buffer, "odom", "base", at(2.5)) == 2.5
    assert x(buffer, "odom", "base") == 3


def test_of_equal_stamps_both_are_kept_and_the_last_heard_is_the_latest(buffer):
    give(buffer, transform("odom", "base", 1, (1, 0, 0)), transform("odom", "base", 1, (3, 0, 0)))
    assert x(buffer, "odom", "base", at(1)) == 3
    give(buffer, transform("odom", "base", 2, (3, 0, 0)))
    assert x(buffer, "odom", "base", at(1)) == 1  # the oldest there is
    assert "rate: 3.000" in buffer.all_frames_as_yaml()


def test_the_very_same_again_is_not_kept_and_not_warned_of(buffer, capfd):
    give(buffer, *[transform("odom", "base", 1), transform("odom", "base", 2)] * 3)
    assert "rate: 2.000" in buffer.all_frames_as_yaml()
    assert capfd.readouterr().err == ""


def test_a_frame_has_one_parent_at_a_time(buffer):
    give(buffer, transform("odom", "base", 1, (1, 0, 0)), transform("map", "base", 2, (9, 0, 0)))
    assert x(buffer, "map", "base") == 9
    with pytest.raises(ConnectivityException):
        x(buffer, "odom", "base")
    # between the two it is where it was, not on the way
    assert x(buffer, "odom", "base", at(1.9)) == 1


def test_a_leading_slash_is_taken_off_what_comes_in_and_only_one(buffer):
    give(buffer, transform("/odom", "/base", 1, (1, 0, 0)), transform("//odom", "/other", 1))
    assert x(buffer, "odom", "base") == 1
    assert buffer._getFrameStrings() == ["base", "odom", "other", "/odom"]


def test_a_static_transform_holds_at_all_times(buffer):
    give(buffer, transform("base", "laser", 5, (1, 0, 0)), static=True)
    for time in (LATEST, at(1), at(1e9)):
        found = buffer.lookup_transform_core("base", "laser", time)
        assert (xyz(found), found.header.stamp) == ([1, 0, 0], time.to_msg())


def test_a_static_transform_replaces_what_there_was_and_the_other_way_round(buffer):
    give(buffer, transform("a", "b", 1, (1, 0, 0)))
    give(buffer, transform("a", "b", 9, (5, 0, 0)), transform("a", "b", 0, (2, 0, 0)), static=True)
    assert x(buffer, "a", "b", at(77)) == 2
    give(buffer, transform("a", "b", 1, (3, 0, 0)))
    with pytest.raises(ExtrapolationException):
        x(buffer, "a", "b", at(77))
    assert x(buffer, "a", "b", at(1)) == 3


def test_clearing_forgets_what_moves_keeps_what_is_static_and_knows_all_names(buffer):
    give(buffer, transform("odom", "base", 1))
    give(buffer, transform("base", "laser", 1, (1, 0, 0)), static=True)
    buffer.clear()
    assert x(buffer, "base", "laser") == 1
    with pytest.raises(ConnectivityException):
        x(buffer, "odom", "base")
    with pytest.raises(ExtrapolationException) as raised:
        x(buffer, "odom", "base", at(1))
    assert str(raised.value) == ", when looking up transform from frame [base] to frame [odom]"
    assert buffer._frameExists("odom")
    assert buffer.all_frames_as_string() == (
        "Frame base exists with parent NO_PARENT.\nFrame laser exists with parent base.\n"
    )


# what it refuses

NAN = math.nan
REFUSED = {
    "the same frame twice": (
        transform("/a", "a"),
        'Error:   TF_SELF_TRANSFORM: Ignoring transform from authority "a test" with frame_id and '
        ' child_frame_id "a" because they are the same',
    ),
    "no child": (
        transform("a", ""),
        'Error:   TF_NO_CHILD_FRAME_ID: Ignoring transform from authority "a test" because '
        "child_frame_id not set ",
    ),
    "no parent": (
        transform("", "a"),
        'Error:   TF_NO_FRAME_ID: Ignoring transform with child_frame_id "a"  from authority '
        '"a test" because frame_id not set',
    ),
    "NaN": (
        transform("a", "b", 0, (1, NAN, 3)),
        'Error:   TF_NAN_INPUT: Ignoring transform for child_frame_id "b" from authority "a test" '
        "because of a nan value in the transform "
        "(1.000000 nan 3.000000) (0.000000 0.000000 0.000000 1.000000)",
    ),
}


def errors(text: str) -> list[str]:
    """The lines of a log but those that name a line of C++."""
    return [line for line in text.splitlines() if not line.startswith("         at line")]


@pytest.mark.parametrize("name", REFUSED)
def test_what_cannot_be_is_refused_with_an_error_and_not_kept(buffer, capfd, name):
    refused, words = REFUSED[name]
    give(buffer, refused)
    assert errors(capfd.readouterr().err) == [words]
    assert buffer._getFrameStrings() == []


@pytest.mark.parametrize("q", [(0, 0, 0, 0), (0, 0, 0, 5e-324), (0, 0, 0, 5e-315)])
def test_a_quaternion_without_a_length_is_refused_with_two_errors(buffer, capfd, q):
    """The last two are what an int and a float32 become on their way through a message."""
    give(buffer, transform("a", "b", 0, (1, 2, 3), q))
    nan, invalid = errors(capfd.readouterr().err)
    assert nan == (
        'Error:   TF_NAN_INPUT: Ignoring transform for child_frame_id "b" from authority "a test" '
        "because of a nan value in the transform (1.000000 2.000000 3.000000) (-nan -nan -nan -nan)"
    )
    assert invalid == (
        'Error:   TF_DENORMALIZED_QUATERNION: Ignoring transform for child_frame_id "b" from '
        'authority "a test" because of an invalid quaternion in the transform '
        "(-nan -nan -nan -nan)"
    )
    assert buffer._getFrameStrings() == []


def test_everything_is_said_of_a_transform_that_is_wrong_in_every_way(buffer, capfd):
    give(buffer, transform("", "", 0, (NAN, 0, 0), (NAN, 0, 0, 1)))
    assert [line.split()[1] for line in errors(capfd.readouterr().err)] == [
        *("TF_SELF_TRANSFORM:", "TF_NO_CHILD_FRAME_ID:", "TF_NO_FRAME_ID:"),
        *("TF_NAN_INPUT:", "TF_DENORMALIZED_QUATERNION:"),
    ]


def test_a_quaternion_of_another_length_is_made_one_of_length_one(buffer, capfd):
    """The original looks at the length only after it has gone by way of a matrix."""
    give(buffer, transform("a", "b", 1, turned=(0, 0, 3, 4)))
    assert quaternion(buffer.lookup_transform_core("a", "b", LATEST)) == pytest.approx(
        [0, 0, 0.6, 0.8], abs=1e-15
    )
    assert capfd.readouterr().err == ""


@pytest.mark.parametrize(
    ("given", "found"),
    [
        ((0, 0, 0.6, -0.8), (0, 0, -0.6, 0.8)),
        ((0, 0, -1, 0), (0, 0, 1, 0)),
        ((-0.8, 0.6, 0, 0), (0.8, -0.6, 0, 0)),
        ((0.8, 0, 0.36, -0.48), (0.8, 0, 0.36, -0.48)),
        ((0.5, -0.5, 0.5, -0.5), (0.5, -0.5, 0.5, -0.5)),
    ],
)
def test_of_the_two_quaternions_of_a_rotation_one_is_given(buffer, given, found):
    """That with a positive w; with |w| ≤ ½, that with the largest of the others positive."""
    give(buffer, transform("a", "b", 1, turned=given))
    assert quaternion(buffer.lookup_transform_core("a", "b", LATEST)) == pytest.approx(found)


# what it answers


@pytest.fixture
def robot(buffer):
    """Map -> odom -> base -> laser (static), and a robot beside it in a tree of its own."""
    give(buffer, *(transform("map", "odom", t, (t, 0, 0)) for t in (1, 2, 3)))
    give(buffer, *(transform("odom", "base", t, (0, t, 0)) for t in (2, 3, 4)))
    give(buffer, transform("base", "laser", 0, (0, 0, 1)), static=True)
    give(buffer, transform("world", "other", 2))
    return buffer


def test_the_answer_is_where_the_source_is_in_the_target_and_the_way_back_the_inverse(robot):
    found = robot.lookup_transform_core("map", "laser", at(2))
    assert (found.header.frame_id, found.child_frame_id) == ("map", "laser")
    assert (xyz(found), quaternion(found), stamp_s(found)) == ([2, 2, 1], [*UNTURNED], 2)
    assert xyz(robot.lookup_transform_core("laser", "map", at(2))) == [-2, -2, -1]
    # a time may be a message, too
    assert x(robot, "map", "odom", TimeMessage(sec=2)) == x(robot, "map", "odom", at(2)) == 2


def test_time_zero_is_the_latest_time_that_the_whole_way_has(robot):
    assert stamp_s(robot.lookup_transform_core("map", "laser", LATEST)) == 3
    assert stamp_s(robot.lookup_transform_core("odom", "laser", LATEST)) == 4
    assert stamp_s(robot.lookup_transform_core("base", "laser", LATEST)) == 0
    assert robot.get_latest_common_time("map", "laser") == at(3)
    assert robot.get_latest_common_time("laser", "base") == Time()


def test_what_is_above_the_way_does_not_make_it_older(buffer):
    give(buffer, transform("map", "odom", 1))
    give(buffer, transform("odom", "base", 5), transform("odom", "arm", 4))
    assert buffer.get_latest_common_time("base", "arm") == at(4)
    assert buffer.get_latest_common_time("arm", "base") == at(4)


def test_a_frame_is_in_itself_at_any_time_even_if_nobody_knows_it(robot):
    for frame, time, stamp in [("map", at(99), 99), ("odom", LATEST, 3), ("mars", LATEST, 0)]:
        found = robot.lookup_transform_core(frame, frame, time)
        assert (xyz(found), quaternion(found)) == ([0, 0, 0], [*UNTURNED])
        assert stamp_s(found) == stamp
    can, why = robot.can_transform_core("mars", "mars", LATEST)
    assert (can, type(can), why) == (1, int, "")


LOOKUPS = yaml.safe_load(Path(__file__).with_name("lookups.yaml").read_text(encoding="utf-8"))


@pytest.mark.parametrize("lookup", LOOKUPS, ids=lambda lookup: lookup["raises"])
def test_where_there_is_no_answer_it_says_why(robot, lookup):
    target, source, time = lookup["asked"]
    with pytest.raises(TransformException) as raised:
        robot.lookup_transform_core(target, source, at(time))
    assert (type(raised.value).__name__, str(raised.value)) == (lookup["raises"], lookup["says"])
    can = lookup.get("can", lookup["says"])
    answer = robot.can_transform_core(target, source, at(time))
    assert (answer, type(answer[0])) == ((0, can), int)


def test_frames_in_a_circle_are_a_loop(buffer):
    give(buffer, *(transform(f"f{(n + 1) % 3}", f"f{n}", 1) for n in range(3)))
    give(buffer, transform("map", "odom", 1))
    for time in (LATEST, at(1)):
        with pytest.raises(LookupException) as raised:
            buffer.lookup_transform_core("odom", "f0", time)
        assert str(raised.value) == (
            f"The tf tree is invalid because it contains a loop.\n{buffer.all_frames_as_string()}\n"
        )
        assert buffer.can_transform_core("odom", "f0", time)[0] == 0


def test_a_thousand_frames_in_a_row_are_no_loop(buffer):
    for n in range(1000):
        give(buffer, transform(f"f{n}", f"f{n + 1}", 1, (1, 0, 0)))
    assert x(buffer, "f0", "f1000") == 1000
    give(buffer, transform("f1000", "f1001", 1))
    with pytest.raises(LookupException, match="contains a loop"):
        x(buffer, "f0", "f1001")


def test_between_two_times_a_frame_is_taken_that_has_not_moved(robot):
    """Where base was at 4 s in what odom is in at 1 s, map standing still: not at one time."""
    give(robot, transform("map", "odom", 4, (4, 0, 0)))
    found = robot.lookup_transform_full_core("odom", at(1), "base", at(3), "map")
    assert xyz(found) == [3 - 1, 3, 0]
    assert stamp_s(found) == 1
    assert robot.can_transform_full_core("odom", at(1), "base", at(3), "map") == (1, "")


def test_every_frame_of_a_lookup_between_two_times_has_to_be_known(robot):
    way = ("odom", at(1), "base", at(3), "mars")
    with pytest.raises(LookupException) as raised:
        robot.lookup_transform_full_core(*way)
    assert str(raised.value) == (
        '"mars" passed to lookupTransform argument fixed_frame does not exist. '
    )
    assert robot.can_transform_full_core(*way) == (
        0,
        'Invalid frame ID "mars" passed to canTransform argument fixed_frame - '
        "frame does not exist",
    )


def test_the_latest_common_time_of_frames_without_one_is_an_exception(robot):
    with pytest.raises(LookupException) as raised:
        robot.get_latest_common_time("map", "mars")
    assert str(raised.value) == '"mars" passed to get_latest_common_time does not exist. '
    with pytest.raises(TransformException, match="not part of the same tree") as other:
        robot.get_latest_common_time("map", "other")
    assert type(other.value) is TransformException


def test_there_are_five_exceptions_below_one():
    kinds = (
        *(ConnectivityException, ExtrapolationException, InvalidArgumentException),
        *(LookupException, TimeoutException),
    )
    assert all(kind.__bases__ == (TransformException,) for kind in kinds)
    assert TransformException.__bases__ == (Exception,)


@pytest.mark.parametrize(
    ("question", "words"),
    [
        ((1, "a", LATEST), "argument 1 must be str, not int"),
        (("a", None, LATEST), "argument 2 must be str, not None"),
        (("a", "b", 0.0), "time must have sec and nanosec, or nanoseconds."),
    ],
)
def test_what_is_no_name_no_time_or_no_duration_is_a_type_error(buffer, question, words):
    with pytest.raises(TypeError, match=words):
        buffer.lookup_transform_core(*question)
    with pytest.raises(TypeError, match=r"duration must have sec and nanosec, or nanoseconds\."):
        BufferCore(10.0)


# what it tells of itself


def test_all_frames_are_told_as_text_and_as_yaml(buffer):
    assert (buffer.all_frames_as_string(), buffer.all_frames_as_yaml()) == ("", "[]")
    give(buffer, *(transform("odom", "base", t) for t in (1.5, 2, 3.5)))
    give(buffer, transform("base", "laser", 7), static=True)
    assert buffer.all_frames_as_string() == (
        "Frame base exists with parent odom.\nFrame laser exists with parent base.\n"
    )
    assert buffer.all_frames_as_yaml() == (
        "base: \n"
        "  parent: 'odom'\n"
        "  broadcaster: 'a test'\n"
        "  rate: 1.500\n"
        "  most_recent_transform: 3.500000\n"
        "  oldest_transform: 1.500000\n"
        "  buffer_length: 2.000\n"
        "laser: \n"
        "  parent: 'base'\n"
        "  broadcaster: 'a test'\n"
        "  rate: 10000.000\n"
        "  most_recent_transform: 0.000000\n"
        "  oldest_transform: 0.000000\n"
        "  buffer_length: 0.000\n"
    )
