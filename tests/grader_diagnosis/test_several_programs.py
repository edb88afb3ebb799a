"""The first line for a hand-in of several programs: which of them it is, and where."""

import shutil
from pathlib import Path

import pytest

import grader
from grader.exercise.loading import load_exercise
from grader.exercise.result.result import Result
from tests.tiers import others_are_more

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


MISTAKES = {
    "You subscribe to /chatter, which nobody publishes": (LISTENER, '"topic"', '"chatter"'),
    "You publish std_msgs/msg/String on /topics, where nobody": (TALKER, '"topic"', '"topics"'),
    "Your program ended at once and never spun": (LISTENER, SPINS, "MinimalSubscriber()"),
    "listener-2: Your program ended itself right at": (LISTENER, SPINS, "raise SystemExit(3)"),
    "listener-2: Your node crashed right at the start": (LISTENER, SPINS, "print(1 / 0)"),
    "launch/talk.launch.py starts what is not there": (LAUNCH, '"listener"', '"listner"'),
    "launch/talk.launch.py cannot be launched: NameError: name": (LAUNCH, "Node(", "Nodes("),
    # what the others have printed is not quoted
    "talker-1: Your program ended with exit code 7, by no exception; the last that it printed is: "
    "'here'": (
        *(TALKER, "rclpy.spin(MinimalPublisher())"),
        "__import__('os')._exit(print('here', flush=True) or 7)",
    ),
}


@pytest.mark.parametrize(
    "said",
    others_are_more(
        "test_rules.py has what they say; how a program is named shows one of each kind",
        MISTAKES,
        *(said for said in MISTAKES if said.startswith(("listener-2: Your program", "talker-1"))),
        "launch/talk.launch.py starts what is not there",
    ),
)
def test_it_names_the_program_and_the_line(tmp_path, said):
    file, old, new = MISTAKES[said]
    result = graded(tmp_path, (file, old, new))
    assert result.diagnosis is not None
    assert str(result.diagnosis.cause).startswith(said)
    place = result.diagnosis.place
    assert place is None or place.file == file


def test_who_waits_while_others_go_on_has_not_stalled(tmp_path):
    idle = "class MinimalPublisher(Node):\n    def __init__(self):\n"
    idle += '        super().__init__("minimal_publisher")\n'
    idle += '        self.create_subscription(String, "never", print, 10)\n\n\nclass Other(Node):'
    result = graded(tmp_path, (TALKER, "class MinimalPublisher(Node):", idle))
    assert [each.outcome for each in result.run.programs] == ["finished"] * 2


def test_who_ends_by_itself_is_told(tmp_path):
    code = "rclpy.spin_once(MinimalPublisher())"
    result = graded(tmp_path, (TALKER, "rclpy.spin(MinimalPublisher())", code))
    assert "talker-1 ended by itself at 0.5 s" in map(str, result.run.flags)
