import re
import signal

import pytest
from geometry_msgs.msg import Twist, Vector3
from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import SetParameters
from rclpy.duration import Duration
from rosgraph_msgs.msg import Clock
from std_srvs.srv import Empty
from turtlesim.msg import Pose

from tests.graph import DEADLINE_S
from tests.programs import Program
from turtlesim_py.ros.node import TurtlesimNode
from turtlesim_py.ros.rclcpp_node import UnusableParameter


def simulator(*arguments):
    return Program("turtlesim_py.ros.node", *arguments)


@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_it_well_and_unknown_words_do_not_matter(how):
    with simulator("--bogus", "word", "--ros-args", "-r", "__ns:=/ended") as program:
        line = program.wait_for_line("shows no window")
        assert line.startswith("[INFO]")
        assert "/ended/turtlesim/image" in line and "/ended/turtlesim/save_canvas" in line
        program.wait_for_line("Spawning turtle [turtle1]")
        assert program.stop(how) == 0
        assert "Traceback" not in program.text()


def test_logs_go_to_stderr_and_nothing_to_stdout():
    named = ["-r", "__ns:=/quiet", "-r", "__node:=painter", "--log-level", "quiet.painter:=debug"]
    with simulator("--ros-args", *named) as program:
        program.wait_for_line("[quiet.painter]: Starting turtlesim with node name /quiet/painter")
        line = program.wait_for_line("[DEBUG]")
        # The original has the namespace in these brackets, and y grows downwards.
        assert line.endswith("[/quiet]: pos_x: 5.544445 pos_y: 5.544445 theta: 0.000000\n")
        program.stop()
        assert program.process.stdout.read() == ""


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        (["-p", "background_r:=300"], "background_r is 300, expected a whole number from 0 to 255"),
        (["-p", "use_sim_time:=7"], "'use_sim_time'"),
        (["--unknown"], "cannot use the ROS arguments: ['--unknown']"),
    ],
)
def test_what_cannot_be_used_is_one_line_and_exit_code_2(arguments, complaint):
    with simulator("--ros-args", *arguments) as program:
        assert program.wait() == 2
        (line,) = program.lines
        assert line.startswith("turtlesim_node: ")
        assert complaint in line


@pytest.mark.usefixtures("ros")
@pytest.mark.parametrize(
    ("override", "complaint"),
    [
        ("background_g:=red", "background_g is 'red', expected a whole number from 0 to 255"),
        ("background_b:=-1", "background_b is -1, expected a whole number from 0 to 255"),
        ("holonomic:=1", "holonomic is 1, expected true or false"),
        ("image_rate:=5", "image_rate is 5, expected a number with a decimal point from 0.0 to"),
        ("canvas_folder:=1", "canvas_folder is 1, expected a string"),
        ("turtle_image:=kame", "turtle_image is 'kame', expected one of ardent, bouncy"),
    ],
)
def test_the_line_says_what_was_found_and_what_is_expected(override, complaint):
    with pytest.raises(UnusableParameter, match=re.escape(complaint)):
        TurtlesimNode(["--ros-args", "-r", "__ns:=/unusable", "-p", override])


@pytest.mark.more("test_program.py has the pacer with clocks of its own")
def test_under_use_sim_time_ticks_and_watchdog_follow_the_clock_topic(graph):
    arguments = ["-p", "use_sim_time:=true", "-r", "__ns:=/simulated"]
    with simulator("--ros-args", *arguments) as program:
        graph.meet("simulated.turtlesim")
        poses = graph.listen(Pose, "/simulated/turtle1/pose")
        # Without a clock: served, but never moved
        for _ in range(3):
            graph.call(Empty, "/simulated/clear")
        assert not poses
        clock = graph.publisher(Clock, "/clock")

        def poses_at(seconds, count):
            """All poses when the clock says so and `count` have come."""
            message = Clock()
            message.clock.sec, message.clock.nanosec = divmod(round(seconds * 1e9), 10**9)

            def arrived():
                clock.publish(message)  # again and again: /clock is best effort
                return len(poses) >= count

            graph.until(arrived, f"{count} poses")
            return poses

        poses_at(100.0, 1)
        command = graph.publisher(Twist, "/simulated/turtle1/cmd_vel")
        command.publish(Twist(linear=Vector3(x=1.0)))
        assert command.wait_for_all_acked(Duration(seconds=DEADLINE_S))
        graph.call(Empty, "/simulated/clear")  # while the clock rests
        assert len(poses) == 1
        # A clock that is coarser than a tick: all ticks in between happen
        poses_at(100.016, 2)
        start = poses[-1].x
        assert poses_at(100.16, 11)[-1].x == pytest.approx(start + 9 * 0.016, abs=1e-5)
        # The watchdog looks at the same clock
        speeds = [pose.linear_velocity for pose in poses_at(101.12, 71)]
        assert speeds[61] == 1.0
        assert speeds[-1] == 0.0
        # Far ahead and back: one tick each, then on from there
        for number, seconds in enumerate((1e6, 1e6 + 0.016, 5.0, 5.016), start=72):
            poses_at(seconds, number)
        graph.call(Empty, "/simulated/clear")
        assert len(poses) == 75
        # Back to the wall clock
        off = ParameterValue(type=ParameterType.PARAMETER_BOOL, bool_value=False)
        parameters = [Parameter(name="use_sim_time", value=off)]
        graph.call(SetParameters, "/simulated/turtlesim/set_parameters", parameters=parameters)
        graph.until(lambda: len(poses) > 85, "poses without /clock")
        assert program.stop() == 0
