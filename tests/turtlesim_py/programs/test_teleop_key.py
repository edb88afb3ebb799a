import os
import pty
import signal
import subprocess
import termios
import time
from contextlib import contextmanager

import pytest
from std_srvs.srv import Empty
from turtlesim.msg import Pose

from tests.programs import Program

#: In the words of turtlesim 1.8.4.
GREETING = [
    "Reading from keyboard",
    "---------------------------",
    "Use arrow keys to move the turtle.",
    "Use g|b|v|c|d|e|r|t keys to rotate to absolute orientations. 'f' to cancel a rotation.",
    "'q' to quit.",
]


class Teleop:
    def __init__(self, *arguments):
        self._user, self._terminal = pty.openpty()
        self.found = termios.tcgetattr(self._terminal)
        self.program = Program(
            "tests.shell",
            "turtlesim_py.programs.teleop_key",
            *arguments,
            stdin=self._terminal,
            stdout=self._terminal,
        )

    def close(self):
        if self.program.process.poll() is None:
            self.type("q")
            self.program.wait()
        self.program.__exit__()
        for end in (self._user, self._terminal):
            os.close(end)

    def wait_for_help(self):
        shown = b""
        while b"quit." not in shown:
            shown += os.read(self._user, 1024)
        return shown.decode()

    def type(self, keys):
        os.write(self._user, keys.encode())

    def attributes(self):
        return termios.tcgetattr(self._terminal)

    def shows_keys(self):
        return bool(termios.tcgetattr(self._terminal)[3] & termios.ECHO)


@contextmanager
def teleop(*arguments):
    running = Teleop(*arguments)
    try:
        assert running.wait_for_help().splitlines() == GREETING
        yield running
    finally:
        running.close()


def test_keys_drive_and_turn_the_turtle(graph, simulator):
    graph.call(Empty, "/reset")
    with teleop("--ros-args", "-p", "scale_linear:=1.0", "-p", "scale_angular:=3.0") as driver:
        # the simulator hears it, and the reverse
        graph.until(lambda: graph.node.count_publishers("/turtle1/cmd_vel") == 1, "the driver")
        poses = graph.listen(Pose, "/turtle1/pose")

        def wait_for_speeds(linear, angular):
            def has_them():
                last = poses[-1] if poses else Pose()
                return (last.linear_velocity, last.angular_velocity) == (linear, angular)

            graph.until(has_them, f"speeds {linear}, {angular}")

        first = len(poses)

        def drives():
            driver.type("\x1b[A")  # again: the first may be before the simulator listens
            return any(pose.linear_velocity == 1.0 for pose in poses[first:])

        graph.until(drives, "motion")
        driver.type("\x1b[D")
        wait_for_speeds(0.0, 3.0)
        driver.type("\x1b[C")
        wait_for_speeds(0.0, -3.0)
        driver.type("\x1b[B")
        wait_for_speeds(1.0, 0.0)  # the pose shows no sign
        begin = len(simulator.lines)

        def turns():
            driver.type("t")  # again: the first goal may be before the simulator is found
            done = "Rotation goal completed successfully"
            return any(done in line for line in simulator.lines[begin:])

        graph.until(turns, "the turn")
        graph.until(lambda: abs(poses[-1].theta - 0.7854) < 0.03, "the heading")
        driver.type("c")
        graph.until(lambda: poses[-1].angular_velocity != 0.0, "another rotation")
        driver.type("F")
        simulator.wait_for_line("Rotation goal canceled", begin)
        driver.type("q")
        assert driver.program.wait() == 0
        assert driver.attributes() == driver.found


@pytest.mark.parametrize(
    "end",
    [
        pytest.param(lambda d: d.type("\x03"), id="Ctrl-C"),
        *(
            pytest.param(
                lambda d, number=number: d.program.process.send_signal(number),
                marks=pytest.mark.more("test_keyboard.py has the signals"),
                id=number.name,
            )
            for number in (signal.SIGTERM, signal.SIGHUP)
        ),
    ],
)
def test_the_terminal_is_restored_however_it_ends_and_for_a_pause(end):
    with teleop("--ros-args", "-r", "__ns:=/alone") as driver:
        assert not driver.shows_keys()
        driver.type("g")
        driver.program.wait_for_line("is turtlesim_node running?")
        for _ in range(2):
            begin = len(driver.program.lines)
            driver.type("\x1a")
            driver.program.wait_for_line("stopped", begin)
            assert driver.attributes() == driver.found
            driver.program.process.send_signal(signal.SIGUSR1)
            while driver.shows_keys():
                time.sleep(0.005)
        begin = len(driver.program.lines)
        end(driver)
        assert driver.program.wait() == 0
        assert driver.attributes() == driver.found
        assert driver.program.lines[begin:] == []


def test_without_a_terminal_it_is_one_line_and_exit_code_2():
    with Program("turtlesim_py.programs.teleop_key", stdin=subprocess.DEVNULL) as program:
        assert program.wait() == 2
        (line,) = program.lines
        assert line == (
            "turtle_teleop_key: standard input is not a terminal: start it in one of its own\n"
        )
