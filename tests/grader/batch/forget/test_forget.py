"""`grader forget`: no file of the class tells of the student any more, and others keep theirs."""

from __future__ import annotations

import csv
import io
import json
import shutil
import sys
from contextlib import redirect_stdout
from pathlib import Path

import pytest

from grader.batch import batch, store
from grader.batch.forget import forgetting
from grader.cli import main
from tests.grader.batch.classes import Class
from tests.grader.batch.names.accented import (
    GROUPED,
    ZOE,
    ZOE_ID,
    forms_of,
    found_in,
    nick_of,
)

pytestmark = pytest.mark.usefixtures("as_recorded")
OF_ZOE = forms_of(ZOE, ZOE_ID, nick_of(ZOE))
#: In a group nobody can tell whose a nickname is.
OF_GROUPED = forms_of(GROUPED, "jg4715")


@pytest.fixture(scope="module")
def regraded(
    with_names: Class, as_recorded: None, tmp_path_factory: pytest.TempPathFactory
) -> Path:
    """A folder with the class, regraded and with a hand-in set aside, and the new exercise."""
    folder = tmp_path_factory.mktemp("regraded")
    shutil.copytree(with_names.handed_in.parent / "class", folder / "class")
    shutil.copytree(with_names.exercise.parent, folder / "own_square")
    new = folder / "own_square" / "quick.yaml"
    new.write_text(new.read_text("utf-8").replace("drives: 5", "drives: 6"), "utf-8")
    words = ["--regrade", str(folder / "class"), "--exercise", str(new)]
    assert main(["batch", *words, "--apply"]) == 0
    for id in (ZOE_ID, "cw4713"):
        kept = folder / "class" / "submissions" / id
        shutil.copytree(kept, folder / "class" / "aside" / id)
    return folder


def forget(folder: Path, student: str, *words: str) -> int:
    exercise = str(folder / "own_square" / "quick.yaml")
    out = str(folder / "class")
    return main(["forget", student, "--from", out, "--exercise", exercise, *words])


@pytest.fixture(scope="module")
def without_zoe(regraded: Path, tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, str]:
    """The folder after she was forgotten, and what the call has printed."""
    folder, said = tmp_path_factory.mktemp("forgotten"), io.StringIO()
    shutil.copytree(regraded, folder, dirs_exist_ok=True)
    with redirect_stdout(said):
        assert forget(folder, ZOE, "--yes") == 0
    return folder, said.getvalue()


@pytest.fixture(scope="module")
def without_member(regraded: Path, tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, str]:
    """The folder after a member of the group was forgotten, of whom the teacher has a note."""
    folder, said = tmp_path_factory.mktemp("forgotten"), io.StringIO()
    shutil.copytree(regraded, folder, dirs_exist_ok=True)
    (folder / "class" / "notes.txt").write_text(f"talk to {GROUPED}", "utf-8")
    with redirect_stdout(said):
        assert forget(folder, "jg4715", "--yes") == 0
    return folder, said.getvalue()


def table(path: Path) -> list[dict[str, str]]:
    return list(csv.DictReader(path.read_text("utf-8-sig").splitlines()))


def ids(path: Path) -> list[str]:
    return [row["id"] for row in table(path)]


def test_a_name_and_its_hashes_are_found_nowhere_after_forgetting(
    regraded: Path, without_zoe: tuple[Path, str]
) -> None:
    assert len(found_in(regraded / "class", OF_ZOE)) > 60
    assert found_in(without_zoe[0] / "class", OF_ZOE) == {}


def test_the_receipt_tells_how_much_and_not_whom(without_zoe: tuple[Path, str]) -> None:
    folder, said = without_zoe
    (receipt,) = (folder / "class" / "forgotten").glob("*.json")
    assert receipt.name in said
    told = json.loads(receipt.read_text())
    assert told["state"] == "done"
    expected = {"hand_ins": 1, "set_aside": 1, "replaced_results": 1, "others": 4}
    assert expected.items() <= told["counts"].items()


def test_figures_are_those_of_a_class_without_the_student(
    regraded: Path, without_zoe: tuple[Path, str]
) -> None:
    before = {row["id"]: row for row in table(regraded / "class" / "gradebook.csv")}
    del before[ZOE_ID]
    out = without_zoe[0] / "class"
    assert {row["id"]: row for row in table(out / "gradebook.csv")} == before
    assert json.loads((out / "class.json").read_text())["hand_ins"] == 4
    assert len((out / "similar.jsonl").read_text().splitlines()) == 1  # the group and Carla
    assert ids(out / "before" / "1" / "gradebook.csv") == [*before]
    assert ZOE_ID not in ids(out / "before" / "1" / "changes.csv")
    assert "bs4712" in ids(out / "before" / "1" / "changes.csv")
    assert not (out / "before" / "1" / "changes.html").exists()


