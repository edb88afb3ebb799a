"""The tutorials: right solutions in many styles keep every point, mistakes cost what they must."""

import pytest

import grader
from grader.cli import main
from grader.exercise.loading import load_exercise
from grader.testing.solutions import FILE_NAME, read_solutions
from tests import hand_ins, runs

FOLDER = hand_ins.SUBMISSIONS / "tutorials"
NAMES = sorted(path.name for path in FOLDER.iterdir())
pytestmark = [
    pytest.mark.timeout(3600),
    pytest.mark.more("tests/grader/test_archive.py grades one right and one wrong hand-in of each"),
]
RIGHT = {
    (name, path.stem): path
    for name in NAMES
    for path in sorted((FOLDER / name / "right").iterdir())
    if path.suffix in ("", ".py") and not path.name.startswith("__")
}
#: Those that come with a reference and mutants of their own.
WHOLE = [name for name in NAMES if (load_exercise(name).folder / FILE_NAME).is_file()]
MUTANTS = {
    (n, key): row for n in NAMES for key, row in hand_ins.read(f"tutorials/{n}")["mutants"].items()
}
#: One part of the mutants may slip through: those that only another seed would show.
MOST_MISSED = 0.03
#: What the name of a node, or a definition that is given, is worth [points].
MOST_FOR_NOTHING = 20


def lost(name, key):
    """The checks in which a mutant loses points."""
    result = grader.grade(runs.path_of(f"tutorials/{name}/mutants/{key}"), name)
    return {verdict.check for verdict in result.verdicts if verdict.status != "passed"}


def must_lose(name, key):
    known = {check.name for check in load_exercise(name).checks}
    return set(MUTANTS[name, key]["loses"]) & known


def reference(name):
    return next(each.path for each in read_solutions(load_exercise(name)) if each.is_right)


@pytest.mark.parametrize("name", WHOLE)
def test_the_starter_is_a_package_or_workspace_whose_todos_earn_next_to_nothing(
    name, tmp_path, capsys
):
    assert main(["new", str(tmp_path / "mine"), "--exercise", name]) == 0
    assert "Fill in the TODOs of " in capsys.readouterr().out
    assert list((tmp_path / "mine").rglob("package.xml"))
    assert grader.grade(tmp_path / "mine", name).score <= MOST_FOR_NOTHING


@pytest.mark.parametrize("name", WHOLE)
def test_an_exercise_is_in_order(name, capsys):
    assert main(["check-exercise", name]) == 0, capsys.readouterr().out


@pytest.mark.parametrize(("name", "style"), RIGHT)
def test_each_style_keeps_every_point_three_times_with_one_hash(name, style):
    results = [grader.grade(RIGHT[name, style], name) for _ in range(3)]
    assert {(result.score, result.diagnosis) for result in results} == {(100, None)}
    assert len({tuple(r.trace_sha256 for r in (x.run, *x.varied_runs)) for x in results}) == 1


@pytest.mark.parametrize("name", ["talker_listener", "catch_them_all", "follow_me"])
def test_ten_gradings_of_several_programs_are_one(name):
    results = [grader.grade(reference(name), name) for _ in range(10)]
    assert len({tuple(r.trace_sha256 for r in (x.run, *x.varied_runs)) for x in results}) == 1


def test_of_all_mistakes_nearly_each_costs_what_it_must():
    missed = []
    for name, key in MUTANTS:
        found = lost(name, key)
        if not found or not must_lose(name, key) <= found:
            missed.append((name, key, found))
    assert len(missed) <= MOST_MISSED * len(MUTANTS), missed


@pytest.mark.parametrize("name", ["talker", "tf2_broadcaster"])
def test_real_time_gives_the_same_points(name):
    assert grader.grade(RIGHT[name, "official"], name, time="real").score == 100
