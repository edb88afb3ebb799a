"""A changed rubric: who changes is told rightly, and nothing is lost when it is put into force."""

from __future__ import annotations

import csv
import io
import os
import re
import shutil
from argparse import Namespace
from dataclasses import replace
from pathlib import Path

import pytest
from rich.console import Console

from grader.batch import grade, pool
from grader.batch.batch import Order
from grader.batch.class_file import ClassFile
from grader.batch.entry import Entry, HandIn, Person, entries
from grader.batch.find.joining import NOT_HANDED_IN
from grader.batch.pool import Answer, Task
from grader.batch.regrade import judging, shown
from grader.batch.regrade.changes import Regrade, compared, is_of_words
from grader.batch.store import RECORDING, RUN, STUDENTS, UNFINISHED, Store
from grader.cli import regrading
from grader.errors import ExerciseError, UsageError
from grader.exercise.loading import load_exercise
from grader.judging import judge, save_recordings
from grader.message import NOTHING, Message, msg
from grader.recording.recording import Provenance, Recordings
from tests.grader.driving import RED, Spiral, drive
from tests.tiers import others_are_more

#: One run of each: how many it takes decides nothing here.
BEFORE = """
exercise: turtlesim_challenge
varied_runs: {count: 0}
"""
#: A stop as far as 1.5 m from a wall is near no more; colours cost more; runs may last longer.
CHANGED = f"""{BEFORE}
limits: {{total_s: 200}}
points: {{moves: 5, spiral: 30, steady_rate: 5, edge_stop: 25, pen_per_quadrant: 30, picture: 5}}
tolerances: {{edge_m: 1.0}}
"""
NAMES = {"far": '=HYPERLINK("x")', "red": "<script>alert(1)</script>\x1b[31m"}


def call(
    out: Path, changed: str, *, jobs: int, apply: bool = False, into: Path | None = None
) -> int:
    words = Namespace(regrade=out, exercise=changed, apply=apply, out=into, assignment="")
    return regrading.run(words, jobs, "student")


class StopsFar(Spiral):
    def near_edge(self, tick, pose):
        return min(pose.x, pose.y, 11.09 - pose.x, 11.09 - pose.y) < 1.5


class AllRed(Spiral):
    colors = dict.fromkeys(range(1, 5), RED)


@pytest.fixture(scope="module")
def rubrics(tmp_path_factory) -> dict[str, str]:
    """Paths: the class was graded by `before`."""
    folder = tmp_path_factory.mktemp("rubrics")
    for name, text in (("before", BEFORE), ("changed", CHANGED)):
        (folder / f"{name}.yaml").write_text(text)
    return {path.stem: str(path) for path in folder.iterdir()}


@pytest.fixture(scope="module")
def original(rubrics) -> str:
    return rubrics["before"]


@pytest.fixture(scope="module")
def changed(rubrics) -> str:
    return rubrics["changed"]


@pytest.fixture(scope="module")
def runs(original) -> dict[str, Recordings]:
    conditions = load_exercise(original).conditions
    origin = Provenance("2026-11-21T12:00:00Z", "1", "3.12", "7", conditions=conditions)
    kinds = (Spiral, StopsFar, AllRed)
    return {kind.__name__: Recordings(replace(drive(kind()), provenance=origin)) for kind in kinds}


@pytest.fixture(scope="module")
def expected(runs, original, changed) -> dict[str, tuple[float, float]]:
    """The scores before and after, by id, of those who are judged: as judging in memory finds."""
    rubrics = [load_exercise(path) for path in (original, changed)]
    return {
        name: tuple(judge(runs[kind], each).score for each in rubrics)
        for kind, names in CLASS.values()
        for name in names
    }


#: Key of a run -> what it is, and who has handed it in; two have handed in the same.
CLASS = {
    "a" * 32: ("Spiral", ["right", "twin"]),
    "b" * 32: ("StopsFar", ["far"]),
    "c" * 32: ("AllRed", ["red"]),
}


