"""How a class was read, and why somebody's hand-in is none, in French and Chinese."""

from __future__ import annotations

import json
import zipfile
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import pytest

from grader import limited
from grader.batch.entry import ENTRY, SUBMISSIONS, Entry, HandIn, Person, entries
from grader.batch.find import class_archive
from grader.batch.find.finding import find
from grader.batch.find.joining import NOT_HANDED_IN, UNCLEAR
from grader.batch.find.plain import Pattern
from grader.batch.find.roster import read_roster
from grader.batch.gradebook.feedback import Feedback
from grader.batch.gradebook.grade import grades
from grader.batch.page.clusters import to_mend_first
from grader.batch.page.students import Student
from grader.errors import UsageError
from grader.message import Message, plain_text
from grader.translations import translate, use
from tests.grader.batch.find.exports import NODE, lay, packed
from tests.grader.languages.holes import holes

METADATA = "submission_1:\n  :submitters:\n  - :name: Ann\n    :sid: s1\n"
ROSTER = (
    "id,name,at\nalice,Alice A,soon\ncarol,Carol C,\ncarol,Twice,\n,,x\ns1,Bo Lee,\ns2,Lee Bo,\n"
)
CLASSES: dict[str, dict[str, str | bytes | None]] = {
    "plain": {"alice.py": NODE, "alice.zip": b"", "bolee.py": NODE, "read.me.txt": "", "x": None},
    "roster": {"alice.py": NODE, "bob.py": NODE, "bolee.py": NODE, "roster.csv": ROSTER},
    "moodle": {
        "Ann_1_assignsubmission_file/node.py": NODE,
        "Bob_2_assignsubmission_onlinetext/onlinetext.html": "",
        "other.txt": "",
    },
    "canvas": {
        "ann_1_11_node.py": NODE,
        "ann_1_12_node-1.py": NODE,
        "bob_2_text.html": "",
        "carl_2_13_node.py": NODE,
        "other.txt": "",
    },
    "gradescope": {
        "submission_metadata.yml": METADATA.replace("1:", "2:", 1),
        "submission_3/node.py": NODE,
        "other.txt": "",
    },
    "damaged": {"submission_metadata.yml": METADATA + "\n  - {", "submission_1/node.py": NODE},
    "empty": {"submission_metadata.yml": "", "submission_1/node.py": NODE},
    "clones": {
        "spiral-ann/.classroom50.yml": "",
        "spiral-bob/.classroom50.yml": "",
        "other/node.py": NODE,
    },
}
CALLS: list[tuple[str, str | None]] = [
    *((name, None) for name in CLASSES),
    ("plain", "{id}"),
    ("canvas", "{id}_{at}_{}_{filename}"),
    ("canvas", "{name}_{id}_{attempt}_{filename}"),
]


def found(folder: Path, pattern: str | None = None) -> tuple[list[Message], list[Message]]:
    """The notes, and why hand-ins are none."""
    with find(folder, pattern) as made:
        return made.notes, [each.problem for each in made.hand_ins if each.problem]


@pytest.mark.parametrize("language", ["fr", "zh"])
@pytest.mark.parametrize(("name", "pattern"), CALLS)
def test_how_a_class_was_read_is_told_without_holes(
    tmp_path: Path, name: str, pattern: str | None, language: str
) -> None:
    notes, problems = found(lay(tmp_path / name, CLASSES[name]), pattern)
    assert notes
    assert [hole for text in (*notes, *problems) for hole in holes(text, language)] == []


@pytest.mark.parametrize("language", ["fr", "zh"])
def test_what_is_odd_in_an_archive_comes_out_of_its_process_as_messages(
    tmp_path: Path, language: str
) -> None:
    archive = tmp_path / "class.zip"
    with zipfile.ZipFile(archive, "w") as zip_file:
        for name in (
            "alice.py",
            "../outside.py",
            "bob/node.py",
            "bob/node.py/in.py",
            "12345678.py",
        ):
            zip_file.writestr(name, f"# {name}\n")
    archive.write_bytes(archive.read_bytes().replace(b"# 12345678", b"# abcdefgh"))
    notes, _ = found(archive)
    assert len(notes) == 4
    assert [hole for note in notes for hole in holes(note, language)] == []


def test_what_no_process_of_ours_answers_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    told_so: dict[str, Any] = {"notes": ["x"], "refused": ""}
    for wrong in ({"notes": [1]}, {"refused": None}, {"refused": {"key": 1}}):
        answer = json.dumps(told_so | wrong).encode()
        monkeypatch.setattr(limited, "call", lambda *_, answer=answer: answer)
        with pytest.raises(ValueError, match="expected"):
            class_archive.unpack(tmp_path / "class.zip", tmp_path / str(len(answer)))


