"""The first line for a hand-in of several programs: which of them it is, and where."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

import grader
from grader.exercise.loading import load_exercise
from grader.result.result import Result
from tests.runs import SUBMISSIONS

LAUNCH, TALKER, LISTENER = "launch/talk.launch.py", "my_talk/talker.py", "my_talk/listener.py"
SPINS = "rclpy.spin(MinimalSubscriber())"


def graded(folder: Path, *edits: tuple[str, str, str]) -> Result:
    """The reference with other words: in a file, these instead of those."""
    shutil.copytree(load_exercise("talker_listener").folder / "reference", folder / "hand_in")
    for name, old, new in edits:
        file = folder / "hand_in" / name
        assert old in file.read_text()
        file.write_text(file.read_text().replace(old, new))
    return grader.grade(folder / "hand_in", "talker_listener")


@pytest.mark.parametrize(
    ("file", "old", "new", "said"),
    [
        (LISTENER, '"topic"', '"chatter"', "You subscribe to /chatter, which nobody publishes"),
        (TALKER, '"topic"', '"topics"', "You publish std_msgs/msg/String on /topics, where nobody"),
        (LISTENER, SPINS, "MinimalSubscriber()", "Your program ended at once and never spun"),
        (LISTENER, SPINS, "raise SystemExit(3)", "listener-2: Your program ended itself right at"),
        (LISTENER, SPINS, "print(1 / 0)", "listener-2: Your node crashed right at the start"),
        (LAUNCH, '"listener"', '"listner"', "launch/talk.launch.py starts what is not there: exec"),
        (LAUNCH, "Node(", "Nodes(", "launch/talk.launch.py cannot be launched: NameError: name"),
    ],
)  # fmt: skip
def test_it_names_the_program_and_the_line(
    tmp_path: Path, file: str, old: str, new: str, said: str
) -> None:
    result = graded(tmp_path, (file, old, new))
    assert result.diagnosis is not None
    assert str(result.diagnosis.cause).startswith(said)
    place = result.diagnosis.place
    assert place is None or place.file == file


def test_what_the_others_have_printed_is_not_quoted(tmp_path: Path) -> None:
    code = "__import__('os')._exit(print('here', flush=True) or 7)"
    result = graded(tmp_path, (TALKER, "rclpy.spin(MinimalPublisher())", code))
    assert result.diagnosis is not None
    assert "the last that it printed is: 'here'" in str(result.diagnosis.cause)


def test_a_program_that_the_launch_file_misspells_comes_first_where_no_check_looks_at_it(
    tmp_path: Path,
) -> None:
    shutil.copytree(SUBMISSIONS / "launched" / "spiral", tmp_path / "spiral")
    file = tmp_path / "spiral/launch/spiral.launch.py"
    file.write_text(file.read_text().replace("turtle_controller", "turtle_contoller"))
    result = grader.grade(tmp_path / "spiral", "turtlesim_challenge")
    assert result.diagnosis is not None
    assert "starts turtle_contoller, which setup.py does not" in str(result.diagnosis.cause)


def test_who_waits_while_others_go_on_has_not_stalled(tmp_path: Path) -> None:
    idle = "class MinimalPublisher(Node):\n    def __init__(self):\n"
    idle += '        super().__init__("minimal_publisher")\n'
    idle += '        self.create_subscription(String, "never", print, 10)\n\n\nclass Other(Node):'
    result = graded(tmp_path, (TALKER, "class MinimalPublisher(Node):", idle))
    assert [each.outcome for each in result.run.programs] == ["finished"] * 2


def test_who_ends_by_itself_is_told(tmp_path: Path) -> None:
    code = "rclpy.spin_once(MinimalPublisher())"
    result = graded(tmp_path, (TALKER, "rclpy.spin(MinimalPublisher())", code))
    assert "talker-1 ended by itself at 0.5 s" in map(str, result.run.flags)
