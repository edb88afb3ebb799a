"""The exports have the forms that JPlag and Dolos document."""

import csv
import io
import zipfile
from dataclasses import replace
from datetime import UTC, datetime

import pytest

from grader import strict_json
from grader.batch.entry import entries
from grader.batch.similar import features, sources
from grader.batch.similar.features import Features
from tests.grader.batch.similar.classes import CHALLENGE, HONEST, hand_in, text
from tests.grader.driving import Spiral, drive


@pytest.fixture
def out(tmp_path):
    out = tmp_path / "out"
    for who in ("quick", "parts"):
        hand_in(out, who, HONEST[who], name="Zoë Müller")
    hand_in(out, "-empty", {})
    sources.write_exports(entries(out), CHALLENGE, out)
    return out


def test_jplag_finds_a_folder_for_each_hand_in_and_the_base_code(out):
    jplag = out / "export" / "jplag"
    assert sorted(path.name for path in (jplag / "students").iterdir()) == ["parts", "quick"]
    handed_in = (jplag / "students" / "quick" / "quick_spiral.py").read_bytes()
    assert handed_in == HONEST["quick"].read_bytes()
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
    assert b"class Painter" in members["students/parts.py"]


def test_no_names_leave_the_house(out):
    _, members = table(out)
    assert "Zoë" not in members["info.csv"].decode()


def test_times_are_told_where_all_are_known(out):
    at = datetime(2026, 11, 1, 12, tzinfo=UTC)
    timed = [replace(e, hand_in=replace(e.hand_in, at=at)) for e in entries(out)]
    assert "created_at" not in table(out)[0][0]
    sources.write_exports(timed, CHALLENGE, out)
    assert table(out)[0][0]["created_at"] == "2026-11-01 12:00:00+00:00"


def test_the_same_class_gives_the_same_bytes_and_nothing_older_stays(out):
    zipped = (out / "export" / "dolos.zip").read_bytes()
    stale = out / "export" / "jplag" / "students" / "gone"
    stale.mkdir()
    sources.write_exports(entries(out), CHALLENGE, out)
    assert (out / "export" / "dolos.zip").read_bytes() == zipped
    assert not stale.exists()


def read(entry):
    found = Features.read(entry.folder)
    assert found is not None
    return found


def test_what_is_too_much_is_left_out_and_counted(tmp_path):
    files = {f"f{n}.py": f"x = {n}\n" for n in range(sources.MOST_FILES + 5)}
    files["large.py"] = "x = 1\n" * 2_000_000
    found = read(hand_in(tmp_path / "out", "mallory", files))
    assert (len(found.files), found.left_out) == (sources.MOST_FILES, 6)


def test_nothing_is_run(tmp_path):
    trap = tmp_path / "ran"
    hand_in(tmp_path / "out", "mallory", {"a.py": f"open({str(trap)!r}, 'w')\n"})
    assert not trap.exists()


def test_a_link_out_of_what_was_handed_in_is_not_followed(tmp_path):
    secret = tmp_path / "secret.py"
    secret.write_text("x = 1\n")
    copy = tmp_path / "copy"
    copy.mkdir()
    (copy / "a.py").symlink_to(secret)
    sources.keep(copy, tmp_path / "source")
    assert sources.kept(tmp_path / "source") == []


def test_names_that_a_system_may_not_take_are_changed_and_none_is_lost(tmp_path):
    copy = tmp_path / "copy"
    copy.mkdir()
    for name in ("a b.py", "a_b.py", "-rf.py", "é\n.py", "A_B.py"):
        (copy / name).write_text(f"# {name!r}\n")
    sources.keep(copy, tmp_path / "source")
    kept = [file.name for file in sources.kept(tmp_path / "source")]
    assert len({name.lower() for name in kept}) == 5
    assert all(name.isascii() and name.isprintable() and name[0] not in ".-" for name in kept)


def test_it_comes_back_as_it_was_and_the_same_makes_the_same_bytes(tmp_path):
    recording = drive(Spiral(), 2000)
    one = hand_in(tmp_path / "out", "alice", {"a.py": text("quick")}, recording)
    other = hand_in(tmp_path / "out", "bob", {"a.py": text("quick")}, recording)
    data = (one.folder / features.NAME).read_bytes()
    assert data == (other.folder / features.NAME).read_bytes()
    found = strict_json.of_line(Features, data, features.BOUNDS)
    assert strict_json.line(found) == data
    assert found.commands[0].time_ns == 0 and len(found.path) == 2 * features.POINTS
    assert found.path[:2] == (0, 0)


@pytest.mark.parametrize(
    "data",
    [
        b"",
        b"{}",
        b"[" * 100_000,
        b'{"schema":"turtlesim-grader/similar/v3"}',
        b'{"schema":"turtlesim-grader/similar/v3","files":[["a.py",1]],"commands":[],'
        b'"path":[],"left_out":0}',
        b'{"schema":"turtlesim-grader/similar/v3","files":[],"commands":[[1,true]],'
        b'"path":[],"left_out":0}',
        b'{"schema":"turtlesim-grader/similar/v3","files":[],"commands":[],'
        b'"path":[1,2],"left_out":0}',
        b"\xff",
    ],
)
def test_what_is_none_of_ours_is_refused(data):
    with pytest.raises(ValueError):
        strict_json.of_line(Features, data, features.BOUNDS)
