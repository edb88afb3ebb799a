"""A small exercise in a folder, for tests of what is made for authors."""

from pathlib import Path
from typing import Any

import pytest
import yaml

from grader.errors import ExerciseError
from grader.exercise.loading import load_exercise

DESCRIPTION = {
    "exercise": "ahead",
    "title": "Drive ahead",
    "limits": {"first_motion_s": 1, "rest_s": 0.5, "total_s": 4},
    "points": {"commands": 4, "far": 6},
}
CHECKS = """from grader import Checks, DrivenPath, Finding, Recordings, Tolerances
from grader.scenes.turtlesim.trace import TurtleTrace
from turtlesim_py.world.events import CmdVel

checks = Checks()


@checks(parrot="who drives ahead needs to hear nothing")
def commands(recordings: Recordings, tolerances: Tolerances) -> Finding:
    '''It sends commands.'''
    count = len(TurtleTrace.of(recordings.nominal.trace).of_kind(CmdVel))
    return Finding(min(count, 1), f"{count} commands came.", "Does it publish?")


@checks(after=("commands",), parrot="who drives ahead needs to hear nothing")
def far(recordings: Recordings, tolerances: Tolerances) -> Finding:
    '''It drives for half a metre.'''
    recording = recordings.nominal
    path = DrivenPath(recording, TurtleTrace.of(recording.trace).trajectory()).until_lost()
    share = min(path.length_m / 0.5, 1)
    return Finding(share, f"It drove {path.length_m:.2f} m.", "How fast?", (path.at(1, "begin"),))
"""
SOLUTION = """import rclpy
from geometry_msgs.msg import Twist

rclpy.init()
node = rclpy.create_node("node")
publisher = node.create_publisher(Twist, "/turtle1/cmd_vel", 10)
twist = Twist()
twist.linear.x = 1.0
publisher.publish(twist)
rclpy.spin(node)
"""
MUTANTS: dict[str, Any] = {
    "right": {"solution": "solution.py"},
    "mutants": {
        "slow": {
            "replace": [{"old": "twist.linear.x = 1.0", "new": "twist.linear.x = 0.1"}],
            "leaves": {"far": "some"},
        },
        "silent": {"file": "silent.py", "leaves": "nothing"},
    },
}


def write(folder: Path, checks: str = CHECKS, mutants: object = MUTANTS, **changes: Any) -> Path:
    """Lay an exercise out; `changes` are those to its exercise.yaml."""
    folder.mkdir(exist_ok=True)
    (folder / "exercise.yaml").write_text(yaml.safe_dump({**DESCRIPTION, **changes}))
    (folder / "checks.py").write_text(checks)
    (folder / "solution.py").write_text(SOLUTION)
    (folder / "silent.py").write_text(SOLUTION.replace("publisher.publish(twist)\n", ""))
    (folder / "mutants.yaml").write_text(yaml.safe_dump(mutants, sort_keys=False))
    return folder


def edited(folder: Path, text: str = "", **changes: Any) -> Path:
    """An edited copy of the challenge, by text or by changes."""
    path = folder / "mine.yaml"
    path.write_text(yaml.safe_dump({"exercise": "turtlesim_challenge", **changes}) + text)
    return path


def refusal(path: Path) -> str:
    """Return why an exercise cannot be loaded."""
    with pytest.raises(ExerciseError) as error:
        load_exercise(path)
    return str(error.value.message)
