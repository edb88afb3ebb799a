"""Drive turtle1 with the keyboard: the original's turtle_teleop_key.

The letter keys lie around F as the headings lie around the turtle: G is right, R is up, and so on.
"""

from __future__ import annotations

import os
import re
import select
import signal
import sys
from collections.abc import Callable, Iterator
from typing import Any, Self

from geometry_msgs.msg import Twist
from rclpy.action import ActionClient

from turtlesim_py.ros import program
from turtlesim_py.ros.executor import TickExecutor
from turtlesim_py.ros.rclcpp_node import RclcppNode, UnusableStart
from turtlesim_py.ros.turtle_endpoints import TOPIC_QOS

try:
    import termios
except ImportError:  # Windows
    termios = None  # type: ignore[assignment]

#: The original's words, since 1.8.3 with the keys as a keyboard of Linux gives them.
HELP = """\
Reading from keyboard
---------------------------
Use arrow keys to move the turtle.
Use g|b|v|c|d|e|r|t keys to rotate to absolute orientations. 'f' to cancel a rotation.
'q' to quit.
"""
#: Printed by --help.
ABOUT = """\
Drive turtle1 with the keyboard of this terminal: arrow keys drive, the letters round F turn to a
heading, F cancels a turn, Q ends. A turtlesim_node has to be running.

parameters:
    scale_linear     speed ahead and back [m/s] (2.0)
    scale_angular    speed of a turn [rad/s] (2.0)
    interfaces       package of the messages: turtlesim or turtlesim_msgs"""
#: Key -> how far ahead and how far to the left, in units of the scales.
DRIVE = {"up": (1.0, 0.0), "down": (-1.0, 0.0), "left": (0.0, 1.0), "right": (0.0, -1.0)}
#: Key -> absolute heading [rad]; the original's digits.
HEADINGS = {
    "g": 0.0,
    "t": 0.7854,
    "r": 1.5708,
    "e": 2.3562,
    "d": 3.1416,
    "c": -2.3562,
    "v": -1.5708,
    "b": -0.7854,
}
#: Between two polls of what the graph has sent [s].
PAUSE_S = 0.02
#: The last letter of what an arrow key sends, in a terminal's normal or application mode.
ARROWS = {b"A": "up", b"B": "down", b"C": "right", b"D": "left"}
#: What a key sends: a letter behind ESC O or ESC [, perhaps with digits for a held key; with Alt,
#: ESC and a character; else one character.
KEY = re.compile(rb"\x1bO(.)|\x1b\[([0-9;]*[A-Za-z~])|\x1b[^O\[]|(?s:.)")
#: A beginning of these, of which more is to come.
UNFINISHED = re.compile(rb"\x1b(O|\[[0-9;]*)?\Z")


class NotATerminal(UnusableStart):
    """Keys cannot be read one by one from this file."""


