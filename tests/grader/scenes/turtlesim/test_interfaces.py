"""turtlesim or turtlesim_msgs: what a submission imports, and texts for the other one."""

import pytest

from grader.errors import SubmissionError
from grader.scenes.turtlesim import interfaces
from grader.scenes.turtlesim.interfaces import adapted, choose

OLDER, NEWER = "turtlesim", "turtlesim_msgs"


@pytest.fixture(autouse=True)
def both_are_installed(monkeypatch):
    monkeypatch.setattr(interfaces, "installed", lambda: (OLDER, NEWER))
    monkeypatch.setattr(interfaces, "usual", lambda: OLDER)


@pytest.mark.parametrize(
    ("surely", "perhaps", "expected"),
    [
        ([], [], OLDER),
        (["rclpy"], ["os"], OLDER),
        (["rclpy", NEWER], [], NEWER),
        ([], [NEWER], NEWER),
        ([NEWER], [OLDER], NEWER),
        ([OLDER], [NEWER], OLDER),
        ([], [NEWER, OLDER], NEWER),  # try the one, else the other
    ],
)
def test_what_is_imported_first_is_chosen_and_sure_goes_before_perhaps(surely, perhaps, expected):
    assert choose(dict.fromkeys(surely, ""), dict.fromkeys(perhaps, "")) == expected


def test_what_is_not_installed_is_not_chosen(monkeypatch):
    monkeypatch.setattr(interfaces, "installed", lambda: (NEWER,))
    monkeypatch.setattr(interfaces, "usual", lambda: NEWER)
    assert choose({OLDER: ""}, {}) == NEWER
    assert choose({}, {OLDER: "", NEWER: ""}) == NEWER


def test_both_in_any_case_run_in_no_ros():
    with pytest.raises(SubmissionError) as error:
        choose({NEWER: "a.py, line 3", "rclpy": "a.py, line 1", OLDER: "pens.py, line 7"}, {})
    (line,) = str(error.value.message).splitlines()
    assert "both turtlesim (pens.py, line 7) and turtlesim_msgs (a.py, line 3)" in line


NAMED = [
    "from turtlesim.srv import SetPen  # noqa",
    "import turtlesim.action as actions",
    "from turtlesim import msg, srv",
    "pose: turtlesim.msg.Pose",
    "  <exec_depend>turtlesim</exec_depend>",
]


@pytest.mark.parametrize("line", NAMED)
def test_the_package_is_named_as_the_release_has_it(line):
    newer = line.replace(OLDER, NEWER)
    for release in ("humble", "jazzy"):
        assert adapted(line, release) == adapted(newer, release) == line
    for release in ("kilted", "lyrical", "rolling"):
        assert adapted(line, release) == adapted(newer, release) == newer


@pytest.mark.parametrize(
    "line",
    [
        "(with a turtlesim running)",
        "from my_turtlesim.msg import Pose",
        "import turtlesim_challenge",
        "my.turtlesim.msg",
        "<name>turtlesim</name>",
        "<exec_depend>turtlesim_py</exec_depend>",
    ],
)
def test_all_else_stays(line):
    assert adapted(line, "lyrical") == adapted(line, "jazzy") == line
