"""Recordings made while rosbags wrote and read them: still read, judged and reported."""

import json
import shutil
from pathlib import Path

import pytest

from grader import cli
from grader.recording import reading, saving
from grader.recording.recording import Recordings

FOLDER = Path(__file__).parent / "of_rosbags"


@pytest.mark.parametrize("name", ["turtles", "talker"])
def test_it_is_read_and_means_the_same_when_it_is_written_again(name, tmp_path):
    older = reading.load(FOLDER / name)  # which compares the hash of its trace
    saving.save_all(Recordings(older), tmp_path / "again")
    again = reading.load(tmp_path / "again")
    assert again.run == older.run
    for file in ("metadata.yaml", "observations.json", "output.txt", "circumstances.json"):
        if (FOLDER / name / file).exists():
            assert (tmp_path / "again" / file).read_bytes() == (FOLDER / name / file).read_bytes()


def test_it_is_judged_and_reported(tmp_path, capsys):
    folder = shutil.copytree(FOLDER / "talker", tmp_path / "graded" / "recording")
    result = tmp_path / "result.json"
    assert cli.main(["check", str(folder), "--exercise", "talker", "--json", str(result)]) == 0
    assert json.loads(result.read_text(encoding="utf-8"))["score"] == 100
    capsys.readouterr()
    assert cli.main(["report", str(result), "--format", "terminal"]) == 0
    assert "100" in capsys.readouterr().out