def test_a_run_that_another_shares_stays_and_is_judged_again_as_before(
    without_zoe: tuple[Path, str], capsys: pytest.CaptureFixture[str]
) -> None:
    out, exercise = without_zoe[0] / "class", without_zoe[0] / "own_square" / "quick.yaml"
    bob = out / "submissions" / "bs4712"
    assert "forgotten" in (bob / "output.txt").read_text()
    assert json.loads((bob / "result.json").read_text())["score"] == 86
    assert main(["batch", "--regrade", str(out), "--exercise", str(exercise)]) == 0
    assert "None of 4 changes" in capsys.readouterr().out


def test_the_next_call_on_what_others_handed_in_does_not_bring_the_name_back(
    with_names: Class, without_zoe: tuple[Path, str], tmp_path: Path
) -> None:
    shutil.copytree(without_zoe[0], tmp_path, dirs_exist_ok=True)
    shutil.copytree(with_names.handed_in, tmp_path / "handed_in")
    (hers,) = (tmp_path / "handed_in").glob("*_101_*")
    shutil.rmtree(hers)
    roster = tmp_path / "handed_in" / "roster.csv"
    lines = roster.read_text("utf-8").splitlines(keepends=True)
    roster.write_text("".join(line for line in lines if ZOE_ID not in line), "utf-8")
    words = [str(tmp_path / "handed_in"), "--out", str(tmp_path / "class")]
    exercise = str(tmp_path / "own_square" / "quick.yaml")
    assert main(["batch", *words, "--exercise", exercise, "--jobs", "1"]) == 0
    assert found_in(tmp_path / "class", OF_ZOE) == {}
    assert len(table(tmp_path / "class" / "gradebook.csv")) == 5


def test_a_group_stays_without_its_member(without_member: tuple[Path, str]) -> None:
    out = without_member[0] / "class"
    assert list(found_in(out, OF_GROUPED)) == ["notes.txt"]
    (row,) = (row for row in table(out / "gradebook.csv") if row["id"] == "dk4714")
    assert (row["hand_in"], row["group"], row["final"]) == ("dk4714", "", "86.00")
    result = json.loads((out / "submissions" / "dk4714" / "result.json").read_text())
    assert result["submission"] == "Dan Kowalski"
    assert result["handed_in"]["id"] == "dk4714"
    assert (out / "before" / "1" / "submissions" / "dk4714" / "entry.json").is_file()


def test_a_file_of_somebody_else_with_the_name_is_told(without_member: tuple[Path, str]) -> None:
    assert "still in 1 file" in without_member[1]
    assert "notes.txt" in without_member[1]


def test_an_interrupted_call_goes_on_wherever_it_was_cut_off(
    regraded: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    shutil.copytree(regraded, tmp_path, dirs_exist_ok=True)

    def interrupted(*_: object, **__: object) -> object:
        raise KeyboardInterrupt

    for room, name in ((store.Store, "put"), (batch, "write_outputs"), (store.Store, "take_out")):
        with monkeypatch.context() as patch:
            patch.setattr(room, name, interrupted)
            assert forget(tmp_path, ZOE, "--yes") == 130
    assert forget(tmp_path, ZOE, "--yes") == 0
    assert found_in(tmp_path / "class", OF_ZOE) == {}
    receipts = [p.read_text() for p in (tmp_path / "class" / "forgotten").glob("*.json")]
    states = sorted(json.loads(text)["state"] for text in receipts)
    assert states == ["begun", "begun", "begun", "done"]


def test_nothing_changes_before_somebody_has_agreed(
    regraded: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before = {p: p.stat().st_mtime_ns for p in (regraded / "class").rglob("*") if p.is_file()}
    assert forget(regraded, ZOE) == 0
    said = capsys.readouterr().out
    assert "1 hand-in of the class goes" in said
    assert "the name is replaced in: " in said.replace("\n", " ")
    assert "zoe_square" in said
    assert "--yes" in said
    after = {p: p.stat().st_mtime_ns for p in (regraded / "class").rglob("*") if p.is_file()}
    assert after == before


@pytest.mark.parametrize(
    ("answer", "goes"), [("yes\n", True), ("no\n", False), ("\n", False), ("", False)]
)
def test_in_a_terminal_somebody_is_asked(
    answer: str,
    goes: bool,
    regraded: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    done: list[object] = []

    def carry_out(*plan: object) -> object:
        done.append(plan)
        raise KeyboardInterrupt

    monkeypatch.setattr(forgetting, "carry_out", carry_out)
    monkeypatch.setattr(sys, "stdin", io.StringIO(answer))
    monkeypatch.setattr(sys.stdin, "isatty", lambda: True)
    assert forget(regraded, ZOE) == (130 if goes else 0)
    assert bool(done) == goes
    assert "[yes/no]" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("student", "said"),
    [
        ("Zoé Mueler", "similar are: zm4711 (Zoë Müller)"),
        ("4714", "similar are: dk4714 (Dan Kowalski)"),
        ("nobody at all", "is nobody in this class."),
    ],
)
def test_an_unknown_student_is_refused_with_those_who_may_be_meant(
    student: str, said: str, regraded: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert forget(regraded, student, "--yes") == 2
    assert said in capsys.readouterr().err