def hand_in(name: str, problem: Message = NOTHING) -> HandIn:
    return HandIn(name, (Person(f"{name}-1", NAMES.get(name, name.title())),), problem=problem)


@pytest.fixture(scope="module")
def whole(runs, original, tmp_path_factory) -> Path:
    """A class that is graded: with somebody who handed in nothing, and a failure of the grader."""
    out = tmp_path_factory.mktemp("class") / "out"
    exercise = load_exercise(original)
    with Store.opened(out) as store:
        Order(exercise, "").class_file.put(out)
        for key, (kind, names) in CLASS.items():
            place = store.new_place()
            save_recordings(runs[kind], place / RUN / RECORDING)
            people = tuple(map(hand_in, names))
            task = Task(key, people, Path(), "", original, "virtual", None, place / RUN, place)
            grade.make(task)
            store.put(key, place)
        place = store.new_place()
        grade.nothing(hand_in("nobody", NOT_HANDED_IN), exercise, place / STUDENTS / "nobody")
        why = msg("A disk was full.")
        grade.failed(hand_in("unlucky"), exercise, place / STUDENTS / "unlucky", why)
        store.put("", place)
    (out / "gradebook.csv").write_text("as it was\n")
    return out


@pytest.fixture
def out(whole, tmp_path) -> Path:
    return Path(shutil.copytree(whole, tmp_path / "out"))


def work(tasks, jobs, patience_s):
    """The workers' work in this process, for tests of what comes of it."""
    for task in tasks:
        yield task, grade.done(task)


@pytest.fixture
def in_process(monkeypatch):
    monkeypatch.setattr(pool, "work", work)


@pytest.fixture(scope="module")
def found(whole, changed) -> Regrade:
    """What a changed rubric changes in the class, which nobody has changed."""
    with pytest.MonkeyPatch.context() as monkeypatch:
        monkeypatch.setattr(pool, "work", work)
        return judging.regrade(whole, changed, 1)


@pytest.fixture(scope="module")
def in_force(whole, changed, tmp_path_factory) -> Path:
    """The class with the changed rubric applied; nobody changes it further."""
    out = tmp_path_factory.mktemp("applied") / "out"
    shutil.copytree(whole, out)
    with pytest.MonkeyPatch.context() as monkeypatch:
        monkeypatch.setattr(pool, "work", work)
        assert applied(out, changed) == 0
    return out


def tree(folder: Path) -> dict[str, bytes]:
    paths = (path for path in folder.rglob("*") if path.is_file())
    return {str(path.relative_to(folder)): path.read_bytes() for path in paths}


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def scores(found: Regrade) -> dict[str, tuple[float | None, float | None]]:
    return {change.before.id: (change.before.score, change.after.score) for change in found.changes}


# What is told ---------------------------------------------------------------------------------


def test_who_changes_and_by_how_much_is_what_judging_in_memory_finds(whole, changed, expected):
    """By real workers."""
    found = judging.regrade(whole, changed, jobs=2)
    assert scores(found) == expected  # each has lost a check that is asked for no more
    assert not found.failures
    assert found.judged == len(expected) == 4
    assert found.headline == ("4 of 6 change: 2 get fewer points, 2 keep theirs by other verdicts.")


def test_which_check_and_why_is_told_of_each(found):
    (far,) = (change for change in found.changes if change.before.id == "far")
    by_check = {each.check: each for each in far.differences}
    stop = by_check["edge_stop"]
    assert (stop.before.status, stop.after.status, stop.points) == ("passed", "failed", -25)
    assert stop.why == str(stop.after.rationale)
    assert "1 m or less is near" in stop.why
    assert by_check["pen_per_quadrant"].points == 10
    assert by_check["pen_per_quadrant"].why.startswith("It is worth 30 points, not 20.")
    assert by_check["no_redundant_calls"].why == "It is no longer asked for."
    assert round(sum(each.points for each in far.differences), 2) == far.points


