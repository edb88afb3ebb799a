"""What was handed in may lie in the folder for results, and be called anything; nothing follows."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path

import pytest

from grader import files, grading
from grader.cli import main
from grader.errors import UsageError
from grader.recording import reading
from tests.grader.driving import Spiral, drive

MINE = "mine, and no student's\n"


@pytest.fixture(scope="module")
def drawn():
    return drive(Spiral(), ticks=300)


@pytest.fixture
def repository(tmp_path, monkeypatch, drawn):
    """What somebody has handed in, with a folder for results; we are in it."""
    monkeypatch.setitem(
        grading.RUNNERS, "virtual", lambda _, plan, __=None: replace(drawn, start=plan.start)
    )
    here = tmp_path / "repository"
    (here / "graded").mkdir(parents=True)
    (here / "node.py").write_text("import turtlesim.msg")
    monkeypatch.chdir(here)
    return here


@pytest.fixture
def secret(tmp_path):
    (tmp_path / "home").mkdir()
    file = tmp_path / "home" / ".bashrc"
    file.write_text(MINE)
    return file


NAMES = ["output.txt", "canvas.png", "report.html", "result.json"]


@pytest.mark.parametrize("name", NAMES)
def test_no_file_is_written_through_a_link_in_the_folder_for_results(repository, secret, name):
    (repository / "graded" / name).symlink_to(secret)
    assert main(["run", "node.py", "--out", "graded"]) == 0
    assert secret.read_text() == MINE
    made = repository / "graded" / name
    assert made.is_file()
    assert not made.is_symlink()


def test_another_s_result_is_not_withdrawn_through_a_link(repository, tmp_path):
    assert main(["run", "node.py", "--out", "../neighbour"]) == 0
    (repository / "graded" / "result.json").symlink_to("../../neighbour/result.json")
    before = (tmp_path / "neighbour" / "result.json").read_bytes()
    assert main(["run", "node.py", "--out", "graded"]) == 0
    assert (tmp_path / "neighbour" / "result.json").read_bytes() == before


@pytest.mark.parametrize("name", NAMES)
def test_no_pipe_in_the_folder_for_results_is_waited_for(repository, name):
    os.mkfifo(repository / "graded" / name)
    assert main(["run", "node.py", "--out", "graded"]) == 0
    assert (repository / "graded" / name).is_file()


@pytest.mark.parametrize("name", [*NAMES])
def test_a_folder_in_the_place_of_a_file_is_told_before_the_run(repository, capsys, name):
    (repository / "graded" / name).mkdir()
    assert main(["run", "node.py", "--out", "graded"]) == 2
    assert "it is a folder" in capsys.readouterr().err


def test_a_file_in_the_place_of_the_recording_is_told_before_the_run(repository, capsys):
    (repository / "graded" / "recording").touch()
    assert main(["run", "node.py", "--out", "graded"]) == 2
    assert "it is a file; expected a folder" in capsys.readouterr().err


@pytest.mark.parametrize("name", ["recording", "recording/.unfinished", "recording/varied_1"])
def test_no_recording_is_written_through_a_link(repository, secret, name):
    link = repository / "graded" / name
    link.parent.mkdir(exist_ok=True)
    link.symlink_to(secret.parent, target_is_directory=True)
    assert main(["run", "node.py", "--out", "graded"]) == 0
    assert [path.name for path in secret.parent.iterdir()] == [secret.name]
    assert len(reading.load_all(repository / "graded" / "recording").varied) == 3


@pytest.mark.parametrize("words", [["--out", "graded"], []])
def test_a_folder_for_results_that_is_itself_a_link_of_theirs_is_refused(
    repository, secret, capsys, words
):
    (repository / "graded").rmdir()
    (repository / "graded").symlink_to(secret.parent, target_is_directory=True)
    assert main(["run", "node.py", *words]) == 2
    assert "is a link that lies with the submission" in capsys.readouterr().err
    assert [path.name for path in secret.parent.iterdir()] == [secret.name]


def test_a_link_of_the_caller_s_own_is_followed(repository, tmp_path):
    (tmp_path / "disk").mkdir()
    (tmp_path / "results").symlink_to("disk", target_is_directory=True)
    assert main(["run", "node.py", "--out", str(tmp_path / "results")]) == 0
    assert (tmp_path / "disk" / "result.json").is_file()


@pytest.mark.parametrize(
    "name", ["[/b].py", "[red].py", "\x1b[31m.py", "\n::error::x.py", ":smile:.py", "\udcff.py"]
)
def test_a_name_that_means_something_to_a_terminal_or_a_runner_is_only_a_name(
    repository, capfd, name
):
    Path(name).parent.mkdir(exist_ok=True)
    Path(name).write_text("import turtlesim.msg")
    assert main(["run", name]) == 0
    told = capfd.readouterr()
    for text in (told.out, told.err):
        assert "\x1b" not in text
        assert not [line for line in text.splitlines() if line.lstrip().startswith("::")]
    if "[" in name[0]:
        assert f"graded/{name}/report.html" in told.out


@pytest.mark.parametrize("name", ["[/b]", "\x1b[31m", "\n::error::x"])
def test_nor_where_it_cannot_be_used(repository, capfd, name):
    Path(f"{name.replace('/', '')}.txt").touch()
    assert main(["run", f"{name.replace('/', '')}.txt"]) == 2
    assert main(["run", f"{name}.py"]) == 2
    told = capfd.readouterr().err
    assert "\x1b" not in told
    assert not [line for line in told.splitlines() if line.lstrip().startswith("::")]


def test_what_is_put_takes_the_place_of_a_link(tmp_path, secret):
    (tmp_path / "a.txt").symlink_to(secret)
    files.put(tmp_path / "a.txt", b"new")
    assert (secret.read_text(), (tmp_path / "a.txt").read_bytes()) == (MINE, b"new")
    (tmp_path / "b").mkdir()
    with pytest.raises(UsageError, match="cannot write"):
        files.put(tmp_path / "b", b"new")
