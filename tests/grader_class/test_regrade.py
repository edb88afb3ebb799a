import csv
import shutil
from argparse import Namespace
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest

from grader.cli import GRADER_FAILED, main
from grader.errors import ExerciseError, UsageError
from grader.exercise.loading import load_exercise
from grader.judging import judge, load_recordings
from grader.text.message import msg
from grader_class import regrade
from grader_class.class_file import ClassFile
from grader_class.cli import grading
from grader_class.entry import Entry, entries
from grader_class.store import RECORDING, UNFINISHED, Store
from tests.files import contents
from tests.grader.exercise.result.test_kept import KEPT, unpacked
from tests.grader_class import classes
from tests.grader_class.conftest import QUICK
from tests.tiers import others_are_more

#: Sides are to be longer, corners are worth more, nobody has to stop; runs may last longer.
POINTS = "points: {drives: 5, sides: 25, corners: 30, straight: 10, returns: 15}"
HEAD = QUICK.partition("points")[0]
CHANGED = f"{HEAD}{POINTS}\ntolerances: {{side_m: 3.0}}\nlimits: {{total_s: 99}}\n"
JUDGED = ("crashes", "leaves", "right", "twin")


@pytest.fixture
def old(small_class):
    return str(small_class.exercise)


@pytest.fixture(scope="module")
def new(small_class, tmp_path_factory):
    place = tmp_path_factory.mktemp("new") / "own_square"
    own = Path(shutil.copytree(small_class.exercise.parent, place))
    (own / "changed.yaml").write_text(CHANGED)
    return str(own / "changed.yaml")


@pytest.fixture
def out(out, in_process):
    """The class, graded by the old one; right and twin share a run."""
    return out


def call(out, rubric, *, apply=False):
    words = {"regrade": out, "exercise": rubric, "apply": apply, "out": None, "jobs": 1}
    words |= {"after_due": False, "assignment": ""}
    return grading.regrade_class(Namespace(**words))


def rows(text):
    return {row["student"]: row for row in csv.DictReader(text.splitlines())}


def scores(out):
    return {entry.id: entry.score for entry in entries(out)}


@cache
def expected(graded, rubric):
    keys = {id: Entry.read(graded / "submissions" / id).key for id in JUDGED}
    found = {key: load_recordings(Store(graded).run(key) / RECORDING) for key in {*keys.values()}}
    scores = {key: judge(each, load_exercise(rubric)).score for key, each in found.items()}
    return {id: scores[key] for id, key in keys.items()}


def test_who_changes_and_by_which_check_is_what_judging_in_memory_finds(
    graded, new, tmp_path, capsys
):
    """By a worker of its own."""
    look = tmp_path / "look"
    words = ["batch", "--regrade", str(graded), "--exercise", new, "--out", str(look)]
    assert main([*words, "--jobs", "1"]) == 0
    table, said = capsys.readouterr()
    assert (look / "changes.csv").read_text() == table
    right = rows(table)["right"]
    assert (float(right["before"]), float(right["after"])) == (85, expected(graded, new)["right"])
    words = {"sides": "lost", "corners": "gained", "stops": "lost", "drives": "", "late": ""}
    assert words.items() <= right.items()
    assert rows(table).keys() == {"right", "twin"}
    for told in (
        "2 of 6 change: 0 get more points, 2 get fewer points.",
        "4 of 4: The recording was made with limits.total_s ",
        "The class was not changed.",
    ):
        assert told in " ".join(said.split())


def test_by_the_same_rubric_nothing_changes_but_what_is_missing_is_told(out, old):
    """As the recording of somebody else, which is not judged for a hand-in."""
    right, leaves = (Entry.read(out / "submissions" / id).key for id in ("right", "leaves"))
    shutil.rmtree(Store(out).run(leaves))
    shutil.copytree(Store(out).run(right), Store(out).run(leaves))
    (out / "submissions" / "crashes" / "entry.json").write_text("{")
    found = regrade.regrade(out, old, 1)
    assert rows(found.table).keys() == {"leaves"}
    assert str(found.headline).startswith("0 of 5 change: ")
    assert [str(note) for note in found.notes] == ["The class is not finished: 5 of 6."]
    ((entry, why),) = found.failures
    assert entry.id == "leaves"
    assert str(why).startswith("its recording is not the one that its result was made of.")


def test_another_deduction_for_lateness_has_a_word_of_its_own(graded, monkeypatch):
    entry = Entry.read(graded / "submissions" / "right")
    score = property(lambda self: self.result.score - (20 if self.message else 5))
    monkeypatch.setattr(Entry, "score", score)
    later = replace(entry, message=msg("two days late"))
    assert regrade.words_of(entry, later) == {"late": "late"}


def test_the_exercise_has_to_be_that_of_the_class(graded, old, tmp_path):
    with pytest.raises(UsageError, match=r"graded for the exercise 'own_square', and"):
        regrade.regrade(graded, "square", 1)
    with pytest.raises(UsageError, match="is no folder of a class"):
        call(tmp_path, old, apply=True)
    (tmp_path / "bad.yaml").write_text("exercise: square\npoints: {spirals: 3}\n")
    with pytest.raises(ExerciseError, match="spirals"):
        regrade.regrade(graded, str(tmp_path / "bad.yaml"), 1)


