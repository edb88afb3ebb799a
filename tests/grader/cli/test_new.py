"""`grader new`: the starter of the challenge, or of another exercise."""

from __future__ import annotations

import os

import pytest

from grader.cli import main
from grader.errors import ExerciseError
from grader.exercise.loading import load_exercise
from tests.grader.testing import exercises


def test_the_challenge_s_starter_comes_by_itself(tmp_path, capsys):
    assert main(["new", str(tmp_path / "mine")]) == 0
    assert (tmp_path / "mine" / "setup.py").is_file()
    assert capsys.readouterr().out.splitlines() == [
        f"The starter package is in {tmp_path / 'mine'}.",
        "README.md says what is asked for and how it is judged.",
        "Fill in the TODOs of turtlesim_challenge/turtle_controller.py, then run:",
        f"    grader run {tmp_path / 'mine'}",
    ]


def test_the_sheet_names_what_is_there(tmp_path):
    assert main(["new", str(tmp_path / "mine")]) == 0
    text = (tmp_path / "mine" / "README.md").read_text()
    assert text.startswith("# A spiral in four colours\n")
    assert (tmp_path / "mine" / "turtlesim_challenge" / "turtle_controller.py").is_file()
    for command in (
        "python3 -m turtlesim_challenge.turtle_controller",
        "ros2 run turtlesim_challenge turtle_controller",
        "grader run mine",
    ):
        assert f"    {command}\n" in text


def text_of(folder, name):
    return next(folder.rglob(name)).read_text()


@pytest.mark.parametrize(
    ("release", "package"),
    [
        *((release, "turtlesim") for release in ("humble", "jazzy")),
        *((release, "turtlesim_msgs") for release in ("kilted", "lyrical", "rolling")),
    ],
)
@pytest.mark.parametrize("is_sourced", [True, False])
def test_the_starter_is_for_the_release_that_is_asked_for_or_sourced(
    tmp_path, monkeypatch, release, package, is_sourced
):
    asked = [] if is_sourced else ["--ros", release]
    monkeypatch.setenv("ROS_DISTRO", release if is_sourced else "jazzy")
    assert main(["new", str(tmp_path / "mine"), *asked]) == 0
    controller = text_of(tmp_path / "mine", "turtle_controller.py")
    assert f"from {package}.msg import Pose\n" in controller
    assert f"from {package}.srv import SetPen" in controller
    assert "(with a turtlesim running)" in controller
    assert f"a `{package}.msg.Pose`" in text_of(tmp_path / "mine", "README.md")
    manifest = text_of(tmp_path / "mine", "package.xml")
    assert f"<exec_depend>{package}</exec_depend>" in manifest
    assert "<name>turtlesim_challenge</name>" in manifest


def test_without_any_ros_it_is_as_it_comes(tmp_path, monkeypatch):
    monkeypatch.delenv("ROS_DISTRO", raising=False)
    assert main(["new", str(tmp_path / "mine")]) == 0
    starter = load_exercise("turtlesim_challenge").starter
    written = {*(tmp_path / "mine").rglob("*.*")} - {tmp_path / "mine" / "README.md"}
    for path in written:
        assert path.read_bytes() == (starter / path.relative_to(tmp_path / "mine")).read_bytes()


def test_an_unknown_release_is_refused(tmp_path, capsys):
    assert main(["new", str(tmp_path / "mine"), "--ros", "noetic"]) == 2
    assert "invalid choice: 'noetic'" in capsys.readouterr().err
    assert not (tmp_path / "mine").exists()


def test_an_exercise_elsewhere_has_its_own(tmp_path, capsys):
    exercise = exercises.write(tmp_path / "ahead", starter="begin")
    (exercise / "begin").mkdir()
    (exercise / "begin" / "node.py").write_text("print('nothing')\n")
    (exercise / "begin" / "README.md").write_text("the author's own\n")
    assert main(["new", str(tmp_path / "mine"), "--exercise", str(exercise)]) == 0
    assert {path.name for path in (tmp_path / "mine").iterdir()} == {"node.py", "README.md"}
    assert (tmp_path / "mine" / "README.md").read_text() == "the author's own\n"
    assert capsys.readouterr().out.splitlines()[2:] == [
        "Then run:",
        f"    grader run {tmp_path / 'mine'} --exercise {exercise}",
    ]


def test_where_there_is_no_starter_the_sheet_comes_alone(tmp_path, capsys):
    assert main(["new", str(tmp_path / "mine"), "--exercise", "square"]) == 0
    assert [path.name for path in (tmp_path / "mine").iterdir()] == ["README.md"]
    assert "    python3 my_node.py\n" in (tmp_path / "mine" / "README.md").read_text()
    assert capsys.readouterr().out.splitlines() == [
        f"The exercise sheet is in {tmp_path / 'mine'}.",
        "README.md says what is asked for and how it is judged.",
        "Write my_node.py beside it, then run:",
        f"    grader run {tmp_path / 'mine'} --exercise square",
    ]


def test_a_starter_must_be_a_folder(tmp_path):
    exercise = exercises.write(tmp_path / "ahead", starter="checks.py")
    with pytest.raises(ExerciseError, match="starter: expected a folder"):
        load_exercise(exercise)


@pytest.mark.parametrize(
    "where", ["/etc", "..", "../other", ".", "link", "turtlesim_challenge/../../.."]
)
def test_a_starter_lies_inside_its_exercise_or_a_package(tmp_path, capsys, where):
    exercise = exercises.write(tmp_path / "ahead", starter=where)
    (tmp_path / "other").mkdir()
    (exercise / "link").symlink_to(tmp_path / "other")
    assert main(["new", str(tmp_path / "mine"), "--exercise", str(exercise)]) == 2
    assert "starter: expected a folder inside" in capsys.readouterr().err
    assert not (tmp_path / "mine").exists()


@pytest.mark.parametrize("is_new", [True, False])
def test_of_a_starter_that_cannot_be_copied_nothing_is_left(tmp_path, capsys, is_new):
    exercise = exercises.write(tmp_path / "ahead", starter="begin")
    (exercise / "begin").mkdir()
    (exercise / "begin" / "node.py").write_text("print('nothing')\n")
    os.mkfifo(exercise / "begin" / "pipe")
    mine = tmp_path / "mine"
    if not is_new:
        mine.mkdir()
    assert main(["new", str(mine), "--exercise", str(exercise)]) == 2
    message = capsys.readouterr().err
    assert "pipe" in message
    assert "None" not in message
    assert not list(mine.iterdir()) if mine.exists() else is_new


def test_an_exercise_that_may_not_be_read_is_its_authors(tmp_path, monkeypatch):
    exercise = exercises.write(tmp_path / "ahead")

    def refuse(path):
        raise PermissionError(13, "Permission denied", str(path))

    monkeypatch.setattr("pathlib.Path.is_file", refuse)
    with pytest.raises(ExerciseError, match=r"cannot read the exercise .*ahead.*Permission denied"):
        load_exercise(exercise)
