"""The reference controller with one thing spoiled at a time, and what each mutant must lose.

A mutant is the reference's text with some passages replaced; `lost` names the checks that lose
points, each with the points that remain: a number, or "some" for partial credit. Every other
check must give full points. "not judged" stands for all checks that wait for a failed one.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import turtlesim_challenge

REFERENCE = Path(turtlesim_challenge.__file__).with_name("turtle_controller.py")
NOTHING = dict.fromkeys(
    (
        "moves",
        "spiral",
        "steady_rate",
        "edge_stop",
        "pen_per_quadrant",
        "picture",
        "no_redundant_calls",
    ),
    0.0,
)

NEAR_EDGE = "if not (EDGE < pose.x < FAR and EDGE < pose.y < FAR):"
ENTERED = "elif quadrant(pose.x, pose.y) != self.quadrant:"
TWIST_Z = "twist.angular.z = 1.0"
STOP = "self.velocity.publish(Twist())\n            self.get_logger()"
CALL = "self.pen.call_async(SetPen.Request(r=r, g=g, b=b, width=3, off=0))"


@dataclass(frozen=True)
class Mutant:
    """Replacements in the reference's text, and the points that remain where some are lost."""

    changes: dict[str, str]
    lost: dict[str, float | str] = field(default_factory=dict)

    def text(self) -> str:
        """The mutant's source; each passage must stand in the reference exactly once."""
        text = REFERENCE.read_text(encoding="utf-8")
        for old, new in self.changes.items():
            assert text.count(old) == 1, f"{old!r} stands {text.count(old)} times in the reference"
            text = text.replace(old, new)
        return text


MUTANTS = {
    "no_stop": Mutant({NEAR_EDGE: "if False:"}, {"edge_stop": 0}),
    "stops_in_the_middle": Mutant(
        {NEAR_EDGE: "if abs(pose.x - CENTRE) > 2.5:"},
        {"edge_stop": 0},
    ),
    "touches_the_wall": Mutant({"EDGE = 0.5": "EDGE = 0.001"}, {"edge_stop": 0}),
    "falls_silent_at_the_edge": Mutant({STOP: "self.get_logger()"}, {"edge_stop": 0}),
    "counts_its_steps": Mutant(
        {NEAR_EDGE: "if self.speed > 5.12:"},
        {"edge_stop": 0},
    ),
    "circle": Mutant(
        {"self.speed += 0.05": "self.speed = 2.0", NEAR_EDGE: "if False:"},
        {"spiral": "some", "edge_stop": 0, "picture": 0},
    ),
    "inward_spiral": Mutant(
        {"self.speed += 0.05": "self.speed = max(0.0, (self.speed or 1.5) - 0.01)"},
        {"spiral": "some", "edge_stop": 0, "picture": 0},
    ),
    "two_colours_only": Mutant(
        {"3: (0, 255, 0),": "3: (255, 255, 255),", "4: (0, 0, 255),": "4: (255, 0, 0),"},
        {"pen_per_quadrant": 10, "picture": 0},
    ),
    "colour_a_second_late": Mutant(
        {
            CALL: "request = SetPen.Request(r=r, g=g, b=b, width=3, off=0)\n"
            "        def call():\n"
            "            timer.cancel()\n"
            "            self.pen.call_async(request)\n"
            "        timer = self.create_timer(1.0, call)"
        },
        {"pen_per_quadrant": "some", "picture": 0},
    ),
    "colour_on_every_pose": Mutant({ENTERED: "else:"}, {"no_redundant_calls": 0}),
    "random_colours": Mutant(
        {
            CALL: "import random\n"
            "        r, g, b = (random.randrange(256) for _ in range(3))\n"
            f"        {CALL}"
        },
        {"pen_per_quadrant": "some", "picture": 0},
    ),
    "no_colours": Mutant(
        {CALL: "pass"}, {"pen_per_quadrant": 0, "picture": 0, "no_redundant_calls": 0}
    ),
    "wrong_topic": Mutant({'"/turtle1/cmd_vel"': '"/turtle/cmd_vel"'}, NOTHING),
    "wrong_type": Mutant(
        {
            "from geometry_msgs.msg import Twist": "from geometry_msgs.msg import TwistStamped",
            'create_publisher(Twist, "/turtle1': 'create_publisher(TwistStamped, "/turtle1',
            "twist = Twist()": "stamped = TwistStamped()\n        twist = stamped.twist",
            "self.velocity.publish(twist)": "self.velocity.publish(stamped)",
            "self.velocity.publish(Twist())": "self.velocity.publish(TwistStamped())",
        },
        NOTHING,
    ),
    "wrong_turtle": Mutant({'"/turtle1/cmd_vel"': '"/turtle2/cmd_vel"'}, NOTHING),
    "draws_by_teleport": Mutant(
        {
            "import SetPen": "import SetPen, TeleportRelative",
            "self.create_timer(0.5, self.drive)": "self.jump = self.create_client("
            'TeleportRelative, "/turtle1/teleport_relative")\n'
            "        self.jump.wait_for_service()\n"
            "        self.create_timer(0.05, self.drive)",
            "self.speed += 0.05\n        twist": "self.speed += 0.005\n        twist",
            TWIST_Z: "request = TeleportRelative.Request(linear=self.speed * 0.05, angular=0.05)",
            "self.velocity.publish(twist)": "self.jump.call_async(request)",
        },
        NOTHING,
    ),
    "crashes_after_ten_seconds": Mutant(
        {"twist = Twist()": "twist = Twist()\n        1 / (self.speed < 1.0)"},
        {"spiral": "some", "edge_stop": 0, "picture": 0},
    ),
    "never_spins": Mutant({"rclpy.spin(TurtleController())": "TurtleController()"}, NOTHING),
    "drives_irregularly": Mutant(
        {
            "self.create_timer(0.5, self.drive)": "self.timer = self.create_timer(0.5, self.drive)",
            "self.speed += 0.05\n": "self.speed += 0.05\n"
            "        self.count = getattr(self, 'count', 0) + 1\n"
            "        self.timer.timer_period_ns = [100, 350, 900][self.count % 3] * 1000000\n",
        },
        {"steady_rate": 0},
    ),
    "pauses_on_its_way": Mutant(
        {
            "if self.stopped:\n            return\n        self.speed": "if self.stopped or "
            "10 < self.get_clock().now().nanoseconds / 1e9 - self.start < 13:\n"
            "            return\n        self.speed",
            "self.speed = 0.0": "self.speed = 0.0\n"
            "        self.start = self.get_clock().now().nanoseconds / 1e9",
        },
        {"steady_rate": 0},
    ),
}
