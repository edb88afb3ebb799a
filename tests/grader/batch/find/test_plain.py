"""Folders that no course system has made: one file or folder a student."""

from __future__ import annotations

import os
import unicodedata
from pathlib import Path

import pytest

from grader.errors import UsageError
from tests.grader.batch.find.exports import NODE, Finder, content, lay, noted, packed


def test_each_file_and_folder_is_a_student(tmp_path: Path, finder: Finder) -> None:
    files = {
        "alice.py": NODE,
        "bob/pkg/setup.py": "",
        "carol.zip": packed({"node.py": NODE}),
        "dan.tar.gz": b"\x1f\x8b",
        "Émile Zola/node.py": NODE,
        "frank.cpp": "int main;",
        "grades.xlsx": b"",
        "README.md": "",
        "__MACOSX/._alice.py": "",
        ".DS_Store": "",
        "Thumbs.db": "",
        "empty/.DS_Store": "",
    }
    found = finder(lay(tmp_path / "c", files))
    assert [(each.id, each.name, each.filename) for each in found.hand_ins] == [
        ("Emile-Zola", "Émile Zola", ""),
        ("alice", "alice", "alice.py"),
        ("bob", "bob", ""),
        ("carol", "carol", "carol.zip"),
        ("dan", "dan", "dan.tar.gz"),
        ("empty", "empty", ""),
        ("frank", "frank", "frank.cpp"),
    ]
    assert found.hand_ins[1].path == tmp_path / "c" / "alice.py"
    assert found.hand_ins[5].problem == "What was handed in is an empty folder."
    assert noted(found, "Read as a plain folder", "7 hand-ins", "--pattern")
    assert noted(found, "grades.xlsx", "README.md")


def test_of_two_with_one_name_the_archive_is_taken(tmp_path: Path, finder: Finder) -> None:
    found = finder(lay(tmp_path / "c", {"a.py": NODE, "a.zip": packed({"x.py": NODE})}))
    assert [each.filename for each in found.hand_ins] == ["a.zip"]
    assert noted(found, "a.py is left out", "a.zip is of the same name")


@pytest.mark.parametrize(
    "files",
    [
        {"setup.py": "", "pkg/node.py": NODE},
        {"package.xml": "", "node.py": NODE},
        {"src/pkg/setup.py": "", "build/x": "", "install/y": ""},
    ],
)
def test_a_single_submission_is_refused(
    tmp_path: Path, finder: Finder, files: dict[str, str]
) -> None:
    with pytest.raises(UsageError, match=r"is one submission.* Use: grader run"):
        finder(lay(tmp_path / "alice", files))
    archive = tmp_path / "alice.zip"
    archive.write_bytes(packed({f"alice/{name}": text for name, text in files.items()}))
    with pytest.raises(UsageError, match=r"is one submission.* Use: grader run"):
        finder(archive)


def test_what_is_nothing_of_a_class_is_refused(tmp_path: Path, finder: Finder) -> None:
    for path, why in (
        (lay(tmp_path / "a", {"node.py": NODE}) / "node.py", "is one submission"),
        (lay(tmp_path / "b", {"x.pdf": ""}) / "x.pdf", "neither a folder of submissions"),
        (tmp_path / "nothing", "does not exist"),
        (lay(tmp_path / "c", {".hidden": "", "README.md": ""}), "holds no submissions"),
    ):
        with pytest.raises(UsageError, match=why):
            finder(path)


def test_what_a_class_was_graded_into_is_no_student(tmp_path: Path, finder: Finder) -> None:
    files = {"alice.py": NODE, "graded/class.json": "{}", "graded/store": None}
    assert [each.id for each in finder(lay(tmp_path / "c", files)).hand_ins] == ["alice"]


