"""A harmless comment in any file of a right hand-in costs nothing, whatever it says."""

import shutil

import pytest

import grader
from grader.exercise import places
from grader.exercise.loading import load_exercise
from grader.testing.solutions import FILE_NAME, read_solutions
from tests.hand_ins import SUBMISSIONS
from tests.tiers import others_are_more

TEXT = (
    b"${x} xacro: $(find y) <launch> <!DOCTYPE z> def generate_launch_description(): main() --- = 1"
)
LINE = b"# " + TEXT + b"\n"
#: With ": " a launch file that hands a description on as it is would fail in ROS, too.
ELEMENT = b"<!-- " + TEXT.replace(b"---", b"").replace(b": ", b":") + b" -->"
#: How a kind of file has comments.
XML = (".xml", ".urdf", ".xacro", ".launch")
LINES = (".py", ".cfg", ".yaml", ".yml", ".rviz", ".txt", ".msg", ".srv", ".action")
EXERCISES = {name: load_exercise(name) for name in places.names()}
SOLUTIONS = {
    (name, each.name): each
    for name, exercise in EXERCISES.items()
    if (exercise.folder / FILE_NAME).is_file()
    for each in read_solutions(exercise)
    if each.is_right
}
TUTORIALS = SUBMISSIONS / "tutorials"
HAND_INS = {
    **{(path.parent.parent.name, path.name): path for path in TUTORIALS.glob("*/right/*")},
    **{("turtlesim_challenge", path.name): path for path in (SUBMISSIONS / "right").iterdir()},
}


def commented(data, suffix):
    """The text of a file with a comment before, within and behind what it says."""
    if suffix in XML:
        begin = data.index(b"?>") + 2 if data.lstrip().startswith(b"<?xml") else 0
        end = data.rindex(b"</")
        return data[:begin] + ELEMENT + data[begin:end] + ELEMENT + data[end:] + ELEMENT
    first, end, rest = data.partition(b"\n")
    if not first.startswith(b"#"):  # else it says how the file is read
        first = LINE + first
    rest = rest.replace(b"\n---\n", b"\n" + LINE + b"---\n" + LINE)
    return first + end + rest + (b"\n" if rest and not rest.endswith(b"\n") else b"") + LINE


def comment(path):
    """Put comments into all files of a hand-in."""
    for file in [path] if path.is_file() else sorted(path.rglob("*")):
        if file.is_file() and file.suffix in (*XML, *LINES) and file.stat().st_size:
            file.write_bytes(commented(file.read_bytes(), file.suffix))
    return path


def lost(path, name, folder):
    """What a copy of a hand-in with comments loses."""
    copy = folder / "copy" / path.name
    copy.parent.mkdir()
    shutil.copytree(path, copy) if path.is_dir() else shutil.copy(path, copy)
    result = grader.grade(comment(copy), EXERCISES[name])
    return {each.check: str(each.rationale) for each in result.verdicts if not each.passed}


@pytest.mark.parametrize(
    "key",
    others_are_more(
        "of each kind of file there is one: CMake, interfaces, xacro, RViz, XML, YAML and URDF",
        [(key,) for key in SOLUTIONS],
        ("own_interfaces", "reference"),
        ("description_package", "xml"),
        ("description_package", "yaml"),
        ("description_package", "cmake"),
        ("state_publisher", "launch_in_xml"),
    ),
)
def test_a_comment_in_each_file_of_a_right_solution_costs_nothing(key, tmp_path):
    assert lost(SOLUTIONS[key].lay_out(tmp_path), key[0], tmp_path) == {}


@pytest.mark.more("half a minute; the solutions have all kinds of files")
@pytest.mark.parametrize("key", HAND_INS, ids="-".join)
def test_a_comment_in_each_file_of_a_right_hand_in_costs_nothing(key, tmp_path):
    assert lost(HAND_INS[key], key[0], tmp_path) == {}
