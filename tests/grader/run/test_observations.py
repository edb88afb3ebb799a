"""What is told of a submission's process: whole runs, most of them in virtual time."""

import pytest

from grader.recording.observations import (
    Burst,
    End,
    Observations,
    SlowCallback,
    SourceLine,
    Standstill,
    Wait,
)
from grader.run.handover import Plan
from grader.scenes.scene import Limits
from tests import runs
from turtlesim_py.world.events import CmdVel

SPINS = "rclpy.spin_until_future_complete(self, answer)"
PEN = "self.pen.call(SetPen.Request(r=255, width=3))"


def test_names_types_and_lines_of_all_ends_are_told_and_who_had_the_other_one(recorded):
    seen = recorded("observed/wrong_ends").observations

    def place(line: int, text: str) -> SourceLine:
        return SourceLine("wrong_ends.py", line, "Controller.__init__", text)

    published = SourceLine("wrong_ends.py", 28, "main", "node.velocity.publish(TwistStamped())")
    cmd_vel = 'self.velocity = self.create_publisher(TwistStamped, "/turtle1/cmd_vel", 10)'
    rotation = 'self.rotation = ActionClient(self, RotateAbsolute, "/turtle1/rotate_absolute")'
    assert seen.ends == (
        End("publisher", "/turtle1/cmd_vel", "geometry_msgs/msg/TwistStamped", False, 6,
            place(17, cmd_vel),
            published, (published,), (Burst(0, 6),)),
        End("subscription", "/pose", "turtlesim/msg/Pose", False, 0,
            place(18, 'self.create_subscription(Pose, "/pose", print, 10)')),
        End("subscription", "/turtle1/pose", "turtlesim/msg/Pose", True, 0,
            place(19, 'self.create_subscription(Pose, "turtle1/pose", print, 10)')),
        End("client", "/set_pen", "turtlesim/srv/SetPen", False, 0,
            place(20, 'self.pen = self.create_client(SetPen, "/set_pen")')),
        End("action_client", "/turtle1/rotate_absolute", "turtlesim/action/RotateAbsolute", True, 0,
            place(21, rotation)),
    )  # fmt: skip
    assert (seen.spun_s, seen.returned_s, seen.raised) == (None, 3.0, None)


def test_a_program_that_spins_once_and_is_through_tells_both(recorded):
    seen = recorded("observed/spins_once").observations
    assert (seen.is_known, seen.spun_s, seen.stop) == (True, 0.0, None)
    assert seen.returned_s < 0.1


@pytest.mark.parametrize(
    ("name", "stop"),
    [
        ("never_spins", ("call", 0.0, "Event.wait", 11, "threading.Event().wait()")),
        ("spins_in_callback", ("callback", 0.48, "spin_until_future_complete", 26, SPINS)),
    ],
)
def test_where_it_is_stuck_is_told_with_the_last_line_of_its_own(recorded, name, stop):
    found = recorded(f"misbehaving/{name}").observations.stop
    assert (found.kind, found.time_s, found.call, found.place.line, found.place.text) == stop


@pytest.mark.parametrize(
    ("name", "raised"),
    [
        ("misbehaving/raises_in_callback", ("AttributeError", 0.48, 17, "on_pose")),
        ("misbehaving/exits", ("SystemExit", 1.0, 16, "")),
        ("observed/raises_inside_rclpy", ("AttributeError", 0.5, 10, "tick")),
        ("observed/says_goodbye", ("SystemExit", 0.0, 9, "leave")),
    ],
)
def test_what_ended_it_is_told_with_the_last_line_of_its_own(recorded, name, raised):
    seen = recorded(name).observations
    found = seen.raised
    assert (found.type, found.time_s, found.place.line, found.place.function) == raised
    assert seen.returned_s is None
    assert (found.text == "bye") == name.endswith("goodbye")


def test_of_a_mistake_in_c_the_line_is_told_that_led_to_it(recorded):
    raised = recorded("observed/aborts").observations.raised
    place = SourceLine("aborts.py", 9, "crash", "ctypes.string_at(1)")
    assert (raised.type, raised.place) == ("SIGSEGV", place)


def test_a_loop_without_end_is_told_by_its_line(recorded):
    place = SourceLine("busy_for_ever.py", 13, "", "while True:")
    stop = recorded("misbehaving/busy_for_ever").observations.stop
    assert stop == Standstill("loop", 0.096, "", place)


def test_a_wait_for_what_never_comes_is_told_and_others_are_not(recorded):
    text = "rclpy.spin_until_future_complete(node, pen.call_async(SetPen.Request()))"
    place = SourceLine("waits_for_an_answer.py", 10, "", text)
    seen = recorded("observed/waits_for_an_answer").observations
    assert seen.waits == (Wait("/set_pen", "turtlesim/srv/SetPen", 0.0, None, place),)