def test_the_checks_are_summed_up_over_the_class(found):
    of = {each.check: each for each in found.of_checks}
    assert (of["edge_stop"].gain, of["edge_stop"].lose, of["edge_stop"].points) == (0, 1, -25)
    total = sum(change.points for change in found.changes)
    assert round(sum(each.points for each in found.of_checks), 2) == round(total, 2)


def test_what_a_recording_cannot_follow_is_told(found):
    notes = found.more_notes
    assert (
        "4 of 4: The recording was made with limits.total_s 180; the exercise now says 200. "
        "Run the submission again for that." in notes
    )
    assert "2 hand-ins without a run stay as they are." in notes


def test_another_worth_of_the_whole_is_told(whole, tmp_path, in_process):
    path = tmp_path / "changed.yaml"
    path.write_text(f"{BEFORE}points: {{moves: 7, spiral: 30}}\n")
    found = judging.regrade(whole, str(path), 1)
    assert "The exercise is worth 37 points; it was 100." in found.more_notes


def test_the_same_rubric_changes_nothing(whole, original, in_process):
    found = judging.regrade(whole, original, 1)
    assert (found.changes, found.reworded) == ((), ())
    assert found.headline == "None of 6 changes."
    assert "The class was graded by just this exercise." in found.more_notes


def test_who_only_reads_other_words_does_not_count_as_changed(whole, tmp_path, in_process):
    path = tmp_path / "changed.yaml"
    path.write_text(f"{BEFORE}tolerances: {{rate_deviation: 0.31}}\n")
    found = judging.regrade(whole, str(path), 1)
    assert not found.changes
    assert all(is_of_words(change) for change in found.reworded)


def test_what_is_deducted_from_a_score_counts_as_well(out, monkeypatch):
    """As where another date is due."""
    (entry,) = (entry for entry in entries(out) if entry.id == "right")
    later = replace(entry, message=msg("two days late"))
    score = property(lambda self: self.result.score - (20 if self.message else 5))
    monkeypatch.setattr(Entry, "score", score)
    change = compared(entry, later)
    assert change is not None
    (difference,) = change.differences
    assert (change.points, difference.points, difference.check) == (-15, -15, "")
    assert difference.why == "20 points are deducted from the score, not 5"


def test_the_exercise_has_to_be_that_of_the_class(whole, original, tmp_path):
    with pytest.raises(UsageError, match=r"graded for the exercise 'turtlesim_challenge', and"):
        judging.regrade(whole, "square", 1)
    with pytest.raises(UsageError, match="is no folder of a class"):
        judging.regrade(tmp_path, original, 1)
    (tmp_path / "bad.yaml").write_text("exercise: turtlesim_challenge\npoints: {spirals: 3}\n")
    with pytest.raises(ExerciseError, match="spirals"):
        judging.regrade(whole, str(tmp_path / "bad.yaml"), 1)


# What cannot be judged again ------------------------------------------------------------------


def test_a_recording_that_cannot_be_read_is_told_and_no_other_is_touched_by_it(
    out, changed, in_process
):
    bag = Store(out).run("b" * 32) / RECORDING / "recording.mcap"
    bag.unlink()  # it is linked with that of the hand-in
    bag.write_bytes(b"no bag")
    found = judging.regrade(out, changed, 1)
    (failure,) = found.failures
    assert failure.entry.id == "far"
    assert "is damaged: it is cut off or was changed" in str(failure.why)
    assert scores(found).keys() == {"right", "twin", "red"}
    said = io.StringIO()
    shown.show(found, Console(file=said, width=200))
    assert "Not judged again, and left as it is: far: " in said.getvalue()
    assert "not judged again: " in shown.table(found)


def test_a_worker_that_dies_is_told_for_its_own_recording(whole, changed, monkeypatch):
    dies = (
        "import os, sys; sys.path.insert(0, sys.argv[1]); from grader.batch import grade; "
        "done = grade.done; "
        "grade.done = lambda task: os._exit(9) if task.key[0] == 'c' else done(task); "
        "grade.serve(sys.argv[2])"
    )
    monkeypatch.setattr(pool, "_COMMAND", ("-P", "-c", dies, pool._COMMAND[-1]))
    found = judging.regrade(whole, changed, 1)
    assert {failure.entry.id: str(failure.why) for failure in found.failures} == {
        "red": "the process that graded it ended (exit code 9), 2 times"
    }
    assert found.judged == 3


