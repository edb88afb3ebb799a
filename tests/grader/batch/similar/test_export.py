"""The exports have the forms that JPlag and Dolos document."""

import csv
import io
import zipfile
from dataclasses import replace
from datetime import UTC, datetime

import pytest

from grader.batch.entry import entries
from grader.batch.similar import export
from tests.grader.batch.similar.classes import CHALLENGE, HONEST, hand_in


@pytest.fixture
def out(tmp_path):
    out = tmp_path / "out"
    for who in ("quick", "parts"):
        hand_in(out, who, HONEST[who], name="Zoë Müller")
    hand_in(out, "-empty", {})
    export.write(entries(out), CHALLENGE, out)
    return out


def test_jplag_finds_a_folder_for_each_hand_in_and_the_base_code(out):
    jplag = out / "export" / "jplag"
    assert sorted(path.name for path in (jplag / "students").iterdir()) == ["parts", "quick"]
    handed_in = (jplag / "students" / "quick" / "quick_spiral.py").read_bytes()
    assert handed_in == HONEST["quick"].read_bytes()
    base = {path.relative_to(jplag / "base").as_posix() for path in jplag.rglob("base/**/*.py")}
    assert "reference/turtle_controller.py" in base
    assert "starter/turtlesim_challenge/turtle_controller.py" in base


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
    export.write(timed, CHALLENGE, out)
    assert table(out)[0][0]["created_at"] == "2026-11-01 12:00:00+00:00"


def test_the_same_class_gives_the_same_bytes_and_nothing_older_stays(out):
    zipped = (out / "export" / "dolos.zip").read_bytes()
    stale = out / "export" / "jplag" / "students" / "gone"
    stale.mkdir()
    export.write(entries(out), CHALLENGE, out)
    assert (out / "export" / "dolos.zip").read_bytes() == zipped
    assert not stale.exists()
