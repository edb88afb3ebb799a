import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from grader.cli import main
from grader.errors import ExerciseError
from grader.exercise.loading import load_exercise
from tests.grader.testing import exercises
from tests.programs import ROOT
from tests.tiers import others_are_more

BIN = str(Path(sys.executable).parent)


def test_the_challenge_s_starter_comes_by_itself(tmp_path, capsys):
    assert main(["new", str(tmp_path / "mine")]) == 0
    assert (tmp_path / "mine" / "setup.py").is_file()
    assert capsys.readouterr().out.splitlines() == [
        f"The starter package is in {tmp_path / 'mine'}.",
        "README.md says what is asked for and how it is judged.",
        "Fill in the TODOs of mine/turtle_controller.py, then run:",
        f"    grader run {tmp_path / 'mine'}",
    ]


@pytest.mark.parametrize(
    ("called", "exercise"),
    others_are_more(
        "one whose name has to be quoted, and is not that of its package, stands for the other",
        [("My-Robot 2", "turtlesim_challenge"), ("mine", "square")],
        "My-Robot 2",
    ),
)
def test_the_commands_on_the_sheet_start_the_student_s_own_file(tmp_path, called, exercise):
    mine = tmp_path / called
    assert main(["new", str(mine), "--exercise", exercise]) == 0
    commands = re.findall("(?m)^ {4}(?!ros2 |colcon )(.*)", (mine / "README.md").read_text())
    simulator, by_hand, grade = commands
    assert shutil.which(simulator, path=BIN), simulator
    (program,) = (path for path in mine.rglob("*.py") if b"TODO" in path.read_bytes())
    program.write_text("import sys\nprint('my own')\nsys.exit()\n" + program.read_text())

    def typed(command, **more):
        env = {**os.environ, "PATH": f"{BIN}{os.pathsep}{os.environ['PATH']}", **more}
        done = subprocess.run(
            command, shell=True, cwd=tmp_path, env=env, capture_output=True, text=True
        )
        return done.returncode, done.stdout

    for _ in range(2):  # once more where it was typed
        assert typed(by_hand) == (0, "my own\n")
    with_ours = grade.replace("grader", f"{shlex.quote(sys.executable)} -m grader", 1)
    code, said = typed(with_ours, PYTHONPATH=str(ROOT))
    assert (code, f"\n{called}: {exercise}\n" in said) == (0, True), said
    assert (tmp_path / "graded" / called / "output.txt").read_text() == "my own\n"


@pytest.mark.parametrize(
    ("called", "package"),
    [
        ("my_solution", "my_solution"),
        ("MyRobot", "myrobot"),
        ("my-robot", "my_robot"),
        ("My  robot (2)", "my_robot_2"),
        ("Übung.1", "ubung_1"),
        ("3rd", "my_3rd"),
        ("x", "my_x"),
        ("class", "my_class"),  # a keyword
        ("test", "my_test"),  # a module of Python's
        ("tests", "my_tests"),  # a folder that no grading searches
        ("resource", "my_resource"),  # a folder of the starter
        ("geometry_msgs", "my_geometry_msgs"),  # installed
        ("turtlesim_challenge", "my_turtlesim_challenge"),  # ... and the reference
    ],
)
def test_the_package_is_called_like_its_folder(tmp_path, capsys, called, package):
    mine = tmp_path / called
    assert main(["new", str(mine), "--exercise", "talker_listener"]) == 0
    told = f"The package is called {package}." in capsys.readouterr().out.splitlines()
    assert told == (called != package)
    assert (mine / package / "__init__.py").is_file()
    assert (mine / "resource" / package).is_file()
    assert f"<name>{package}</name>" in (mine / "package.xml").read_text()
    assert f'package_name = "{package}"' in (mine / "setup.py").read_text()
    assert f" = {package}." in (mine / "setup.py").read_text()
    assert (mine / "setup.cfg").read_text().count(f"$base/lib/{package}\n") == 2
    assert f"    ros2 run {package} " in (mine / "README.md").read_text()
    placeholder = load_exercise("talker_listener").starter_package
    if package != placeholder:
        for path in (path for path in mine.rglob("*") if path.is_file()):
            assert not re.search(rf"\b{placeholder}\b", f"{path.name} {path.read_text()}")


def test_a_name_without_letters_is_refused(tmp_path, capsys):
    assert main(["new", str(tmp_path / "数学")]) == 2
    assert "give one whose name has letters from a to z" in capsys.readouterr().err
    assert not (tmp_path / "数学").exists()
    assert main(["new", str(tmp_path / "数学"), "--exercise", "square"]) == 0  # no package


def text_of(folder, name):
    return next(folder.rglob(name)).read_text()


@pytest.mark.parametrize(
    ("release", "package"),
    [("humble", "turtlesim"), ("jazzy", "turtlesim"), ("kilted", "turtlesim_msgs")],
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
    assert "<name>mine</name>" in manifest


def test_without_any_ros_it_is_as_it_comes(tmp_path, monkeypatch):
    monkeypatch.delenv("ROS_DISTRO", raising=False)
    assert main(["new", str(tmp_path / "mine")]) == 0
    starter = load_exercise("turtlesim_challenge").starter
    for path in starter.rglob("*.*"):
        if "__pycache__" in path.parts:
            continue
        written = tmp_path / str(path).replace(str(starter), "mine").replace("my_solution", "mine")
        text = path.read_text().replace("my_solution", "mine")
        named = '    <grader exercise="turtlesim_challenge"/>\n  </export>'
        assert written.read_text() == text.replace("  </export>", named)


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


def test_where_there_is_no_starter_the_sheet_comes_with_an_empty_file(tmp_path, capsys):
    assert main(["new", str(tmp_path / "mine"), "--exercise", "square"]) == 0
    assert {path.name for path in (tmp_path / "mine").iterdir()} == {"README.md", "my_node.py"}
    assert "    python3 mine/my_node.py\n" in (tmp_path / "mine" / "README.md").read_text()
    assert capsys.readouterr().out.splitlines() == [
        f"The exercise sheet is in {tmp_path / 'mine'}.",
        "README.md says what is asked for and how it is judged.",
        "Fill in the TODOs of my_node.py, then run:",
        f"    grader run {tmp_path / 'mine'}",
    ]


def test_a_starter_that_does_not_parse_is_told(tmp_path, capsys):
    exercise = exercises.write(tmp_path / "ahead", starter="begin.py")
    (exercise / "begin.py").write_text("if:\n")
    assert main(["new", str(tmp_path / "mine"), "--exercise", str(exercise)]) == 2
    assert "begin.py does not parse: " in " ".join(capsys.readouterr().err.split())
    assert not (tmp_path / "mine").exists()


@pytest.mark.parametrize(
    "where",
    ["/etc", "..", "../other", ".", "link", "turtlesim_challenge/../../..", "exercise.yaml"],
)
def test_a_starter_lies_inside_its_exercise_or_a_package(tmp_path, capsys, where):
    exercise = exercises.write(tmp_path / "ahead", starter=where)
    (tmp_path / "other").mkdir()
    (exercise / "link").symlink_to(tmp_path / "other")
    assert main(["new", str(tmp_path / "mine"), "--exercise", str(exercise)]) == 2
    assert "starter: expected a folder" in capsys.readouterr().err
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