def test_a_worker_that_is_stuck_is_ended_and_told(whole, changed, monkeypatch):
    stuck = "import sys\nfor line in sys.stdin: sys.stdin.readline()"
    monkeypatch.setattr(pool, "_COMMAND", ("-c", stuck))
    monkeypatch.setattr(judging, "MOST_S", 0.2)
    found = judging.regrade(whole, changed, 4)
    assert {failure.entry.id for failure in found.failures} == {"right", "twin", "far", "red"}
    assert str(found.failures[0].why) == "the process that graded it ended (SIGKILL), 2 times"


def test_a_recording_that_lies_with_the_hand_in_alone_is_judged_and_kept(
    out, changed, expected, in_process
):
    shutil.rmtree(Store(out).run("b" * 32))
    assert call(out, changed, jobs=1, apply=True) == 0
    (far,) = (entry for entry in entries(out) if entry.id == "far")
    assert far.score == expected["far"][1]
    assert (far.folder / RECORDING / "recording.mcap").is_file()
    assert Store(out).has("b" * 32)


def test_the_recording_of_somebody_else_is_not_judged_for_a_hand_in(out, changed, in_process):
    far, right = (Store(out).run(letter * 32) for letter in "ba")
    shutil.rmtree(far)
    shutil.copytree(right, far)
    found = judging.regrade(out, changed, 1)
    assert {failure.entry.id: str(failure.why) for failure in found.failures} == {
        "far": "its recording is not the one that its result was made of. To have it graded anew: "
        "grader batch ... --again far"
    }


def test_what_is_no_part_of_a_recording_stays_out_of_the_store(out, changed, in_process):
    shutil.rmtree(Store(out).run("b" * 32))
    recording = out / "submissions" / "far" / RECORDING
    os.mkfifo(recording / "pipe")
    (recording / "link").symlink_to(out)
    assert call(out, changed, jobs=1, apply=True) == 0
    kept = Store(out).run("b" * 32) / RECORDING
    assert names(kept) == [name for name in names(recording) if name not in ("link", "pipe")]


def test_who_is_missing_since_a_file_is_damaged_is_told(out, changed, in_process):
    replace(ClassFile.read(out), hand_ins=6).put(out)
    (out / "submissions" / "far" / "entry.json").write_text("{")
    found = judging.regrade(out, changed, 1)
    assert f"{out} is not finished: 5 of 6 hand-ins." in found.more_notes


def test_an_exercise_that_fails_is_named_where_it_is_applied_too(
    out, changed, in_process, monkeypatch, capsys
):
    failed = Answer("exercise", "ValueError: mine (checks.py, line 3)")
    monkeypatch.setattr(grade, "done", lambda task: failed)
    call(out, changed, jobs=1, apply=True)
    said = " ".join(capsys.readouterr().out.split())
    assert "The exercise's own code failed: ValueError: mine (checks.py, line 3)" in said


# Writing --------------------------------------------------------------------------------------


def test_nothing_is_written_that_is_not_asked_for(out, changed, in_process, capsys):
    before = tree(out)
    assert call(out, changed, jobs=1) == 0
    assert names(out / "regrade") == ["changes.csv", "changes.html"]
    shutil.rmtree(out / "regrade")
    assert tree(out) == before
    said = capsys.readouterr().out
    assert said.startswith("4 of 6 change: ")
    assert "Nothing of the class was changed." in said


def test_a_link_in_the_place_of_table_and_page_is_not_followed(out, changed, in_process, tmp_path):
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    (out / "regrade").symlink_to(elsewhere)
    call(out, changed, jobs=1)
    assert names(out / "regrade") == ["changes.csv", "changes.html"]
    assert names(elsewhere) == []


