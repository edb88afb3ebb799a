"""`grader batch --pseudonyms KEY`: no name in any file of the class but in the sources."""

from __future__ import annotations

import csv
import io
import json
import re
import shutil
import subprocess
import sys
import unicodedata
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path

import pytest

from grader.batch.entry import HandIn, Person
from grader.batch.names.pseudonyms import Pseudonyms
from grader.cli import main
from tests.grader.batch.classes import ENV, Class
from tests.grader.batch.names.accented import (
    GROUPED,
    MEMBERS,
    ZOE,
    ZOE_ID,
    forms_of,
    found_in,
    nick_of,
)

KEY = "0123456789abcdef" * 4
ALL = [
    *forms_of(ZOE, ZOE_ID, nick_of(ZOE)),
    *forms_of(GROUPED, "jg4715", nick_of(GROUPED)),
    *(form for id, name, *_ in MEMBERS for form in forms_of(name.split()[1], id)),
]
#: The hand-ins' own sources, which are the exception.
SOURCES = re.compile(
    r"(submissions/[^/]+|store/../\w+)/source/.*|export/jplag/.*|export/dolos\.zip"
)


def words_of(found: Class, tmp_path: Path, *more_words: str) -> list[str]:
    key = tmp_path / "keys" / "key"
    common = [str(found.handed_in), "--out", str(tmp_path / "class"), "--pseudonyms", str(key)]
    return ["batch", *common, "--exercise", str(found.exercise), "--jobs", "1", *more_words]


def table(path: Path) -> list[dict[str, str]]:
    return list(csv.DictReader(path.read_text("utf-8-sig").splitlines()))


def points(out: Path) -> list[str]:
    return sorted(row["final"] for row in table(out / "gradebook.csv"))


def without_sources(found: dict[str, list[bytes]]) -> list[str]:
    return [name for name in found if not SOURCES.fullmatch(name)]


@pytest.fixture(scope="module")
def graded(
    with_names: Class, as_recorded: None, tmp_path_factory: pytest.TempPathFactory
) -> tuple[Path, str]:
    """A folder with `class`, `keys`, `named`; and what the call has printed."""
    folder, said = tmp_path_factory.mktemp("graded"), io.StringIO()
    with redirect_stderr(said), redirect_stdout(said):
        assert main(words_of(with_names, folder, "--names", str(folder / "named"))) == 0
    return folder, said.getvalue()


def test_a_name_is_nowhere_but_in_the_sources(with_names: Class, graded: tuple[Path, str]) -> None:
    folder, said = graded
    assert not [form for form in ALL if form in said.encode().lower()]
    assert "Made the key" in said
    found = found_in(folder / "class", ALL)
    assert {name: found[name] for name in without_sources(found)} == {}
    assert [name for name in found if "/source/" in name]  # the search does find
    plain = found_in(with_names.handed_in.parent / "class", ALL)
    assert len(without_sources(plain)) > 50


def test_no_hash_of_a_hand_in_is_that_of_its_names_of_files(
    with_names: Class, graded: tuple[Path, str]
) -> None:
    hashes = set[bytes]()
    for path in (with_names.handed_in.parent / "class").glob("submissions/*/"):
        if (path / "result.json").is_file():
            result, entry = ((path / f"{name}.json").read_text() for name in ("result", "entry"))
            recorded = json.loads(result)["provenance"]["recorded"]
            hashes |= {recorded["submission_sha256"].encode(), json.loads(entry)["key"].encode()}
    assert len(hashes) == 4  # two runs
    assert found_in(graded[0] / "class", sorted(hashes)) == {}


def test_points_are_the_same_and_come_back_to_the_course_system(
    with_names: Class, graded: tuple[Path, str]
) -> None:
    plain, (folder, _) = with_names.handed_in.parent / "class", graded
    assert points(plain) == points(folder / "class")
    who = {row["pseudonym"]: row["name"] for row in table(folder / "named" / "pseudonyms.csv")}
    assert ZOE in who.values()
    named = {row["id"]: row["final"] for row in table(folder / "named" / "gradebook.csv")}
    assert named == {row["id"]: row["final"] for row in table(plain / "gradebook.csv")}
    assert (folder / "named" / "export" / "moodle-grading-worksheet.csv").is_file()
    assert (folder / "keys" / "key").stat().st_mode & 0o777 == 0o600
    with_names_in = [folder / "named", *(folder / "named").rglob("*")]
    assert len(with_names_in) > 5
    assert not [path for path in with_names_in if path.stat().st_mode & 0o077]