def test_what_cannot_be_judged_again_is_told_and_stays_as_it_is(out, new, capsys):
    leaves = Entry.read(out / "submissions" / "leaves")
    bag = Store(out).run(leaves.key) / RECORDING / "recording.mcap"
    bag.unlink()  # it is linked with that of the hand-in
    bag.write_bytes(b"no bag")
    before = contents(leaves.folder)
    assert call(out, new, apply=True) == GRADER_FAILED
    assert contents(leaves.folder) == before
    said = capsys.readouterr()
    assert rows(said.out)["leaves"]["after"] == ""
    assert "not judged again: leaves: " in said.err
    assert "is damaged: it is cut off or was changed" in " ".join(said.err.split())
    assert scores(out)["twin"] == float(rows(said.out)["twin"]["after"])


def test_nobody_is_changed_unless_applied_and_the_way_back_leads_to_the_old_results(
    out, graded, old, new, tmp_path, capsys
):
    files, before = contents(out), {entry.id: entry.result for entry in entries(out)}
    (out / "changes.csv").symlink_to(tmp_path / "elsewhere")
    assert call(out, new) == 0
    said = capsys.readouterr()
    assert (out / "changes.csv").read_text() == said.out
    assert "The class was not changed." in said.err
    (out / "changes.csv").unlink()
    assert contents(out) == files
    assert not (tmp_path / "elsewhere").exists()

    assert call(out, new, apply=True) == 0
    exercise, found = load_exercise(new), {entry.id: entry for entry in entries(out)}
    assert ClassFile.read(out).exercise_sha256 == exercise.sha256
    assert {(e.exercise_sha256, e.max_score) for e in found.values()} == {(exercise.sha256, 85)}
    assert scores(out) == {**expected(graded, new), "broken": 0.0, "nobody": 0.0}
    for id in JUDGED:
        assert (found[id].folder / RECORDING / "recording.mcap").is_file()
        assert (found[id].folder / "report.html").stat().st_size > 1000
    assert call(out, old, apply=True) == 0
    assert {entry.id: entry.result for entry in entries(out)} == before


MIDDLE = "the middle place stands for the others"


@pytest.mark.parametrize("after", others_are_more(MIDDLE, range(5), 2))
def test_an_interrupted_call_leaves_each_as_it_was_or_as_it_will_be(
    out, graded, old, new, monkeypatch, after
):
    put, calls = Store.put, iter(range(99))
    sides = {load_exercise(path).sha256: expected(graded, path) for path in (old, new)}

    def interrupted(self, key, place):
        if next(calls) == after:
            raise KeyboardInterrupt
        put(self, key, place)

    with monkeypatch.context() as patch:
        patch.setattr(Store, "put", interrupted)
        with pytest.raises(KeyboardInterrupt):
            call(out, new, apply=True)
    found = {entry.id: entry for entry in entries(out)}
    assert found.keys() == {*JUDGED, "broken", "nobody"}
    assert all(found[id].score == sides[found[id].exercise_sha256][id] for id in JUDGED)
    assert ClassFile.read(out).exercise_sha256 == load_exercise(old).sha256
    call(out, new, apply=True)
    assert scores(out) == {**sides[load_exercise(new).sha256], "broken": 0.0, "nobody": 0.0}
    assert ClassFile.read(out).exercise_sha256 == load_exercise(new).sha256
    assert not (out / UNFINISHED).exists()


def test_a_call_that_is_killed_between_two_names_gives_back_what_it_took(out):
    """Power goes when the older folder has been moved away and the new one is not there yet."""
    before = scores(out)
    with Store.opened(out) as store:
        store.student("right").rename(store.new_place() / "older-right")
        shutil.copytree(out / UNFINISHED, out.parent / "left")
    (out.parent / "left").rename(out / UNFINISHED)
    with Store.opened(out):
        pass
    assert scores(out) == before


def test_a_changed_rubric_changes_what_it_says_and_nothing_else(tmp_path):
    kept_class = Path(shutil.copytree(unpacked() / "class", tmp_path / "class"))

    def regrade(rubric, *words):
        exercise = ["--exercise", str(KEPT / rubric), "--jobs", "1"]
        return main(["batch", "--regrade", str(kept_class), *exercise, *words])

    assert regrade("before.yaml") == 0
    assert classes.rows(kept_class / "changes.csv") == {}
    assert regrade("after.yaml", "--apply") == 0
    changes = classes.rows(kept_class / "changes.csv").items()
    told = {who: [row[name] for name in ("sides", "returns", "late")] for who, row in changes}
    # 2 m, where 3 m are asked for
    assert told == {"anna": ["lost", "lost", ""], "chen": ["gained", "lost", "late"]}
    gradebook = classes.rows(kept_class / "gradebook.csv").items()
    finals = {who: float(row["final"]) for who, row in gradebook}
    assert finals == {"anna": 55, "ben": 0, "chen": 81, "dora": 0}
