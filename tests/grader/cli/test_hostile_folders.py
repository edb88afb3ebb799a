"""What was handed in may lie in the folder for results, and be called anything; nothing follows."""

import os
from pathlib import Path

import pytest

from grader.cli import main
from grader.errors import UsageError
from grader.recording import reading
from grader.system import files

MINE = "mine, and no student's\n"
NAMES = ["output.txt", "canvas.png", "report.html", "result.json"]


@pytest.fixture
def repository(tmp_path, monkeypatch, in_no_time):
    """What somebody has handed in, with a folder for results; we are in it."""
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


def test_no_file_is_written_through_a_link_in_the_folder_for_results(repository, secret):
    made = [repository / "graded" / name for name in NAMES]
    for file in made:
        file.symlink_to(secret)
    assert main(["run", "node.py", "--out", "graded"]) == 0
    assert secret.read_text() == MINE
    assert all(file.is_file() and not file.is_symlink() for file in made)


def test_no_pipe_in_the_folder_for_results_is_waited_for(repository):
    for name in NAMES:
        os.mkfifo(repository / "graded" / name)
    assert main(["run", "node.py", "--out", "graded"]) == 0
    assert all((repository / "graded" / name).is_file() for name in NAMES)


@pytest.mark.parametrize("name", [*NAMES, "recording"])
def test_a_folder_in_the_place_of_a_file_or_the_other_way_round_is_told_before_the_run(
    repository, capsys, name
):
    path = repository / "graded" / name
    path.touch() if name == "recording" else path.mkdir()
    assert main(["run", "node.py", "--out", "graded"]) == 2
    said = "it is a file; expected a folder" if name == "recording" else "it is a folder"
    assert said in capsys.readouterr().err


@pytest.mark.parametrize("names", [["recording"], ["recording/.unfinished", "recording/varied_1"]])
def test_no_recording_is_written_through_a_link(repository, secret, names):
    for name in names:
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


@pytest.mark.parametrize("name", ["[/b].py", "\x1b[31m\n::error::[red]:smile:\udcff.py"])
def test_a_name_that_means_something_to_a_terminal_or_a_runner_is_only_a_name(
    repository, capfd, name
):
    Path(name).parent.mkdir(exist_ok=True)
    Path(name).write_text("import turtlesim.msg")
    assert main(["run", name]) == 0
    found = capfd.readouterr()
    if name[0] == "[":
        assert f"graded/{name}/report.html" in found.out
    Path(f"{name}.txt").touch()
    assert main(["run", f"{name}.txt"]) == main(["run", f"{name}.missing"]) == 2
    missing = capfd.readouterr()
    for text in (found.out, found.err, missing.err):
        assert "\x1b" not in text
        assert not [line for line in text.splitlines() if line.lstrip().startswith("::")]


def test_what_is_put_takes_the_place_of_a_link(tmp_path, secret):
    (tmp_path / "a.txt").symlink_to(secret)
    files.put(tmp_path / "a.txt", b"new")
    assert (secret.read_text(), (tmp_path / "a.txt").read_bytes()) == (MINE, b"new")
    (tmp_path / "b").mkdir()
    with pytest.raises(UsageError, match="cannot write"):
        files.put(tmp_path / "b", b"new")
