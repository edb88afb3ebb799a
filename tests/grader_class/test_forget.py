import json
import shutil
from dataclasses import replace
from pathlib import Path

import pytest

from grader.cli import main
from grader_class import batch, forget
from grader_class.entry import Entry, HandIn, Person, entries
from grader_class.store import Store
from tests.grader_class import classes
from tests.grader_class.classes import Class, rows, told
from tests.grader_class.named_class import with_text


@pytest.fixture
def out(named, tmp_path):
    """The class, with changes that a regrade has shown, and hand-ins that were set aside."""
    out = tmp_path / "class"
    shutil.copytree(named / "class", out)
    shutil.copy(out / "gradebook.csv", out / "changes.csv")
    for id in ("zm4711", "dk4714+jg4715"):
        shutil.copytree(out / "submissions" / id, out / "aside" / id)
    return out


@pytest.fixture
def call(out, small_class):
    common = ["--from", str(out), "--exercise", str(small_class.exercise)]
    return lambda student, *words: main(["forget", student, *common, *words])


def test_a_student_goes_and_a_run_that_another_shares_stays_until_the_last_who_has_it_goes(
    out, call, small_class, capsys
):
    before, key = rows(out / "gradebook.csv"), Entry.read(out / "submissions" / "zm4711").key
    runs = sorted((out / "store").glob("*/*"))
    assert call("zm4711", "--yes") == 0
    assert with_text(out, "zm4711") == []
    del before["zm4711"]
    assert rows(out / "gradebook.csv") == before
    assert json.loads((out / "class.json").read_text())["hand_ins"] == len(entries(out)) == 3
    assert sorted((out / "store").glob("*/*")) == runs
    recording = out / "submissions" / "bs4712" / "recording"
    assert main(["check", str(recording), "--exercise", str(small_class.exercise)]) == 0
    assert "the next grader batch grades" in capsys.readouterr().out.replace("\n", " ")
    assert call("bs4712", "--yes") == 0
    assert not Store(out).has(key)


def test_a_group_keeps_its_hand_in_without_this_member(out, call):
    assert call("jg4715", "--yes") == 0
    assert with_text(out, "jg4715", "Größe") == []
    row = rows(out / "gradebook.csv")["dk4714"]
    assert (row["hand_in"], row["group"], row["state"]) == ("dk4714", "", "judged")
    for part in ("submissions", "aside"):
        folder = out / part / "dk4714"
        result = Entry.read(folder).result
        assert (result.submission, result.handed_in.id) == ("Dan Kowalski", "dk4714")
        assert "Dan Kowalski" in (folder / "report.html").read_text("utf-8")
        assert (folder / "recording").is_dir()


def test_the_next_call_without_the_student_finds_all_graded(
    named, out, call, small_class, tmp_path
):
    assert call("jg4715", "--yes") == 0
    before = told(out)
    handed_in = Path(shutil.copytree(named / "handed_in", tmp_path / "handed_in"))
    roster = (handed_in / "roster.csv").read_text("utf-8").splitlines(keepends=True)
    left = "".join(line for line in roster if "jg4715" not in line)
    (handed_in / "roster.csv").write_text(left, "utf-8")
    code, said = classes.batch(*Class(handed_in, small_class.exercise).words(out))
    assert (code, "4 hand-ins of 4 graded before" in said) == (0, True), said
    assert told(out) == before


PLACES = [
    *((Store, "take_out", times) for times in range(3)),
    *((batch, "write_outputs", 0), (forget, "remove", 0), (forget, "render", 1)),
]


@pytest.mark.parametrize(
    ("student", "room", "name", "times"),
    [
        *(("jg4715", *place) for place in PLACES[1:]),
        ("zm4711", *PLACES[0]),
        *(
            pytest.param(*each, marks=pytest.mark.more("the other student is cut off there"))
            for each in (("jg4715", *PLACES[0]), *(("zm4711", *place) for place in PLACES[1:]))
        ),
    ],
)
def test_a_call_that_was_cut_off_is_finished_by_the_next(
    student, room, name, times, out, call, monkeypatch
):
    others = {path.name for path in (out / "submissions").iterdir() if student not in path.name}
    real = getattr(room, name)
    left = iter(range(times))

    def cut_off(*args):
        if next(left, None) is None:
            raise KeyboardInterrupt
        return real(*args)

    with monkeypatch.context() as patch:
        patch.setattr(room, name, cut_off)
        assert call(student, "--yes") in (0, 130)  # not all calls of this name are made for each
    assert call(student, "--yes") in (0, 2)
    assert with_text(out, student) == []
    assert others <= {path.name for path in (out / "submissions").iterdir()}
    assert not (out / "changes.csv").exists()