def test_names_of_strangers_are_made_harmless(tmp_path: Path, finder: Finder) -> None:
    names = [
        "a\nb.py",
        "\x1b[31mred\x07.py",
        "..evil...py",
        "x\u202egnp.py",
        "=HYPERLINK(1).py",
        "-rf.py",
        "CON.py",
        "con.py",
        "nul.tar.gz",
        "Zoë.py",
        "zoe.py",
        "ZOE.py",
        "李.py",
        "王.py",
        "ж" * 100 + ".py",
        "a" * 200 + ".py",
        "%2e%2e.py",
        unicodedata.normalize("NFD", "Ångström.py"),
        os.fsdecode(b"caf\xe9.py"),
    ]
    found = finder(lay(tmp_path / "c", dict.fromkeys(names, NODE)))
    ids = [each.id for each in found.hand_ins]
    # "..evil" begins with a point: hidden files are no hand-ins
    assert len({id.casefold() for id in ids}) == len(ids) == len(names) - 1
    for each in found.hand_ins:
        assert set(each.id) <= set(
            "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789._@+-"
        )
        assert each.id[0] not in ".-" and each.id[-1] not in ".-" and len(each.id) <= 81
        assert each.id.partition(".")[0].upper() not in ("CON", "NUL")
        assert not set(each.name) & set("\n\x1b\x07\u202e")
        assert not any(set(note) & set("\n\x1b\x07\u202e") for note in found.notes)
    assert "ZOE" in ids  # of those that are alike the first keeps it
    assert "Ångström" in [each.name for each in found.hand_ins]


def test_ten_thousand_entries_are_found(tmp_path: Path, finder: Finder) -> None:
    folder = tmp_path / "c"
    folder.mkdir()
    lines = ["id,name"]
    for number in range(10_000):
        (folder / f"student{number}.py").touch()
        lines.append(f"student{number},Some Body{number}")
    lay(folder, {"roster.csv": "\n".join(lines)})
    found = finder(folder)
    assert len(found.hand_ins) == 10_000
    assert found.hand_ins[0].name == "Some Body0"


def test_the_files_of_a_hand_in_are_not_looked_at_through_links(
    tmp_path: Path, finder: Finder
) -> None:
    folder = lay(tmp_path / "c", {"Bob_8_assignsubmission_file_node.py": NODE})
    (folder / "Eve_9_assignsubmission_file_node.py").symlink_to("/etc/passwd")
    by_id = finder.by_id(folder)
    assert by_id["9"].path is None
    assert content(by_id["8"]) == {"node.py"}


def test_a_link_that_leads_nowhere_is_told(tmp_path: Path, finder: Finder) -> None:
    folder = lay(tmp_path / "c", {"alice.py": NODE})
    (folder / "bob.py").symlink_to("nowhere")
    assert finder.by_id(folder)["bob"].problem == "What was handed in is a link that leads nowhere."


def test_a_link_to_a_folder_is_refused_and_nobody_else_is(tmp_path: Path, finder: Finder) -> None:
    lay(tmp_path / "secret", {"node.py": NODE})
    folder = lay(tmp_path / "c", {"ok.py": NODE})
    (folder / "eve").symlink_to(tmp_path / "secret")
    (folder / "loop").symlink_to("..")
    (folder / "self").symlink_to("self")
    found = finder(folder)
    elsewhere = "What was handed in is a link to a folder. Hand in the folder itself."
    assert [(each.id, each.problem) for each in found.hand_ins] == [
        ("eve", elsewhere),
        ("loop", elsewhere),
        ("ok", ""),
        ("self", "What was handed in is a link that leads nowhere."),
    ]
    assert not any(each.path for each in found.hand_ins if each.id != "ok")


def test_what_is_no_file_is_never_opened(tmp_path: Path, finder: Finder) -> None:
    folder = lay(tmp_path / "c", {"ok.py": NODE})
    for name in ("bob.py", "carol.zip", "roster.csv"):
        os.mkfifo(folder / name)
    (folder / "dan.py").symlink_to("/dev/zero")
    found = finder(folder)
    told = {each.id: each.problem for each in found.hand_ins}
    assert told.pop("ok") == ""
    assert sorted(told) == ["bob", "carol", "dan"]
    assert all("neither a file nor a folder" in problem for problem in told.values())
