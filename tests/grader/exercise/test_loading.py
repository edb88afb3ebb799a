"""An instructor's edited copy of an exercise is read, and what is wrong in it is named."""

import pytest

from grader.errors import ExerciseError
from grader.exercise import loading
from grader.exercise.loading import load_exercise
from grader.exercise.places import installed, names
from tests.grader.testing import exercises
from tests.grader.testing.exercises import edited, refusal

NAME = "turtlesim_challenge"


def written(tmp_path, text):
    path = tmp_path / "mine.yaml"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return path


def message_of(path):
    prefix, message = f"{path} is not an exercise: ", refusal(path)
    assert message.startswith(prefix)
    assert "\n" not in message
    return message.removeprefix(prefix)


def test_why_an_exercise_cannot_be_read_is_told_without_an_error_of_the_system(monkeypatch):
    def no_source(_):
        raise OSError("source code not available")

    assert NAME in refusal("chess")  # one of those that there are
    monkeypatch.setattr(loading, "_load", no_source)
    assert "'talker': source code not available" in refusal("talker")


def test_an_edited_copy_changes_what_it_names_and_with_it_the_hash(tmp_path):
    original = load_exercise(NAME)
    copy = load_exercise(edited(tmp_path, limits={"rest_s": 1}, points={"moves": 3}))
    assert (copy.limits.rest_s, copy.limits.total_s) == (1, original.limits.total_s)
    assert copy.points == {"moves": 3}
    assert copy.tolerances == original.tolerances
    assert load_exercise(edited(tmp_path)).sha256 == original.sha256
    assert load_exercise(edited(tmp_path, tolerances={"edge_m": 1})).sha256 != original.sha256
    place = tmp_path / "ahead"
    one = load_exercise(exercises.write(place))
    (place / "checks.py").write_text((place / "checks.py").read_text() + "\n# changed\n")
    assert load_exercise(place).sha256 != one.sha256
    anchored = edited(tmp_path, "points: &p {moves: 3}\ntolerances: {}\n")
    assert load_exercise(anchored).points == {"moves": 3}


@pytest.mark.parametrize("name", names())
def test_a_copy_of_an_installed_exercise_is_that_exercise(tmp_path, name):
    copy = tmp_path / "rubric.yaml"
    copy.write_bytes(installed(name).description.read_bytes())
    assert load_exercise(name).points
    assert load_exercise(copy).sha256 == load_exercise(name).sha256


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"exercise": "chess"}, "exercise: expected one of"),
        ({"points": {"fly": 1}}, "points: no check is named 'fly'"),
        ({"points": {"moves": -1}}, "points: moves: expected 0 or more, found -1"),
        ({"points": {}}, "points: expected check names with points"),
        ({"limits": {"rest_s": "long"}}, "limits: rest_s: expected a number, found 'long'"),
        ({"limits": 5}, "limits: expected an object of first_motion_s, rest_s"),
        ({"tolerances": {"edgem": 1}}, "tolerances: unknown 'edgem'; did you mean 'edge_m'?"),
        ({"point": {"moves": 1}}, "mine.yaml, line 2: point: unknown; did you mean 'points'?"),
        ({"limits": {"total": 60}}, "rest_s, total_s, found ['total']"),
        ({"points": {"move": 1}}, "points: no check is named 'move'; did you mean 'moves'?"),
        ({"varied_runs": {"count": 1.5}}, "count: expected a whole number, found 1.5"),
        ({"tolerances": {"colours": {5: [0, 0, 0]}}}, "colours: expected quadrants from 1 to 4"),
        ({"tolerances": {"colours": {1: "red"}}}, "colours: 1: expected [red, green, blue], each"),
        ({"tolerances": {"colours": {1: [0, 0, 256]}}}, "found [0, 0, 256]"),
        ({"tolerances": {"colours": {1: [9] * 3, 3: [9] * 3}}}, "colours: 1 and 3 are the same"),
    ],
)
def test_a_mistake_in_an_edited_copy_is_named(tmp_path, changes, words):
    assert words in message_of(edited(tmp_path, **changes))


