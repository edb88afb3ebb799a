"""Exercises outside the package: in a folder, in an installed package, and bad ones."""

import os
import signal
from pathlib import Path

import pytest
import yaml

from grader.errors import ExerciseError
from grader.exercise import places
from grader.exercise.check import judge
from grader.exercise.loading import load_exercise
from grader.recording.recording import Recordings
from grader.system import extensions
from grader.testing import drive
from tests.grader.testing.exercises import refusal

SCENES = ", ".join(extensions.points(extensions.SCENES))
DESCRIPTION = {
    "exercise": "corner",
    "title": "Drive to the corner",
    "limits": {"first_motion_s": 2, "rest_s": 1, "total_s": 5},
    "points": {"moves": 10},
    "tolerances": {"corner_m": 1.0},
}
CHECKS = """from grader import Checks, Finding, Recordings, Tolerances
from .shape import WORDS

checks = Checks()


@checks()
def moves(recordings: Recordings, tolerances: Tolerances) -> Finding:
    '''It moves.'''
    return Finding(1, WORDS)
"""


def write(folder, description=DESCRIPTION, checks=CHECKS, shape="WORDS = 'it moved'\n"):
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "exercise.yaml").write_text(yaml.safe_dump(description))
    (folder / "checks.py").write_text(checks)
    (folder / "shape.py").write_text(shape)
    return folder


def rationale(exercise):
    recordings = Recordings(drive(lambda *_: None, ticks=2))
    (verdict,) = judge(recordings, exercise.checks, exercise.points, exercise.tolerances)
    return str(verdict.rationale)


def test_a_folder_is_an_exercise_by_its_path_that_of_its_yaml_or_as_a_package(
    tmp_path, monkeypatch
):
    exercise = load_exercise(write(tmp_path / "corner"))
    assert (exercise.name, exercise.points) == ("corner", {"moves": 10})
    assert rationale(exercise) == "it moved"
    write(tmp_path / "corner")
    monkeypatch.chdir(tmp_path)
    assert load_exercise("corner").name == "corner"
    assert load_exercise("corner/exercise.yaml").name == "corner"
    assert not list(tmp_path.rglob("*.pyc"))
    folder = write(tmp_path, checks=CHECKS.replace(".shape", "."))
    (folder / "__init__.py").write_text("from .shape import WORDS\n")
    assert rationale(load_exercise(folder)) == "it moved"


def test_an_edited_copy_of_this_or_of_an_installed_exercise_may_lie_there(tmp_path):
    folder = write(tmp_path)
    (folder / "hard.yaml").write_text("exercise: corner\ntolerances: {corner_m: 0.1}\n")
    hard = load_exercise(folder / "hard.yaml")
    assert (hard.tolerances, hard.points) == ({"corner_m": 0.1}, {"moves": 10})
    (folder / "hard.yaml").write_text("exercise: square\npoints: {drives: 1}\n")
    assert load_exercise(folder / "hard.yaml").points == {"drives": 1}


def test_two_folders_and_two_versions_of_one_do_not_meet(tmp_path):
    first = load_exercise(write(tmp_path / "a", shape="WORDS = 'first'\n"))
    second = load_exercise(write(tmp_path / "b", shape="WORDS = 'second one'\n"))
    edited = load_exercise(write(tmp_path / "a", shape="WORDS = 'edited'\n"))
    assert [rationale(each) for each in (first, second, edited)] == [
        *("first", "second one", "edited")
    ]


