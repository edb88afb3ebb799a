import shutil
from pathlib import Path

import pytest

import grader
from grader import grading
from grader.cli import main
from grader.errors import UsageError
from grader.exercise.loading import load_exercise
from grader.exercise.result.result import Result
from grader.recording.subject import Role
from grader.run.opening import marks_of
from grader.submission.reader import Marks
from grader.text.message import NOTHING
from tests.files import lay
from tests.grader.testing import exercises

COMMENT = "# grader: exercise={}\n"
PACKAGE = '<package><export><grader exercise="{}"/></export></package>'
NODE = "import turtlesim.msg\n"


def test_a_starter_names_its_exercise_whatever_becomes_of_its_names(tmp_path):
    assert main(["new", str(tmp_path / "mine"), "--exercise", "talker_listener"]) == 0
    ours = (tmp_path / "mine").rename(tmp_path / "yours")
    (ours / "mine").rename(ours / "walking")
    shutil.copytree(ours, tmp_path / "ws" / "src" / "walking")
    packed = shutil.make_archive(str(tmp_path / "alice"), "zip", tmp_path / "ws")
    twice = shutil.make_archive(str(tmp_path / "server"), "zip", tmp_path, "alice.zip")
    assert marks_of(ours).exercises == {"talker_listener": "package.xml"}
    for path in (tmp_path / "ws", Path(packed), Path(twice)):
        assert marks_of(path).exercises == {"talker_listener": "src/walking/package.xml"}


def test_so_does_a_single_file(tmp_path):
    assert main(["new", str(tmp_path / "mine"), "--exercise", "square"]) == 0
    node = (tmp_path / "mine" / "my_node.py").rename(tmp_path / "other.py")
    assert marks_of(node).exercises == {"square": "other.py"}


@pytest.mark.parametrize(
    "begin", ["", "#!/usr/bin/env python3\n", "#!/usr/bin/python3\n# coding: latin-1\n"]
)
def test_what_a_file_begins_with_stays_there(tmp_path, begin):
    exercise = exercises.write(tmp_path / "ahead", starter="begin")
    lay(exercise / "begin", {"node.py": f'{begin}"""It drives."""\n'})
    assert main(["new", str(tmp_path / "mine"), "--exercise", str(exercise)]) == 0
    text = (tmp_path / "mine" / "node.py").read_text()
    assert text == f'{begin}{COMMENT.format("ahead")}"""It drives."""\n'


def test_a_manifest_without_exports_gets_them(tmp_path):
    exercise = exercises.write(tmp_path / "ahead", starter="begin")
    lay(exercise / "begin", {"package.xml": "<package>\n  <name>begin</name>\n</package>\n"})
    assert main(["new", str(tmp_path / "mine"), "--exercise", str(exercise)]) == 0
    assert marks_of(tmp_path / "mine").exercises == {"ahead": "package.xml"}


@pytest.mark.parametrize(
    "files",
    [
        {"node.py": "print('# grader: exercise=square')\n"},
        {"node.py": "#" * 3000 + "\n" + COMMENT.format("square")},
        {"notes.txt": COMMENT.format("square"), "node.py": ""},
        {"package.xml": f"<!DOCTYPE package>{PACKAGE.format('square')}"},
        {"package.xml": PACKAGE.format("square").removesuffix("</package>")},
        {"package.xml": PACKAGE.format("")},
        {"build/package.xml": PACKAGE.format("square") * 2, "node.py": ""},
    ],
)
def test_nothing_else_names_one(tmp_path, files):
    assert marks_of(lay(tmp_path / "mine", files)).exercises == {}


def test_what_cannot_be_read_and_a_link_out_of_the_hand_in_name_none(tmp_path):
    files = {"other.py": COMMENT.format("square"), "mine/node.py": "", "notes.txt": ""}
    lay(tmp_path, files | {"broken.zip": b"PK and nothing more"})
    (tmp_path / "mine" / "linked.py").symlink_to(tmp_path / "other.py")
    for name in ("broken.zip", "notes.txt", "nothing"):
        assert marks_of(tmp_path / name) == Marks()
    assert marks_of(tmp_path / "mine").exercises == {}


