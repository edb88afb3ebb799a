import csv
import io
import zipfile
from dataclasses import replace
from datetime import UTC, datetime

import pytest

from grader.exercise.loading import load_exercise
from grader_class import export
from grader_class.entry import SUBMISSIONS, Entry, HandIn, Person, entries

CHALLENGE = load_exercise("turtlesim_challenge")


def hand_in(out, who, files):
    """What a worker leaves of a hand-in, but for its result."""
    copy = out.parent / "copies" / who
    for name, text in files.items():
        (copy / name).parent.mkdir(parents=True, exist_ok=True)
        (copy / name).write_text(text)
    folder = out / SUBMISSIONS / who
    export.keep(copy, folder / export.SOURCE)
    entry = Entry(HandIn(who, (Person(who, "Zoë Müller"),)), "failed", 100.0, folder=folder)
    entry.put()
    return entry


@pytest.fixture
def out(tmp_path):
    out = tmp_path / "out"
    hand_in(out, "quick", {"quick_spiral.py": "class Quick: ...\n"})
    hand_in(out, "parts", {"parts/spot.py": "class Spot: ...\n", "setup.py": "class Setup: ...\n"})
    hand_in(out, "-empty", {"README.md": "Nothing yet.\n"})
    export.write_exports(entries(out), CHALLENGE, out)
    return out


def test_jplag_finds_a_folder_for_each_hand_in_and_the_base_code(out):
    jplag = out / "export" / "jplag"
    assert sorted(path.name for path in (jplag / "students").iterdir()) == ["parts", "quick"]
    handed_in = (jplag / "students" / "quick" / "quick_spiral.py").read_bytes()
    assert handed_in == b"class Quick: ...\n"
    base = {path.relative_to(jplag / "base").as_posix() for path in jplag.rglob("base/**/*.py")}
    assert "reference/turtle_controller.py" in base
    assert "starter/my_solution/turtle_controller.py" in base


def table(out):
    with zipfile.ZipFile(out / "export" / "dolos.zip") as archive:
        rows = list(csv.DictReader(io.StringIO(archive.read("info.csv").decode())))
        assert {row["filename"] for row in rows} == set(archive.namelist()) - {"info.csv"}
        return rows, {name: archive.read(name) for name in archive.namelist()}


def test_dolos_finds_a_file_for_each_hand_in_and_one_that_is_ignored(out):
    rows, members = table(out)
    ignored = {row["filename"]: row["ignored"] for row in rows}
    assert ignored == {"students/parts.py": "", "students/quick.py": "", "starter.py": "true"}
    assert b"class Spot" in members["students/parts.py"]
    assert b"class Setup" in members["students/parts.py"]
    assert "Zoë" not in members["info.csv"].decode()  # no names leave the house


def test_times_are_told_where_all_are_known(out):
    at = datetime(2026, 11, 1, 12, tzinfo=UTC)
    timed = [replace(e, hand_in=replace(e.hand_in, at=at)) for e in entries(out)]
    assert "created_at" not in table(out)[0][0]
    export.write_exports(timed, CHALLENGE, out)
    assert table(out)[0][0]["created_at"] == "2026-11-01 12:00:00+00:00"


def test_the_same_class_gives_the_same_bytes_and_nothing_older_stays(out):
    zipped = (out / "export" / "dolos.zip").read_bytes()
    stale = out / "export" / "jplag" / "students" / "gone"
    stale.mkdir()
    export.write_exports(entries(out), CHALLENGE, out)
    assert (out / "export" / "dolos.zip").read_bytes() == zipped
    assert not stale.exists()


def test_what_is_too_much_is_left_out(tmp_path):
    files = {f"f{n}.py": f"x = {n}\n" for n in range(export.MOST_FILES + 5)}
    entry = hand_in(tmp_path / "out", "mallory", {**files, "a_large.py": "x = 1\n" * 2_000_000})
    kept = [file.name for file in export.kept(entry.folder / export.SOURCE)]
    assert len(kept) == export.MOST_FILES and "a_large.py" not in kept


def test_names_that_a_system_may_not_take_are_changed_none_is_lost_and_no_link_followed(tmp_path):
    secret, copy = tmp_path / "secret.py", tmp_path / "copy"
    secret.write_text("x = 1\n")
    copy.mkdir()
    (copy / "link.py").symlink_to(secret)
    for name in ("a b.py", "a_b.py", "-rf.py", "é\n.py", "A_B.py"):
        (copy / name).write_text(f"# {name!r}\n")
    export.keep(copy, tmp_path / "source")
    kept = [file.name for file in export.kept(tmp_path / "source")]
    assert len({name.lower() for name in kept}) == 5
    assert all(name.isascii() and name.isprintable() and name[0] not in ".-" for name in kept)