@pytest.mark.parametrize(
    ("checks", "words"),
    [
        ("x = 1\n\ndef f(:\n", "checks.py, line 3: SyntaxError"),
        ("x = 1\n", "checks.py: expected `checks = Checks()`"),
        ("checks = []\n", "found a list"),
        ("\nprint(nobody)\n", "checks.py, line 2: NameError: name 'nobody'"),
        ("import shape\n", "line 1: ModuleNotFoundError: No module named 'shape'"),
        ("import shape\n", "by `from . import shape`"),
        ("import sys\nsys.exit(0)\n", "checks.py, line 2: SystemExit: 0"),
        ("raise BaseException('no')\n", "checks.py, line 1: BaseException: no"),
        ("from . import helper\n", "line 1: ImportError: there is no helper.py beside checks.py"),
        ("from .helper import x\n", "ModuleNotFoundError: there is no helper.py beside checks.py"),
        ("from .shape import other\n", "cannot import name 'other'"),
        ("from .broken import WORDS\n", "broken.py, line 3: ZeroDivisionError"),
        ("x = 1\0\n", "checks.py: SyntaxError: source code string cannot contain null bytes"),
        ("x = '\udce9'\n", "checks.py"),
        (CHECKS.replace("@checks()", "@checks"), "checks.py, line 7: TypeError: write @checks()"),
        (CHECKS.replace("@checks()", "@checks(after=('be',))"), "line 7: ValueError"),
    ],
)
def test_a_mistake_in_its_code_is_told_with_the_file(tmp_path, checks, words):
    folder = write(tmp_path)
    (folder / "broken.py").write_text("\n\n1 / 0\n")
    (folder / "checks.py").write_text(checks, errors="surrogateescape")
    refused = refusal(folder)
    assert words in refused
    assert str(tmp_path) in refused


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"exercise": "square"}, "'square' is the name of an installed exercise"),
        ({"exercise": ["a"]}, "exercise: expected a name such as my_exercise, found ['a']"),
        (
            {"limits": {"rest_s": 1}},
            "rest_s, total_s, found {'rest_s': 1}",
        ),
        ({"limits": 5}, "limits: expected an object of first_motion_s, rest_s, total_s, found 5"),
        ({"varied_runs": [1]}, "varied_runs: expected an object of count, seed"),
        ({"tolerances": [1]}, "tolerances: expected an object, found [1]"),
        ({"points": {"fly": 1}}, "points: no check is named 'fly'; there are moves"),
        ({"scene": "moon"}, f"scene: expected one of {SCENES}, found 'moon'"),
        ({"points": None}, "has no 'points'"),
    ],
)
def test_a_mistake_in_its_description_is_named(tmp_path, changes, words):
    said = {**DESCRIPTION, **changes}
    assert words in refusal(write(tmp_path, {k: v for k, v in said.items() if v is not None}))


def install(monkeypatch, site, name, value, dist="other"):
    """What pip leaves of a package with an entry point."""
    info = site / f"{dist}-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {dist}\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text(f"[grader.exercises]\n{name} = {value}\n")
    monkeypatch.syspath_prepend(site)


@pytest.mark.parametrize("value", ["others_{}.corner", "others_{}.corner.checks"])
def test_an_installed_package_brings_an_exercise(tmp_path, monkeypatch, value):
    package = f"others_{len(value)}"
    folder = write(tmp_path / package / "corner")
    (folder.parent / "__init__.py").touch()
    install(monkeypatch, tmp_path, "corner", value.format(len(value)))
    assert "corner" in places.names()
    exercise = load_exercise("corner")
    assert (exercise.folder, rationale(exercise)) == (folder, "it moved")
    copy = tmp_path / "copy.yaml"
    copy.write_text("exercise: corner\ntolerances: {corner_m: 3}\n")
    assert load_exercise(copy).tolerances == {"corner_m": 3}


def test_an_installed_exercise_replaces_none_of_the_same_name(tmp_path, monkeypatch):
    write(tmp_path / "others_square", {**DESCRIPTION, "exercise": "square"})
    install(monkeypatch, tmp_path, "square", "others_square")
    assert "others_square of other" in refusal("square")
    assert load_exercise("turtlesim_challenge").points


@pytest.mark.parametrize(
    ("value", "words"),
    [
        ("not_there_at_all", "is not there"),
        ("not_there.at_all", "cannot be imported"),
        ("json", "is not an exercise"),
    ],
)
def test_an_entry_point_that_leads_nowhere_is_told(tmp_path, monkeypatch, value, words):
    install(monkeypatch, tmp_path, "corner", value)
    with pytest.raises(ExerciseError, match=words):
        load_exercise("corner")


def test_a_key_on_the_keyboard_is_not_the_exercise_s(tmp_path):
    # Python's own handler, not that of a command line that ran in this process
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    checks = "import signal\nsignal.raise_signal(signal.SIGINT)\n"
    try:
        with pytest.raises(KeyboardInterrupt):
            load_exercise(write(tmp_path, checks=checks))
    finally:
        signal.signal(signal.SIGINT, before)


def test_importing_neither_prints_to_standard_output_nor_leaves_the_folder(tmp_path, capsys):
    before = Path.cwd()
    wandering = f"import os\nos.chdir({str(tmp_path)!r})\nprint('so far')\n"
    load_exercise(write(tmp_path, checks=wandering + CHECKS))
    assert Path.cwd() == before
    assert capsys.readouterr() == ("", "so far\n")


@pytest.mark.parametrize(
    ("missing", "lay"),
    [
        ("exercise.yaml", lambda file: None),
        ("checks.py", lambda file: None),
        ("checks.py", lambda file: file.symlink_to("gone.py")),
        ("checks.py", Path.mkdir),
        ("checks.py", os.mkfifo),
    ],
)
def test_what_is_no_file_is_missing(tmp_path, missing, lay):
    file = write(tmp_path) / missing
    file.unlink()
    lay(file)
    assert f"is not an exercise: it has no {missing}" in refusal(tmp_path)
