import re
import shutil
import unicodedata
from pathlib import Path

import pytest

from grader_class.entry import Entry, HandIn, Person
from grader_class.pseudonyms import Pseudonyms
from tests.grader_class.classes import Class, batch, rows
from tests.grader_class.named_class import MEMBERS, with_text

KEY = "0123456789abcdef" * 4
MADE = Pseudonyms(KEY.encode())
NAMES = [text for id, name, *_ in MEMBERS for text in (id, name)]


def batch_hidden(small, folder):
    """Grade the class that lies in a folder under pseudonyms, into that folder."""
    words = Class(folder / "handed_in", small.exercise).words(folder / "hidden")
    code, said = batch(*words, "--pseudonyms", folder / "keys" / "key")
    return code, " ".join(said.split())


def test_students_are_named_only_by_what_they_have_handed_in(named):
    told = with_text(named / "hidden", *NAMES)
    group = next((named / "hidden" / "submissions").glob("student*+student*"))
    # the group's program prints a name, which stays where its output and its source are
    key = Entry.read(group).key
    own = re.compile(rf"(submissions/{re.escape(group.name)}|store/../{key}|export/jplag)/.*")
    assert told and [name for name in told if not own.fullmatch(name)] == []
    assert "written by Zoë Müller" in (group / "output.txt").read_text("utf-8")
    assert len(with_text(named / "class", *NAMES)) > 2 * len(told)
    progress = re.findall(r"\] (.+?): ", (named / "said.txt").read_text("utf-8"))
    assert len([name for name in progress if name.startswith("student")]) == 4


def test_points_come_back_with_names_and_only_their_owner_can_read_these(named):
    plain, with_names = (rows(named / name / "gradebook.csv") for name in ("class", "named"))
    hidden = rows(named / "hidden" / "gradebook.csv")
    assert {id: row["final"] for id, row in with_names.items()} == {
        id: row["final"] for id, row in plain.items()
    }
    whose = {row["id"]: who for who, row in rows(named / "named" / "pseudonyms.csv").items()}
    assert hidden[whose["zm4711"]]["final"] == plain["zm4711"]["final"] != "0.00"
    assert "101" in (named / "named" / "export" / "moodle-grading-worksheet.csv").read_text("utf-8")
    private = [named / "keys" / "key", named / "named", *(named / "named").rglob("*")]
    assert len(private) > 5
    assert not [path for path in private if path.stat().st_mode & 0o077]


def test_a_class_goes_on_with_its_key_alone(named, small_class, tmp_path):
    shutil.copytree(named, tmp_path, dirs_exist_ok=True)
    key, gradebook = tmp_path / "keys" / "key", tmp_path / "hidden" / "gradebook.csv"
    before = gradebook.read_bytes()
    code, said = batch_hidden(small_class, tmp_path)
    assert (code, "4 hand-ins of 4 graded before" in said) == (0, True), said
    assert gradebook.read_bytes() == before
    key.write_text(KEY)
    code, said = batch_hidden(small_class, tmp_path)
    assert (code, "the key of the pseudonyms (--pseudonyms): there" in said) == (2, True), said
    key.unlink()
    code, said = batch_hidden(small_class, tmp_path)
    assert (code, "No such file" in said, key.exists()) == (2, True, False), said


def test_a_class_that_was_begun_with_names_keeps_them(named, small_class, tmp_path):
    (tmp_path / "hidden").mkdir()
    shutil.copytree(named / "handed_in", tmp_path / "handed_in")
    shutil.copy(named / "class" / "class.json", tmp_path / "hidden")
    code, said = batch_hidden(small_class, tmp_path)
    assert (code, "was begun with names" in said) == (2, True), said
    assert not (tmp_path / "keys").exists()


@pytest.mark.parametrize("option", ["--pseudonyms", "--names"])
@pytest.mark.parametrize("where", ["class/it", "class/a/it", "handed_in/it", "link/it", "other/it"])
def test_a_key_or_names_that_others_would_get_are_refused(option, where, tmp_path):
    for name in ("handed_in", "class", "other"):
        (tmp_path / name).mkdir()
    (tmp_path / "other" / "class.json").write_text("{}")
    (tmp_path / "link").symlink_to(tmp_path / "class")
    words = (tmp_path / "handed_in", "--out", tmp_path / "class")
    code, said = batch(*words, "--pseudonyms", tmp_path / "key", option, tmp_path / where)
    assert (code, "must lie outside of it" in " ".join(said.split())) == (2, True), said
    assert not (tmp_path / "key").exists()
    assert not (tmp_path / where).exists()


@pytest.mark.parametrize(
    ("text", "mode", "why"),
    [
        ("short", 0o600, "expected 32 characters or more"),
        (KEY, 0o644, "can be read by others"),
        ("ä" * 40, 0o600, "cannot read"),
    ],
)
def test_a_key_that_can_be_guessed_or_read_is_refused(text, mode, why, tmp_path):
    (tmp_path / "handed_in").mkdir()
    (tmp_path / "key").write_text(text, "utf-8")
    (tmp_path / "key").chmod(mode)
    words = (tmp_path / "handed_in", "--out", tmp_path / "class")
    code, said = batch(*words, "--pseudonyms", tmp_path / "key")
    assert (code, why in " ".join(said.split())) == (2, True), said


def test_a_pseudonym_is_the_same_each_week_and_cannot_be_computed_without_the_key():
    decomposed = unicodedata.normalize("NFD", "zoë")
    assert MADE.of("zoë") == MADE.of(decomposed) == MADE.of(" ZOË ")
    assert MADE.of("zoë") != Pseudonyms(KEY[::-1].encode()).of("zoë")
    assert re.fullmatch("student[0-9a-f]{12}", MADE.of("zoë"))
    assert KEY not in repr(MADE)


def test_a_large_group_has_an_id_that_is_a_name_of_a_folder():
    people = tuple(Person(f"s{number}") for number in range(9))
    (id,) = MADE.hide([HandIn("s0+8", people)])
    assert re.fullmatch(r"student[0-9a-f]{12}\+8", id)


def test_a_stranger_with_the_id_of_a_member_has_a_folder_of_its_own():
    found = [HandIn("zoe", (Person("zoe", "Zoë"),)), HandIn("zoe-1a", (Person("zoe"),))]
    hidden = MADE.hide(found)
    assert [without.id for without, _ in hidden.values()] == sorted(hidden)
    assert {with_names.id for _, with_names in hidden.values()} == {"zoe", "zoe-1a"}
    assert [without.people for without, _ in hidden.values()] == [(Person(MADE.of("zoe")),)] * 2


@pytest.mark.parametrize(
    ("filename", "graded_by"),
    [
        ("turtle_controller.py", "turtle_controller.py"),
        ("zoe.m.py", "submission.py"),
        ("ZOE.M.tar.gz", "submission.tar.gz"),
        ("4711.launch.py", "submission.launch.py"),
        ("hw1_Zoë Müller.py", "submission.py"),
        ("zoe.m", "submission.m"),
    ],
)
def test_a_file_that_is_named_after_its_student_is_graded_by_another_name(filename, graded_by):
    zoe = Person("zoe.m", "Zoë Müller", {"number": "4711", "section": "turtle"})
    found = HandIn("zoe.m", (zoe,), Path("/somewhere") / filename, filename=filename)
    ((hidden, _),) = MADE.hide([found]).values()
    assert hidden.filename == graded_by
