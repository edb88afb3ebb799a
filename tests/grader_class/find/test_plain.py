import os
import re
import unicodedata
from datetime import UTC, datetime

import pytest

from grader.errors import UsageError
from grader_class.find.plain import Pattern
from tests.files import lay, packed
from tests.grader_class.find.exports import NODE, content, noted


def test_each_file_and_folder_is_a_student(tmp_path, finder):
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
    assert str(found.hand_ins[5].problem) == "What was handed in is an empty folder."
    assert noted(found, "Read as a plain folder", "7 hand-ins", "--pattern")
    assert noted(found, "grades.xlsx", "README.md")


def test_of_two_with_one_name_the_archive_is_taken(tmp_path, finder):
    found = finder(lay(tmp_path / "c", {"a.py": NODE, "a.zip": packed({"x.py": NODE})}))
    assert [each.filename for each in found.hand_ins] == ["a.zip"]
    assert noted(found, "a folder or archive has the same name: a.py")


@pytest.mark.parametrize(
    "files",
    [
        {"setup.py": "", "pkg/node.py": NODE},
        {"package.xml": "", "node.py": NODE},
        {"src/pkg/setup.py": "", "build/x": "", "install/y": ""},
    ],
)
def test_a_single_submission_is_refused(tmp_path, finder, files):
    with pytest.raises(UsageError, match=r"is one submission.* Use: grader run"):
        finder(lay(tmp_path / "alice", files))
    archive = tmp_path / "alice.zip"
    archive.write_bytes(packed({f"alice/{name}": text for name, text in files.items()}))
    with pytest.raises(UsageError, match=r"is one submission.* Use: grader run"):
        finder(archive)


def test_what_is_nothing_of_a_class_is_refused(tmp_path, finder):
    for path, why in (
        (lay(tmp_path / "a", {"node.py": NODE}) / "node.py", "is one submission"),
        (lay(tmp_path / "b", {"x.pdf": ""}) / "x.pdf", "neither a folder of submissions"),
        (tmp_path / "nothing", "does not exist"),
        (lay(tmp_path / "c", {".hidden": "", "README.md": ""}), "holds no submissions"),
    ):
        with pytest.raises(UsageError, match=why):
            finder(path)


def test_what_a_class_was_graded_into_is_no_student(tmp_path, finder):
    files = {"alice.py": NODE, "graded/class.json": "{}", "graded/store/x": ""}
    assert [each.id for each in finder(lay(tmp_path / "c", files)).hand_ins] == ["alice"]


def test_names_of_strangers_are_made_harmless(tmp_path, finder):
    names = [
        "..evil...py",
        "=HYPERLINK(1).py",
        "-rf.py",
        "CON.py",
        "con.py",
        "nul.tar.gz",
        "%2e%2e.py",
        "Zoë.py",
        "zoe.py",
        "ZOE.py",
        "李.py",
        "王.py",
        "\x1b[31mred\x07.py",
        "x\u202egnp.py",
        "a\nb.py",
        "ж" * 100 + ".py",
        "a" * 200 + ".py",
        unicodedata.normalize("NFD", "Ångström.py"),
        os.fsdecode(b"caf\xe9.py"),
    ]
    found = finder(lay(tmp_path / "c", dict.fromkeys(names, NODE)))
    ids = [each.id for each in found.hand_ins]
    # "..evil" begins with a point: hidden files are no hand-ins
    assert len({id.casefold() for id in ids}) == len(ids) == len(names) - 1
    for each in found.hand_ins:
        assert re.fullmatch(r"[a-zA-Z0-9_@+]([a-zA-Z0-9._@+-]{,79}[a-zA-Z0-9_@+])?", each.id)
        assert each.id.partition(".")[0].upper() not in ("CON", "NUL")
        assert not set(each.name) & set("\n\x1b\x07\u202e")
        assert not any(set(str(note)) & set("\n\x1b\x07\u202e") for note in found.notes)
    assert "ZOE" in ids  # of those that are alike the first keeps it
    assert "Ångström" in [each.name for each in found.hand_ins]


def test_the_files_of_a_hand_in_are_not_looked_at_through_links(tmp_path, finder):
    folder = lay(tmp_path / "c", {"Bob_8_assignsubmission_file_node.py": NODE})
    (folder / "Eve_9_assignsubmission_file_node.py").symlink_to("/etc/passwd")
    by_id = finder.by_id(folder)
    assert (by_id["9"].path, content(by_id["8"])) == (None, {"node.py"})


def test_a_link_to_a_folder_is_refused_and_nobody_else_is(tmp_path, finder):
    lay(tmp_path / "secret", {"node.py": NODE})
    folder = lay(tmp_path / "c", {"ok.py": NODE})
    (folder / "eve").symlink_to(tmp_path / "secret")
    (folder / "loop").symlink_to("..")
    (folder / "self").symlink_to("self")
    found = finder(folder)
    elsewhere = "What was handed in is a link to a folder. Hand in the folder itself."
    assert [(each.id, str(each.problem)) for each in found.hand_ins] == [
        ("eve", elsewhere),
        ("loop", elsewhere),
        ("ok", ""),
        ("self", "What was handed in is a link that leads nowhere."),
    ]
    assert not any(each.path for each in found.hand_ins if each.id != "ok")