def test_who_waits_for_messages_without_spinning_has_heard_them(recorded):
    ends = recorded("observed/waits_for_message").observations.ends
    heard = [(end.name, end.used) for end in ends if end.kind == "subscription"]
    assert heard == [("/turtle1/pose", 1)] * 3


def test_the_timer_of_a_spin_with_a_timeout_is_none_of_the_programs(recorded):
    assert recorded("styles/own_parameters").observations.timers == ()


def test_a_callback_that_sleeps_is_told_by_its_longest_line(recorded):
    seen = recorded("observed/sleeps_in_callback").observations
    place = SourceLine("sleeps_in_callback.py", 12, "pause", "time.sleep(0.15)")
    assert seen.slow == (SlowCallback(place, 0.2, 10),)


def test_of_a_program_that_does_as_it_should_nothing_is_told_but_what_it_used(recorded):
    seen = recorded("styles/timer").observations
    assert [(end.kind, end.name, end.is_met) for end in seen.ends] == [
        ("publisher", "/turtle1/cmd_vel", True),
        ("client", "/turtle1/set_pen", True),
        ("subscription", "/turtle1/pose", True),
    ]
    assert all(end.used for end in seen.ends)
    rest = (seen.waits, seen.slow, seen.stop, seen.raised, seen.returned_s)
    assert rest == ((), (), None, None, None)


# In real time ---------------------------------------------------------------------------------


def in_real_time(name: str) -> Observations:
    return runs.recorded(name, Plan(Limits(2, 0.2, 20)), time="real").observations


def test_in_real_time_it_tells_what_ended_it_and_what_it_has_done():
    seen = in_real_time("misbehaving/raises_in_callback")
    assert seen.raised.place == SourceLine("raises_in_callback.py", 17, "on_pose", "print(pose.z)")
    assert [(end.kind, end.name, end.is_met) for end in seen.ends] == [
        ("publisher", "/turtle1/cmd_vel", True),
        ("subscription", "/turtle1/pose", True),
    ]
    assert seen.spun_s < seen.raised.time_s


@pytest.mark.more("the other one in real time is kept")
def test_in_real_time_it_is_asked_where_it_is_before_it_is_told_to_end():
    seen = in_real_time("misbehaving/calls_in_callback")
    assert (seen.raised, seen.returned_s) == (None, None)
    assert (seen.stop.kind, seen.stop.call) == ("callback", "Client.call")
    assert seen.stop.place == SourceLine("calls_in_callback.py", 15, "on_timer", PEN)


# Numbers of the wrong type --------------------------------------------------------------------


def test_numbers_of_the_wrong_type_are_refused_where_they_are_put_into_a_message(recorded):
    recording = recorded("fields/wrong_colours")
    lines = recording.output.splitlines()
    assert lines[:5] == [
        "The 'r' field must be an unsigned integer in [0, 255]",
        "The 'g' field must be an unsigned integer in [0, 255]",
        "The 'b' field must be of type 'int'",
        "The 'width' field must be of type 'int'",
        "The 'off' field must be of type 'int'",
    ]
    assert lines[-1] == "AssertionError: The 'x' field must be of type 'float'"
    raised = recording.observations.raised
    assert raised.place == SourceLine(
        "wrong_colours.py", 19, "Controller.drive", "twist.linear.x = 2"
    )
    assert [end.is_met for end in recording.observations.ends] == [True]


def test_numbers_of_numpy_and_of_own_classes_are_as_good_as_any(recorded):
    recording = recorded("fields/honest_numbers")
    assert recording.output == ""
    assert [command.linear[0] for command in recording.trace.of_kind(CmdVel)] == [1.0]


# Loops ----------------------------------------------------------------------------------------


def test_an_exception_in_the_thread_that_spins_is_told_though_the_program_goes_on(recorded):
    seen = recorded("observed/thread_dies").observations
    assert seen.raised.place == SourceLine("thread_dies.py", 11, "on_pose", "print(pose.z)")
    assert seen.raised.time_s < 0.1
    assert seen.returned_s == 1.0
    assert recorded("observed/thread_dies").run.exit_code == 0


def test_a_program_that_ends_without_a_word_has_told_that_it_was_there(recorded):
    assert recorded("observed/leaves_without_a_word").observations == Observations(is_known=True)


def test_a_slow_machine_does_not_cut_off_what_it_tells_when_the_run_is_over(recorded):
    (wait,) = recorded("observed/tells_slowly").observations.waits
    assert (wait.name, wait.lasted_s) == ("/set_pen", None)