def test_a_class_that_was_regraded_by_an_edited_exercise_asks_for_it(
    out, tmp_path, small_class, capsys
):
    own = small_class.exercise
    edited = Path(shutil.copytree(own.parent, tmp_path / "edited")) / own.name
    text = own.read_text(encoding="utf-8")
    edited.write_text(
        text.replace("points:", "late: {due: 2026-11-30T23:59:00+01:00, per_day: 1}\npoints:", 1),
        encoding="utf-8",
    )
    for path, is_noted in ((own, False), (edited, True)):
        assert main(["forget", "zm4711", "--from", str(out), "--exercise", str(path)]) == 0
        assert ("another version of the exercise" in capsys.readouterr().out) is is_noted
    assert main(["forget", "zm4711", "--from", str(out), "--exercise", "square", "--yes"]) == 2
    assert "and square is one of 'square'" in capsys.readouterr().err.replace("\n", " ")


@pytest.mark.parametrize("student", ["zm4711", "ZM4711 ", "zoë müller", "zm4711@uni.example"])
def test_nothing_changes_without_yes(student, out, call, capsys):
    before = {path: path.stat().st_mtime_ns for path in out.rglob("*") if path.is_file()}
    assert call(student) == 0
    said = capsys.readouterr().out.replace("\n", "")
    for path in ("submissions/zm4711", "aside/zm4711"):
        assert f"- goes: {out / path}" in said
    assert "--yes" in said
    assert {path: path.stat().st_mtime_ns for path in out.rglob("*") if path.is_file()} == before


@pytest.mark.parametrize(
    ("student", "said"),
    [
        ("Zoé Mueler", "one of these: zm4711 Zoë Müller."),
        ("4714", "dk4714 Dan Kowalski"),
        ("nobody at all", "is nobody in this class"),
    ],
)
def test_an_unknown_student_is_refused_with_those_who_may_be_meant(
    student, said, out, call, capsys
):
    assert call(student, "--yes") == 2
    assert said in capsys.readouterr().err.replace("\n", " ")


def test_two_of_one_name_are_told_apart_by_their_ids(out, call, capsys):
    nobody = Entry.read(out / "submissions" / "ef4716")
    other = HandIn("x1", (Person("x1", "Eve Fontaine"),), problem=nobody.hand_in.problem)
    (out / "submissions" / "x1").mkdir()
    replace(nobody, hand_in=other, folder=out / "submissions" / "x1").put()
    assert call("Eve Fontaine", "--yes") == 2
    assert "x1 Eve Fontaine, ef4716 Eve Fontaine" in capsys.readouterr().err.replace("\n", " ")
    assert call("x1", "--yes") == 0
    assert "ef4716" in rows(out / "gradebook.csv")


def test_a_group_s_new_folder_is_never_that_of_somebody_else(out, call):
    nobody = Entry.read(out / "submissions" / "ef4716")
    folder = out / "submissions" / "dk4714"
    folder.mkdir()
    stranger = HandIn("dk4714", (Person("dk4714"),), problem=nobody.hand_in.problem)
    replace(nobody, hand_in=stranger, folder=folder).put()
    assert call("jg4715", "--yes") == 0
    assert Entry.read(folder).state == "nothing"
    assert Entry.read(out / "submissions" / "dk4714-2").state == "judged"


def test_under_pseudonyms_a_student_is_named_by_that(named, out, call, capsys):
    shutil.rmtree(out)
    shutil.copytree(named / "hidden", out)
    whose = {row["id"]: who for who, row in rows(named / "named" / "pseudonyms.csv").items()}
    assert call("zm4711", "--yes") == 2
    assert "under pseudonyms, give the student's" in capsys.readouterr().err.replace("\n", " ")
    assert call(whose["zm4711"], "--yes") == 0
    assert with_text(out, whose["zm4711"]) == []
    assert call(whose["jg4715"], "--yes") == 0  # of a group each member has one
    assert with_text(out, whose["jg4715"]) == [] != with_text(out, whose["dk4714"])
    assert len(rows(out / "gradebook.csv")) == 3