def refusals(tmp_path: Path) -> list[Message]:
    """What is said of classes, patterns and tables that cannot be used."""
    folder = lay(
        tmp_path / "c",
        {"one/setup.py": "", "bad.zip": b"PK", "no.zip": packed({}), "a.txt": "", "no/a.txt": ""},
    )
    alice = lay(tmp_path / "alice", {"alice.py": NODE})
    tables: dict[str, str | bytes] = {
        **{"empty.csv": "", "other.csv": "colour,size\n", "zip.csv": b"PK\0"},
        **{"long.csv": "id\n" + "x" * 200_000, "none.csv": ""},
    }
    lay(tmp_path, {**tables})
    (tmp_path / "none.csv").unlink()
    asked = [
        *(lambda name=name: found(folder / name) for name in ("one", "bad.zip", "no.zip", "no")),
        *(lambda name=name: found(folder / name) for name in ("a.txt", "nowhere")),
        lambda: found(alice / "alice.py"),
        lambda: found(alice, "{id}_{name}"),
        lambda: found(alice, "{id}/{name}"),
        *(lambda name=name: read_roster(tmp_path / name) for name in tables),
        *(
            lambda text=text: Pattern(text)
            for text in ("{attempt}_x", "{id}{name}", "{id}_{id}", "{id}_{a b}", "{id", "{id}//x")
        ),
    ]
    said = []
    for ask in asked:
        with pytest.raises(UsageError) as raised:
            ask()
        said.append(raised.value.message)
    return said


@pytest.mark.parametrize("language", ["fr", "zh"])
def test_what_cannot_be_used_is_told_without_holes(tmp_path: Path, language: str) -> None:
    assert [hole for text in refusals(tmp_path) for hole in holes(text, language)] == []


def test_a_class_has_limits_that_are_told_in_french(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    archive = tmp_path / "class.zip"
    archive.write_bytes(packed({f"{number}.py": NODE for number in range(3)}))
    for limit, value in (("MAX_ALL_BYTES", 10), ("MAX_FILES", 1), ("MAX_LIST_BYTES", 10)):
        with monkeypatch.context() as changed, pytest.raises(UsageError) as raised:
            changed.setattr(class_archive, limit, value)
            found(archive)
        assert holes(raised.value.message, "fr") == []
        assert "Décompressez" in translate(raised.value.message, "fr")


def test_numbers_and_quotes_are_those_of_the_language(tmp_path: Path) -> None:
    notes, _ = found(lay(tmp_path / "m", CLASSES["moodle"]))
    assert str(notes[0]) == "Read as what Moodle's “Download all submissions” makes: 2 hand-ins."
    assert translate(notes[0], "fr") == (
        "Lu comme ce que produit «\N{NO-BREAK SPACE}Download all submissions\N{NO-BREAK SPACE}» de "
        "Moodle\N{NO-BREAK SPACE}: 2 rendus."
    )


def test_a_student_whose_name_is_a_word_of_ours_keeps_it(tmp_path: Path) -> None:
    files = {"passed.py": NODE, "alice.py": NODE, "roster.csv": "id,name\nalice,Alice\n"}
    notes, _ = found(lay(tmp_path / "c", {**files}))
    (unknown,) = (note for note in notes if str(note).startswith("Not in"))
    assert "passed" in translate(unknown, "fr")
    assert "passed" in translate(unknown, "zh")


def entry(tmp_path: Path, problem: Message, state: Any = "unusable") -> Entry:
    """One that was written and read again."""
    folder = tmp_path / SUBMISSIONS / "ann"
    folder.mkdir(parents=True)
    hand_in = HandIn("ann", (Person("ann"),), at=datetime(2026, 11, 1, tzinfo=UTC), problem=problem)
    Entry(hand_in, state, 100.0, message=problem, folder=folder).put()
    (read,) = entries(tmp_path)
    return read


@pytest.mark.parametrize("language", ["fr", "zh"])
@pytest.mark.parametrize("problem", [NOT_HANDED_IN, UNCLEAR])
def test_why_there_is_no_hand_in_is_still_known_when_it_is_read_back(
    tmp_path: Path, problem: Message, language: str
) -> None:
    read = entry(tmp_path, problem, "nothing")
    assert read.hand_in.problem == read.message == problem
    assert holes(read.hand_in.problem, language) == []
    assert translate(read.hand_in.problem, language) != str(problem)
    assert [grade.final for grade in grades([read])] == [None if problem == UNCLEAR else 0.0]


def test_feedback_and_class_page_say_in_french_why_nothing_could_be_graded(tmp_path: Path) -> None:
    _, (problem,) = found(lay(tmp_path / "c", {"ann": None}))
    read = entry(tmp_path, problem)
    use("fr")
    sentence = "Ce qui a été rendu est un dossier vide."
    assert sentence in Feedback().markdown(read).decode()
    assert sentence in Feedback().page(read).decode()
    (cluster,) = to_mend_first([Student(1, read, "ann", "ann")])
    assert cluster.example == sentence


def test_an_entry_without_phrases_is_told_as_it_stands_there(tmp_path: Path) -> None:
    read = entry(tmp_path, plain_text(str(NOT_HANDED_IN)), "nothing")
    assert "phrases" not in json.loads((read.folder / ENTRY).read_text())
    assert translate(read.message, "fr") == "Nothing was handed in."


@pytest.mark.parametrize(
    "phrases",
    [[1], {"Nothing was handed in.": 1}, {"Nothing was handed in.": {"key": "{a}"}}],
)
def test_an_entry_whose_phrases_do_not_fit_is_refused(tmp_path: Path, phrases: Any) -> None:
    folder = entry(tmp_path, NOT_HANDED_IN, "nothing").folder
    (folder / ENTRY).write_text(
        json.dumps(json.loads((folder / ENTRY).read_text()) | {"phrases": phrases})
    )
    with pytest.raises(UsageError, match=r"entry\.json is damaged: .*expected"):
        Entry.read(folder)
    assert entries(tmp_path) == []  # so it is made anew