@pytest.mark.parametrize(
    "text", ["a: [1", "just words", "- 1", "\x00", "a: b\npoints: [1\nlimits:"]
)
def test_what_is_no_yaml_object_is_refused(tmp_path, text):
    said = message_of(written(tmp_path, text))
    assert "line 3" in said or "\n" not in text


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("limits:\n  rest_s: 1\n  rest_s: 2", "line 4: the key 'rest_s' stands here twice"),
        ("title: a\ntitle: b", "line 3: the key 'title' stands here twice"),
        ("limits: {total_s: 0}", "line 2: limits: total_s: expected a number above 0"),
        ("cpu_s: 0", "line 2: cpu_s: expected a number above 0, found 0"),
        ("cpu_s: 1 min", "line 2: cpu_s: expected a number, found '1 min'"),
        ("limits: {first_motion_s: 0}", "line 2: limits: first_motion_s: expected a number above"),
        ("varied_runs:\n  nearest_m: 4", "line 3: varied_runs: nearest_m: expected at most"),
        ("varied_runs: {farthest_m: 5.5}", "line 2: varied_runs: farthest_m: expected at most"),
        ("varied_runs: {count: 1000000}", "line 2: varied_runs: count: expected at most 100"),
        ("points: {moves: 0, spiral: 0}", "line 2: points: all are 0"),
        ("points:\n  spiral: x", "line 3: points: spiral: expected a number, found 'x'"),
        ("may: [fly]", "line 2: may: expected some of clear, set_pen, kill, "),
        ("may: turtle1", "line 2: may: expected"),
        (
            "scene: graph\nvaried_runs: null\ndrives: [turtle1]",
            "line 4: drives: expected some of none, found",
        ),
        ("starter: nowhere", "line 2: starter: there is no 'nowhere'"),
        (b"title: caf\xe9", "line 2: it is not UTF-8"),
        ("title: a\0", "line 2: the character"),
        ("points: " + "[" * 5000, "it is nested too deeply"),
        ("points: " + "{a: " * 5000, "it is nested too deeply"),
    ],
)
def test_a_slip_is_told_with_file_and_line(tmp_path, text, words):
    head = text if isinstance(text, bytes) else text.encode()
    message = message_of(written(tmp_path, f"exercise: {NAME}\n".encode() + head))
    assert message.startswith("mine.yaml")
    assert words in message


def test_a_copy_of_an_exercise_in_a_folder_must_lie_there(tmp_path):
    said = message_of(written(tmp_path, "exercise: corner\n"))
    assert "must lie in that exercise's own folder" in said


def with_interfaces(tmp_path, text="int8 num\n", where="interfaces"):
    tmp_path.mkdir(exist_ok=True)
    folder = exercises.write(tmp_path / "ahead", interfaces="interfaces")
    package = folder / where / "course_interfaces" / "msg"
    package.mkdir(parents=True)
    (package / "Num.msg").write_text(text)
    return folder


def test_an_exercise_brings_interfaces_along_and_is_another_with_others(tmp_path):
    one, other = (with_interfaces(tmp_path / text, f"{text} num\n") for text in ("int8", "int16"))
    exercise = load_exercise(one)
    assert exercise.interfaces == {"course_interfaces/msg/Num": "int8 num\n"}
    assert exercise.opening["interfaces"] == exercise.interfaces
    assert load_exercise(other).sha256 != exercise.sha256


@pytest.mark.parametrize(
    ("text", "where", "said"),
    [
        (
            "int8 num\nint other\n",
            "interfaces",
            r"exercise\.yaml.*Num\.msg, line 2: `int` is no type",
        ),
        ("int8 num\n", "elsewhere", r"expected a folder with PACKAGE/msg/NAME\.msg"),
        ("int8 num\n" + "# more\n" * 6000, "interfaces", r"with 40,?000 characters"),
    ],
)
def test_interfaces_that_cannot_be_used_are_named(tmp_path, text, where, said):
    with pytest.raises(ExerciseError, match=said):
        load_exercise(with_interfaces(tmp_path, text, where))