def test_what_is_no_file_is_never_opened(tmp_path, finder):
    folder = lay(tmp_path / "c", {"ok.py": NODE})
    for name in ("bob.py", "carol.zip", "roster.csv"):
        os.mkfifo(folder / name)
    (folder / "dan.py").symlink_to("/dev/zero")
    found = finder(folder)
    told = {each.id: str(each.problem) for each in found.hand_ins}
    assert told.pop("ok") == ""
    assert sorted(told) == ["bob", "carol", "dan"]
    assert all("neither a file nor a folder" in problem for problem in told.values())


def test_names_of_files_are_taken_apart(tmp_path, finder):
    files = {
        "s1_Ann Lee_1_20261101T120000Z.py": NODE,
        "s1_Ann Lee_2_20261102T120000Z.zip": b"",
        "s2_Bob_van_Dyk_1_20261101T120000Z.tar.gz": b"",
        "readme.py": NODE,
    }
    found = finder(lay(tmp_path / "c", files), pattern="{id}_{name}_{attempt}_{at}")
    ann, bob = found.hand_ins
    assert (ann.id, ann.name, ann.attempt) == ("s1", "Ann Lee", 2)
    assert ann.at == datetime(2026, 11, 2, 12, tzinfo=UTC)
    assert (bob.name, bob.filename) == ("Bob_van_Dyk", "s2_Bob_van_Dyk_1_20261101T120000Z.tar.gz")
    assert noted(found, "the pattern does not fit", "readme.py")
    assert noted(found, "Several attempts", "Ann Lee")


def test_folders_are_taken_apart_too(tmp_path, finder):
    files = {
        "ann@x.org/2026-11-01_12-00-00+0100/node.py": NODE,
        "ann@x.org/2026-10-01_12-00-00+0100/node.py": NODE,
        "bob@x.org/soon/node.py": NODE,
    }
    found = finder(lay(tmp_path / "c", files), pattern="{email}/{at}")
    ann, bob = found.hand_ins
    assert (ann.id, ann.attempt, ann.at) == (
        "ann@x.org",
        2,
        datetime.fromisoformat("2026-11-01T12:00:00+01:00"),
    )
    assert ann.path == tmp_path / "c" / "ann@x.org" / "2026-11-01_12-00-00+0100"
    assert ann.people[0].columns == {"email": "ann@x.org"}
    assert bob.at is None and noted(found, "soon is no time")


def test_a_file_gets_its_own_name_back(tmp_path, finder):
    files = {"lab3-s1-A-my-node.py": NODE, "lab3-s2-B-x.tar.gz": b""}
    pattern = "lab3-{id}-{section}-{filename}"
    one, two = finder(lay(tmp_path / "c", files), pattern=pattern).hand_ins
    assert one.path and one.path.name == one.filename == "my-node.py"
    assert one.people[0].columns == {"section": "A"}
    assert two.filename == "x.tar.gz"


@pytest.mark.parametrize(
    ("pattern", "why"),
    [
        ("{attempt}_x", "does not say whose"),
        ("{id}{name}", "nothing between them"),
        ("{id}_{id}", "stands in it twice"),
        ("{id}_{a b}", "is no name for a field"),
        ("{id}_{name", "a brace has no partner"),
        ("{id}//x", "empty folders"),
    ],
)
def test_a_pattern_that_makes_no_sense_says_why(pattern, why):
    with pytest.raises(UsageError, match=why):
        Pattern(pattern)


def test_a_pattern_that_fits_nothing_says_what_there_is(tmp_path, finder):
    folder = lay(tmp_path / "c", {"alice.py": NODE, "bob.py": NODE})
    with pytest.raises(UsageError, match=r"fits none of what was found: alice\.py, bob\.py"):
        finder(folder, pattern="{id}_{name}")


def test_files_of_one_attempt_are_one_submission(tmp_path, finder):
    files = {"ann_1_x.py": NODE, "ann_2_setup.py": "", "ann_2_node.py": NODE, "bob_1_x.py": NODE}
    by_id = finder.by_id(lay(tmp_path / "c", files), pattern="{id}_{attempt}_{filename}")
    assert content(by_id["ann"]) == {"setup.py", "node.py"}
    assert (by_id["ann"].attempt, by_id["bob"].attempt) == (2, 1)


def test_no_name_keeps_a_pattern_busy(tmp_path, finder):
    """A regular expression would try all ways to part it: 10 million millions."""
    folder = lay(tmp_path / "c", {"_" * 200 + "x.py": NODE, "1_2_3_4_5_6_7_1_.py": NODE})
    found = finder(folder, pattern="{id}_{a}_{b}_{c}_{d}_{e}_{f}_{attempt}_")
    assert [each.id for each in found.hand_ins] == ["1"]