def test_table_and_page_are_written_where_they_are_asked_for(out, changed, in_process, tmp_path):
    before = tree(out)
    call(out, changed, jobs=1, into=tmp_path / "look")
    assert tree(out) == before
    assert names(tmp_path / "look") == ["changes.csv", "changes.html"]


def applied(out: Path, changed: str) -> int:
    return call(out, changed, jobs=1, apply=True)


def test_applied_everybody_has_the_new_result_and_the_old_one_is_beside(
    whole, in_force, changed, expected
):
    before, out, exercise = tree(whole), in_force, load_exercise(changed)
    for entry in entries(out):
        assert entry.exercise_sha256 == exercise.sha256
        assert entry.max_score == 100
        if entry.state == "judged":
            assert entry.score == expected[entry.id][1]
            assert (entry.folder / RECORDING / "recording.mcap").is_file()
            assert (entry.folder / "report.html").stat().st_size > 1000
    assert ClassFile.read(out).exercise_sha256 == exercise.sha256
    kept = tree(out / "before" / "1")
    own = [f"submissions/{name}/{file}.json" for name in expected for file in ("result", "entry")]
    assert kept.keys() == {"changes.csv", "changes.html", "class.json", "gradebook.csv", *own}
    for name in kept.keys() - {"changes.csv", "changes.html"}:
        assert kept[name] == before[name]


def test_who_has_no_result_stays_so(in_force):
    states = {entry.id: (entry.state, entry.score, entry.message) for entry in entries(in_force)}
    assert states["nobody"] == ("nothing", 0.0, NOT_HANDED_IN)
    assert states["unlucky"] == ("failed", None, msg("A disk was full."))


def test_what_is_applied_is_applied_once(in_force, changed, in_process, tmp_path, capsys):
    call(in_force, changed, jobs=1, into=tmp_path)
    assert capsys.readouterr().out.startswith("None of 6 changes.")


def test_a_second_regrade_is_kept_beside_the_first_and_the_way_back_leads_to_the_same_results(
    whole, in_force, original, in_process, tmp_path
):
    before = {entry.id: entry.result for entry in entries(whole)}
    out = Path(shutil.copytree(in_force, tmp_path / "out"))
    applied(out, original)
    assert {entry.id: entry.result for entry in entries(out)} == before
    assert names(out / "before") == ["1", "2"]
    again = {entry.id: entry.score for entry in entries(out)}
    kept = map(Entry.read, (out / "before/1/submissions").iterdir())
    first = {entry.id: entry.score for entry in kept}
    assert first.items() <= again.items()


MIDDLE = "the middle place stands for the others"


@pytest.mark.parametrize("after", others_are_more(MIDDLE, range(5), 2))
def test_an_interrupted_call_leaves_each_as_it_was_or_as_it_will_be(
    out, original, changed, expected, in_process, monkeypatch, after
):
    """And the same call again does the rest."""
    put, calls = Store.put, iter(range(99))

    def interrupted(self, key, place):
        if next(calls) == after:
            raise KeyboardInterrupt
        put(self, key, place)

    monkeypatch.setattr(Store, "put", interrupted)
    with pytest.raises(KeyboardInterrupt):
        applied(out, changed)
    shas = set()
    found = {entry.id: entry for entry in entries(out)}
    assert found.keys() == {*expected, "nobody", "unlucky"}
    for name, (old, new) in expected.items():
        is_new = found[name].exercise_sha256 == load_exercise(changed).sha256
        assert found[name].score == (new if is_new else old)
        assert found[name].result.provenance.judged.exercise_sha256 == found[name].exercise_sha256
        shas.add(is_new)
    assert shas == ({False} if after == 0 else {True, False} if after < 3 else {True})
    assert ClassFile.read(out).exercise_sha256 == load_exercise(original).sha256
    monkeypatch.setattr(Store, "put", put)
    applied(out, changed)
    assert {e.id: e.score for e in entries(out) if e.id in expected} == {
        name: new for name, (_, new) in expected.items()
    }
    assert ClassFile.read(out).exercise_sha256 == load_exercise(changed).sha256
    assert not (out / UNFINISHED).exists()


