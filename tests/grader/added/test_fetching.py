"""Files come from a commit as data: nothing of a repository does anything, or is anything else."""

from __future__ import annotations

import os

import pytest

from grader import content
from grader.added import fetching
from grader.added.address import Address
from grader.added.fetching import fetch
from grader.errors import UsageError
from tests.grader.added.repositories import commit, git
from tests.grader.testing import exercises


@pytest.fixture
def repository(tmp_path):
    return exercises.write(tmp_path / "repository")


def fetched(folder, behind=""):
    return fetch(Address.parse(f"{folder}{behind}"))


def why_not(folder, behind=""):
    with pytest.raises(UsageError) as refused:
        fetched(folder, behind)
    return str(refused.value)


def test_the_files_are_those_of_the_commit_that_is_asked_for(repository, tmp_path):
    first = commit(repository)
    git(repository, "tag", "v1")
    (repository / "checks.py").write_text("# another\n")
    second = commit(repository)
    for behind, hash_of in (("", second), ("@v1", first), (f"@{first}", first), ("@main", second)):
        found = fetched(repository, behind)
        assert found.origin.commit == hash_of
        assert (found.files["checks.py"] == b"# another\n") == (hash_of == second)
    (tmp_path / "written").mkdir()
    found.write(tmp_path / "written")
    assert content.of_folder(tmp_path / "written") == found.origin.sha256


def test_one_folder_of_a_repository_can_be_the_exercise(tmp_path):
    exercises.write(tmp_path / "ahead")
    commit(tmp_path)
    assert "for #FOLDER: ahead" in why_not(tmp_path)
    assert "checks.py" in fetched(tmp_path, "#ahead").files
    assert "there is no folder 'behind'" in why_not(tmp_path, "#behind")


def test_no_hook_and_no_filter_of_a_repository_or_of_its_reader_runs(
    repository, tmp_path, monkeypatch
):
    ran = tmp_path / "ran"
    hook = f"#!/bin/sh\ntouch {ran}\n"
    (repository / ".gitattributes").write_text("* filter=evil\n")
    commit(repository)
    for name in ("post-checkout", "reference-transaction", "post-merge", "pre-auto-gc"):
        path = repository / ".git" / "hooks" / name
        path.write_text(hook)
        path.chmod(0o755)
    home = tmp_path / "home"
    home.mkdir()
    (home / ".gitconfig").write_text(
        f'[core]\n hooksPath = {repository}/.git/hooks\n[filter "evil"]\n smudge = touch {ran}\n'
        f"[safe]\n directory = *\n"
    )
    monkeypatch.setenv("HOME", str(home))
    monkeypatch.setenv("GIT_DIR", str(tmp_path / "elsewhere"))
    assert "checks.py" in fetched(repository).files
    assert not ran.exists()
    assert not (tmp_path / "elsewhere").exists()


def test_what_is_no_ordinary_file_is_refused(repository):
    (repository / ".github").mkdir()
    (repository / ".github" / "hidden").symlink_to("/etc/passwd")
    commit(repository)
    assert not [name for name in fetched(repository).files if "hidden" in name]
    (repository / "link").symlink_to("/etc/passwd")
    commit(repository)
    assert "link is a symbolic link" in why_not(repository)
    (repository / "link").unlink()
    commit(repository)
    git(repository, "update-index", "--add", "--cacheinfo", f"160000,{'1' * 40},inner")
    git(repository, "commit", "--quiet", "--message=x")
    assert "inner is a submodule" in why_not(repository)
    git(repository, "rm", "--quiet", "--cached", "inner")
    pointer = "version https://git-lfs.github.com/spec/v1\noid sha256:4d7a2146\nsize 12345\n"
    (repository / "map.png").write_text(pointer)
    commit(repository)
    assert "map.png is a pointer of Git LFS: an exercise" in why_not(repository)


@pytest.mark.parametrize(
    "name", ["a\nb", "a\\b", "x" * 201, b"\xff".decode(errors="surrogateescape")]
)
def test_a_file_of_an_odd_name_is_refused(repository, name):
    (repository / name).touch()
    commit(repository)
    assert "odd name" in why_not(repository)


def test_an_exercise_has_bounds(repository, monkeypatch):
    commit(repository)
    monkeypatch.setattr(fetching, "MOST_FILES", 2)
    assert "2 files and 20,000,000 bytes at most" in why_not(repository)
    monkeypatch.setattr(fetching, "MOST_YAML_BYTES", 10)
    assert "exercise.yaml has" in why_not(repository)


def test_a_tree_that_lists_what_has_no_end_is_cut_off(repository, monkeypatch):
    commit(repository)
    tree = git(repository, "rev-parse", "HEAD^{tree}")
    for _ in range(9):  # each holds the one before ten times
        lines = "".join(f"040000 tree {tree}\t{number}\n" for number in range(10))
        made = repository / ".git" / "lines"
        made.write_text(lines)
        with made.open("rb") as file:
            saved = os.dup(0)
            os.dup2(file.fileno(), 0)
            try:
                tree = git(repository, "mktree")
            finally:
                os.dup2(saved, 0)
                os.close(saved)
    bomb = git(repository, "commit-tree", tree, "-m", "x")
    git(repository, "branch", "bomb", bomb)
    monkeypatch.setattr(fetching, "GIT_BYTES", 1_000_000)
    assert why_not(repository, "@bomb")


def test_what_would_extend_the_grader_comes_through_pip_only(repository):
    text = '[project.entry-points."grader.scenes"]\nmine = "mine:SCENE"\n'
    (repository / "pyproject.toml").write_text(text)
    commit(repository)
    assert "Scenes, reports and inspections come through pip only" in why_not(repository)


def test_what_git_says_is_told(repository, tmp_path, monkeypatch):
    commit(repository)
    assert "couldn't find remote ref nothing" in why_not(repository, "@nothing")
    assert "not appear to be a git repository" in why_not(tmp_path)
    monkeypatch.setenv("PATH", str(tmp_path))
    assert "git cannot be started" in why_not(repository)


def test_a_change_is_told_file_by_file():
    before, after = {"a": "1", "b": "1", "c": "1"}, {"a": "1", "b": "2", "d": "1"}
    assert fetching.changed(before, after) == ["~ b", "- c", "+ d"]