def test_the_same_call_again_runs_nothing_and_another_key_is_refused(
    with_names: Class, graded: tuple[Path, str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    shutil.copytree(graded[0], tmp_path, dirs_exist_ok=True)
    before = (tmp_path / "class" / "gradebook.csv").read_bytes()
    assert main(words_of(with_names, tmp_path)) == 0
    assert "5 hand-ins of 5 graded before" in capsys.readouterr().err
    assert (tmp_path / "class" / "gradebook.csv").read_bytes() == before
    (tmp_path / "keys" / "key").write_text(KEY)
    assert main(words_of(with_names, tmp_path)) == 2
    said = capsys.readouterr().err
    assert "the key of the pseudonyms" in said
    assert "Give the key that it was begun with" in said.replace("\n", " ")
    assert "another --out" not in said
    (tmp_path / "keys" / "key").unlink()
    assert main(words_of(with_names, tmp_path)) == 2
    assert "was begun with one" in capsys.readouterr().err
    assert not (tmp_path / "keys" / "key").exists()


def test_a_student_is_forgotten_by_the_id_and_the_key_in_the_sources_of_others_too(
    with_names: Class, graded: tuple[Path, str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    shutil.copytree(graded[0], tmp_path, dirs_exist_ok=True)
    common = ["--from", str(tmp_path / "class"), "--exercise", str(with_names.exercise)]
    assert main(["forget", ZOE_ID, *common]) == 2
    assert "is under pseudonyms" in capsys.readouterr().err
    key = ["--pseudonyms", str(tmp_path / "keys" / "key")]
    assert main(["forget", "nobody17", *common, *key]) == 2
    assert "nobody17 is nobody" in capsys.readouterr().err
    assert main(["forget", ZOE_ID, *common, *key]) == 0
    assert "--also NAME" in capsys.readouterr().out
    assert main(["forget", ZOE_ID, *common, *key, "--also", ZOE, "--yes"]) == 0
    pseudonym = Pseudonyms((tmp_path / "keys" / "key").read_bytes().strip()).of(ZOE_ID)
    of_zoe = [pseudonym.encode(), *forms_of(ZOE, ZOE_ID, nick_of(ZOE))]
    assert found_in(tmp_path / "class", of_zoe) == {}
    (bob,) = (r for r in table(tmp_path / "named" / "pseudonyms.csv") if r["id"] == "bs4712")
    assert bob["pseudonym"] in (tmp_path / "class" / "gradebook.csv").read_text("utf-8")


@pytest.mark.more("two hand-ins are run")
def test_the_command_itself_does_so_with_real_runs(with_names: Class, tmp_path: Path) -> None:
    command = [sys.executable, "-P", "-m", "grader", *words_of(with_names, tmp_path)]
    done = subprocess.run(command, env=ENV, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert without_sources(found_in(tmp_path / "class", ALL)) == []


@pytest.mark.parametrize("where", ["class/key", "class/below/key", "handed_in/key"])
def test_a_key_that_others_would_get_is_refused(
    where: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "handed_in").mkdir()
    words = ["batch", str(tmp_path / "handed_in"), "--out", str(tmp_path / "class")]
    assert main([*words, "--pseudonyms", str(tmp_path / where)]) == 2
    assert "the key must lie outside of it" in capsys.readouterr().err
    assert not (tmp_path / where).exists()


def test_a_key_behind_a_link_out_of_the_class_is_refused_too(tmp_path: Path) -> None:
    (tmp_path / "handed_in").mkdir()
    (tmp_path / "class").mkdir()
    (tmp_path / "class" / "key").symlink_to(tmp_path / "key")
    words = ["batch", str(tmp_path / "handed_in"), "--out", str(tmp_path / "class")]
    assert main([*words, "--pseudonyms", str(tmp_path / "class" / "key")]) == 2


@pytest.mark.parametrize("where", ["", "other", "other/below"])
def test_names_are_not_written_into_a_class_nor_around_it(
    where: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "handed_in").mkdir()
    (tmp_path / "other").mkdir()
    (tmp_path / "other" / "class.json").write_text("{}")
    words = ["batch", str(tmp_path / "handed_in"), "--out", str(tmp_path / "class")]
    words += ["--pseudonyms", str(tmp_path / "key"), "--names", str(tmp_path / where)]
    assert main(words) == 2
    assert "a folder of its own" in capsys.readouterr().err.replace("\n", " ")
    assert not (tmp_path / "key").exists()


@pytest.mark.parametrize(("text", "mode"), [("short", 0o600), (KEY, 0o644)])
def test_a_key_that_can_be_guessed_or_read_is_refused(
    text: str, mode: int, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "handed_in").mkdir()
    (tmp_path / "key").write_text(text)
    (tmp_path / "key").chmod(mode)
    words = ["batch", str(tmp_path / "handed_in"), "--out", str(tmp_path / "class")]
    assert main([*words, "--pseudonyms", str(tmp_path / "key")]) == 2
    assert "grader batch:" in capsys.readouterr().err


def test_a_class_that_was_begun_with_names_keeps_them(
    with_names: Class, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "class").mkdir()
    shutil.copy(with_names.handed_in.parent / "class" / "class.json", tmp_path / "class")
    assert main(words_of(with_names, tmp_path)) == 2
    assert "was begun with names" in capsys.readouterr().err
    assert not (tmp_path / "keys").exists()


def test_a_pseudonym_is_the_same_each_week_and_cannot_be_computed_without_the_key() -> None:
    made, other = Pseudonyms(KEY.encode()), Pseudonyms(KEY[::-1].encode())
    decomposed = unicodedata.normalize("NFD", "zoë")
    assert made.of("zoë") == made.of(decomposed) == made.of(" ZOË ")
    assert made.of("zoë") != other.of("zoë")
    assert re.fullmatch("student[0-9a-f]{10}", made.of("zoë"))


def test_a_large_group_has_an_id_that_is_a_name_of_a_folder() -> None:
    people = tuple(Person(f"s{number}") for number in range(9))
    (id,) = Pseudonyms(KEY.encode()).of_hand_ins([HandIn("s0+8", people)])
    assert re.fullmatch(r"student[0-9a-f]{10}\+8", id)
