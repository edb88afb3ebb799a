import errno
import json
import os

import pytest

from grader.cli import main
from grader.exercise.result.result import Result
from grader.recording import saving
from grader.recording.recording import Recordings
from tests.files import contents
from tests.grader.driving import Spiral, drive
from tests.grader.reports import samples

CODE = "print('a week of work')\n"
FOREIGN = "there is a file already that this grader has not written"
READ = "this call reads it"


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "s.py").write_text(CODE)
    (tmp_path / "notes.txt").write_text("mine")
    (tmp_path / "package").mkdir()
    (tmp_path / "package" / "node.py").write_text(CODE)
    (tmp_path / "rr.json").write_text(json.dumps(samples.result()))
    error = {"schema": "turtlesim-grader/error/v1", "whose": "call", "message": "", "max_score": 1}
    (tmp_path / "error.json").write_text(json.dumps(error))
    saving.save_all(Recordings(drive(Spiral(), ticks=10)), tmp_path / "recording")
    return tmp_path


@pytest.mark.parametrize(
    ("call", "why"),
    [
        ("report rr.json --error-json rr.json", READ),
        ("report rr.json --error-json ../{here}/rr.json", READ),
        ("report rr.json --format html --out rr.json", READ),
        ("report error.json --format html --out error.json", READ),
        ("report rr.json --format html --out recording/run.json", READ),
        ("report rr.json --error-json notes.txt", FOREIGN),
        ("report rr.json --nonsense --error-json notes.txt", FOREIGN),
        ("report error.json --nonsense --error-json error.json", READ),
        ("run s.py --error-json s.py", READ),
        ("run s.py --json s.py", READ),
        ("run s.py --json notes.txt", FOREIGN),
        ("run s.py --nonsense --error-json s.py", READ),
        ("run package --error-json package/node.py", FOREIGN),
        ("run package --json package/node.py", FOREIGN),
        ("check recording --json recording/run.json", FOREIGN),
        ("check recording --error-json recording/run.json", FOREIGN),
        ("new mine --error-json notes.txt", FOREIGN),
    ],
)
def test_what_somebody_has_written_stays_and_the_call_is_refused(here, capsys, call, why):
    before = contents(here)
    assert main(call.format(here=here.name).split()) == 2
    assert why in capsys.readouterr().err
    assert contents(here) == before


def test_an_empty_file_and_one_of_ours_are_replaced(here):
    (here / "empty.json").touch()
    assert main(["check", "recording", "--json", "empty.json", "--error-json", "error.json"]) == 0
    assert not (here / "error.json").exists()
    assert main(["check", "recording", "--json", "rr.json"]) == 0
    assert Result.read(here / "rr.json") == Result.read(here / "empty.json")
    assert main(["report", "rr.json", "--format", "html", "--out", "notes.txt"]) == 0


def test_a_folder_that_cannot_be_made_is_told_and_no_traceback(here, capsys):
    assert main(["run", "s.py", "--out", "/proc/x"]) == 2
    message = capsys.readouterr().err
    assert "/proc/x" in message
    assert "Traceback" not in message


def test_a_disk_that_is_full_by_then_is_told_and_no_traceback(here, capsys, monkeypatch):
    def fails(*_):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), "recording/metadata.yaml")

    monkeypatch.setattr("grader.cli.check.main", fails)
    assert main(["check", "recording"]) == 3
    message = capsys.readouterr().err
    assert "No space left on device: 'recording/metadata.yaml'" in message
    assert "Traceback" not in message
    assert "report" not in message