class Keyboard:
    """A context in which a terminal gives every key at once and shows none of them.

    Ctrl-Z gives the terminal back for the pause. SIGHUP and SIGQUIT, which would end the program
    on the spot, only close the keyboard; SIGINT and SIGTERM are left to the program.

    Attributes:
        closed: nothing more will come.

    Raises:
        NotATerminal: `file` is none.
    """

    def __init__(self, file: int) -> None:
        if termios is None:
            raise NotATerminal("this system has no termios, which gives single keys")
        if not os.isatty(file):
            raise NotATerminal("standard input is not a terminal: start it in one of its own")
        self.closed = False
        self._file = file
        self._is_ours = False
        self._rest = b""

    def __enter__(self) -> Self:
        self._found = termios.tcgetattr(self._file)
        handlers: dict[signal.Signals, Any] = {
            signal.SIGHUP: self._close,
            signal.SIGQUIT: self._close,
            signal.SIGTSTP: self._pause,
            signal.SIGCONT: self._acquire,
        }
        self._handlers = {number: signal.signal(number, do) for number, do in handlers.items()}
        self._acquire()
        return self

    def __exit__(self, *_: object) -> None:
        self._release()
        for number, handler in self._handlers.items():
            signal.signal(number, handler)

    def keys(self, patience_s: float) -> Iterator[str]:
        """Yield the keys that come within the time [s]: "up", "down", "left", "right" or a letter.

        Letters are small. Keys that have no meaning here are left out.
        """
        if not select.select([self._file], [], [], patience_s)[0]:
            self._rest = b""  # the rest would have come at once: it was the escape key alone
            return
        text = self._rest + self._read()
        unfinished = UNFINISHED.search(text)
        end = unfinished.start() if unfinished else len(text)
        self._rest = text[end:]
        for match in KEY.finditer(text, 0, end):
            if arrow := ARROWS.get(match[1] or match[2]):
                yield arrow
            elif match[0].isalpha():
                yield match[0].decode().lower()

    def _read(self) -> bytes:
        try:
            read = os.read(self._file, 1024)
        except OSError:
            read = b""
        if not read:
            self.closed = True  # the terminal is gone
        return read

    def _acquire(self, *_: object) -> None:
        if self._is_in_front():
            ours = termios.tcgetattr(self._file)
            ours[3] &= ~(termios.ICANON | termios.ECHO)  # Ctrl-C and Ctrl-Z stay signals
            termios.tcsetattr(self._file, termios.TCSANOW, ours)
            self._is_ours = True

    def _release(self) -> None:
        if self._is_ours and self._is_in_front():
            termios.tcsetattr(self._file, termios.TCSANOW, self._found)
        self._is_ours = False

    def _is_in_front(self) -> bool:
        """Whether this program has the terminal, which it has not in the background."""
        if not os.isatty(self._file):
            return False  # it is gone
        try:
            return os.tcgetpgrp(self._file) == os.getpgrp()
        except OSError:
            return True  # no shell has it

    def _close(self, *_: object) -> None:
        self.closed = True

    def _pause(self, number: int, _: object) -> None:
        self._release()
        handler = signal.signal(number, signal.SIG_DFL)
        signal.raise_signal(number)  # here the program is stopped
        signal.signal(number, handler)
        self._acquire()


class TeleopTurtle(RclcppNode):
    """The node `/teleop_turtle`: turns keys into commands and rotation goals."""

    def __init__(self) -> None:
        super().__init__("teleop_turtle")
        self.declare("scale_angular", 2.0, "Speed of a turn [rad/s]")
        self.declare("scale_linear", 2.0, "Speed ahead and back [m/s]")
        self._velocity = self.create_publisher(Twist, "turtle1/cmd_vel", TOPIC_QOS)
        self._type = self.declare_interfaces().action.RotateAbsolute
        self._rotation = ActionClient(self, self._type, "turtle1/rotate_absolute")
        self._goal: Any = None  # the future of its handle

    def press(self, key: str) -> None:
        """Act on a key; keys without a meaning are ignored."""
        if key in DRIVE:
            ahead, left = DRIVE[key]
            twist = Twist()
            twist.linear.x = ahead * self.get_parameter("scale_linear").value
            twist.angular.z = left * self.get_parameter("scale_angular").value
            self._velocity.publish(twist)
        elif key in HEADINGS:
            self._rotate(HEADINGS[key])
        elif key == "f" and self._goal is not None:
            # at once, or as soon as the simulator has accepted it
            self._goal.add_done_callback(lambda goal: goal.result().cancel_goal_async())

    def destroy_node(self) -> None:
        self._rotation.destroy()  # rclpy forgets actions
        super().destroy_node()

    def _rotate(self, heading_rad: float) -> None:
        if not self._rotation.server_is_ready():
            self.get_logger().warning("There is no turtle1 here: is turtlesim_node running?")
            return
        self._goal = self._rotation.send_goal_async(self._type.Goal(theta=heading_rad))


def drive(node: TeleopTurtle, stopped: Callable[[], bool]) -> None:
    """Pass on keys until Q is pressed, the terminal is closed, or it is stopped.

    Raises:
        NotATerminal: there are no keys.
    """
    executor = TickExecutor(node)
    with Keyboard(0) as keyboard:
        print(HELP, end="", flush=True)
        while not (stopped() or keyboard.closed):
            for key in keyboard.keys(PAUSE_S):
                if key == "q":
                    return
                node.press(key)
            executor.spin_some()


def main(argv: list[str] | None = None) -> int:
    """Run until Q, SIGINT or SIGTERM; 2 where there is no terminal."""
    return program.run("turtle_teleop_key", TeleopTurtle, drive, argv, ABOUT)


if __name__ == "__main__":
    sys.exit(main())