def test_the_named_exercise_is_used_and_told(tmp_path, capsys, in_no_time):
    node = lay(tmp_path, {"node.py": COMMENT.format("square") + NODE}) / "node.py"
    assert main(["run", str(node), "--out", str(tmp_path / "out")]) == 0
    assert "Exercise: square (named in node.py)\n" in capsys.readouterr().err
    assert Result.read(tmp_path / "out" / "result.json").exercise == "square"
    assert grader.grade(node).exercise == "square"
    words = ["run", str(node), "--exercise", "turtlesim_challenge"]
    assert main([*words, "--out", str(tmp_path / "other")]) == 0  # who calls decides
    assert "Exercise:" not in capsys.readouterr().err
    assert Result.read(tmp_path / "other" / "result.json").exercise == "turtlesim_challenge"


def test_the_default_is_not_told_and_of_several_none_counts(tmp_path):
    files = {"a.py": COMMENT.format("square"), "b/package.xml": PACKAGE.format("talker_listener")}
    mine = lay(tmp_path / "mine", files)
    node = lay(tmp_path, {"node.py": COMMENT.format("turtlesim_challenge")}) / "node.py"
    assert grading.exercise_for(node, marks_of(node)) == ("turtlesim_challenge", NOTHING)
    name, said = grading.exercise_for(mine, marks_of(mine))
    assert name == "turtlesim_challenge"
    assert "several exercises (talker_listener, square), so that none counts" in str(said)


@pytest.mark.parametrize("name", ["of_another_course", "../exercise", "exercise.yaml"])
def test_one_that_is_not_installed_is_asked_for(tmp_path, capsys, name):
    node = lay(tmp_path, {"node.py": COMMENT.format(name), "exercise.yaml": ""}) / "node.py"
    assert main(["run", str(node), "--out", str(tmp_path / "out")]) == 2
    said = capsys.readouterr().err
    assert f"names the exercise {name!r} (in node.py), which is not installed here" in said
    assert "--exercise FOLDER" in said
    assert not (tmp_path / "out").exists()
    with pytest.raises(UsageError, match="is not installed here"):
        grader.grade(node)


def test_a_package_that_is_plainly_for_another_one_is_graded_by_that():
    mine = load_exercise("own_interfaces").folder / "reference"
    name, said = grading.exercise_for(mine, marks_of(mine))
    assert name == "own_interfaces"
    assert "by what the source has; another one: --exercise NAME" in str(said)


FITS = [
    (["publisher /topic"], ["talker"]),
    (["subscription /topic"], ["listener"]),
    (["publisher /topic", "subscription /topic"], ["listener", "talker"]),
    (["service /draw_polygon", "publisher /turtle1/cmd_vel"], []),  # the default fits, too
    (["publisher /turtle2/cmd_vel", "subscription /tf", "client /spawn"], ["tf2_listener"]),
    (["publisher /turtle1/cmd_vel", "client /turtle1/set_pen"], []),
    (["publisher /*", "publisher /elsewhere"], []),
]


@pytest.mark.parametrize(("roles", "names"), FITS)
def test_a_hand_in_fits_the_exercise_of_which_it_has_all_on_the_graph(roles, names):
    found = tuple(Role(*each.split()) for each in roles)
    assert sorted(grading.fitting_exercises(Marks(programs=1, roles=found))) == names


def test_two_programs_fit_the_exercise_of_two():
    roles = (Role("publisher", "/topic"), Role("subscription", "/topic"))
    assert grading.fitting_exercises(Marks(programs=2, roles=roles)) == ["talker_listener"]


def test_where_several_fit_one_has_to_be_chosen(tmp_path):
    marks = Marks(programs=1, roles=(Role("publisher", "/topic"), Role("subscription", "/topic")))
    with pytest.raises(UsageError, match=r"fits several exercises \(.*talker.*--exercise NAME"):
        grading.exercise_for(tmp_path, marks)