def test_a_call_that_is_killed_between_two_names_gives_back_what_it_took(out, expected):
    """Power goes when the older folder has been moved away and the new one is not there yet."""
    with Store.opened(out) as store:
        place = store.new_place()
        store.student("far").rename(place / "older-far")
        shutil.copytree(out / UNFINISHED, out.parent / "left")
    (out.parent / "left").rename(out / UNFINISHED)
    assert "far" not in {entry.id for entry in entries(out)}
    with Store.opened(out):
        pass
    (far,) = (entry for entry in entries(out) if entry.id == "far")
    assert far.score == expected["far"][0]


def test_what_cannot_be_judged_again_stays_as_it_is(out, changed, in_process):
    bag = Store(out).run("b" * 32) / RECORDING / "recording.mcap"
    bag.unlink()
    bag.write_bytes(b"no bag")
    before = tree(out / "submissions" / "far")
    assert applied(out, changed) == regrading.GRADER_FAILED
    assert tree(out / "submissions" / "far") == before


def test_two_do_not_write_at_once(out, changed, in_process):
    with Store.opened(out), pytest.raises(UsageError, match="another grading writes into"):
        applied(out, changed)


# For people -----------------------------------------------------------------------------------


def test_the_table_has_a_row_a_check_and_adds_up(found, expected):
    rows = list(csv.DictReader(io.StringIO(shown.table(found))))
    for name, (old, new) in expected.items():
        own = [row for row in rows if row["id"] == name]
        assert {(float(row["before"]), float(row["after"])) for row in own} == {(old, new)}
        assert sum(float(row["check_change"]) for row in own) == pytest.approx(new - old)
    (stop,) = (row for row in rows if (row["id"], row["check"]) == ("far", "edge_stop"))
    assert (stop["verdict_before"], stop["verdict_after"]) == ("passed", "failed")


def test_no_name_is_a_formula_a_tag_or_an_escape(found):
    assert not re.search(r'(^|,)"?=', shown.table(found), re.MULTILINE)
    page = shown.page(found, "..")
    assert "<script>alert" not in page
    assert "&lt;script&gt;alert(1)" in page
    said = io.StringIO()
    shown.show(found, Console(file=said, width=100, force_terminal=False))
    assert "\x1b" not in said.getvalue() + page


def test_the_page_stands_alone_and_leads_to_each_report(found):
    page = shown.page(found, "../..")
    assert found.headline in page
    assert 'href="../../submissions/far/report.html"' in page
    assert not re.search(r'(src|href)="(?!\.\./\.\./submissions/)', page)
    assert "default-src 'none'" in page


def test_the_page_of_a_large_class_shows_the_largest_changes_and_names_the_table(
    found, monkeypatch
):
    assert "changes.csv" not in shown.page(found, "..")
    monkeypatch.setattr(shown, "MOST_ON_PAGE", 1)
    page = shown.page(found, "..")
    largest = max(found.changes, key=lambda change: abs(change.points))
    assert re.findall(r'href="../submissions/(\w+)/report.html"', page) == [largest.before.id]
    assert f"the first 1 of {len(found.changes)}; changes.csv has all" in page


def test_the_terminal_tells_the_largest_changes_first_and_how_many_more(found, monkeypatch):
    monkeypatch.setattr(shown, "MOST", 1)
    said = io.StringIO()
    shown.show(found, Console(file=said, width=160))
    lines = said.getvalue().splitlines()
    assert lines[0] == found.headline
    largest = max(found.changes, key=lambda change: abs(change.points))
    assert any(line.startswith(largest.before.id) for line in lines)
    assert lines[-1].startswith("… and 3 more hand-ins")


def test_what_is_kept_before_anything_changes_is_whole_or_not_there(
    out, changed, in_process, monkeypatch
):
    before = tree(out)

    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(judging.shown, "table", full)
    monkeypatch.setattr(regrading, "_write", lambda *_: None)
    with pytest.raises(UsageError, match="No space left"):
        applied(out, changed)
    assert tree(out) == before
