"""Folders of repositories: Classroom 50, GitHub Classroom, clones; nothing of theirs is run."""

from __future__ import annotations

import os
from datetime import datetime
from pathlib import Path

import pytest

from grader.batch.find import clones
from tests.grader.batch.find.exports import (
    NODE,
    Finder,
    git,
    lay,
    noted,
    packed,
    repository,
)
from tests.needs import needs

pytestmark = needs("git")

NOON = datetime.fromisoformat("2026-11-01T12:00:00+01:00")
SCORES = (
    "username,first_name,last_name,email,section,score,max_score,datetime,submission_tag\n"
    "anna-b,Anna,Berg,a@x.org,1,,,,submit/2026-10-30T08-00-00Z\n"
    "anna-b,Anna,Berg,a@x.org,1,,,,submit/2026-10-31T09-00-00Z\n"
    "anna-c,Anna,Cruz,c@x.org,1,,,,submit/2026-10-29T09-00-00Z\n"
    "dora,Dora,Dee,d@x.org,1,,,,\n"
)


def test_a_clone_says_when_its_last_commit_was_made(tmp_path: Path, finder: Finder) -> None:
    """Also where the commit lies in a pack, and the branch in packed-refs."""
    root = tmp_path / "spiral-submissions"
    repository(root / "spiral-anna")
    repository(tmp_path / "origin", "2026-11-02T12:00:00+0100")
    git(tmp_path, "clone", "-q", str(tmp_path / "origin"), str(root / "spiral-bob"))
    repository(root / "spiral-cy", "2026-11-03T12:00:00-0330")
    git(root / "spiral-cy", "gc", "-q")
    git(root / "spiral-cy", "checkout", "-q", "--detach")
    found = finder(root)
    assert [(each.id, each.at and each.at.day) for each in found.hand_ins] == [
        ("anna", 1),
        ("bob", 2),
        ("cy", 3),
    ]
    assert found.hand_ins[0].at == NOON
    assert found.hand_ins[0].path == root / "spiral-anna"
    assert noted(found, "All begin with spiral-")


def test_classroom_50_says_who_was_to_hand_in_and_when(tmp_path: Path, finder: Finder) -> None:
    root = tmp_path / "cs-spiral_submissions"
    for user in ("anna-b", "anna-c"):
        repository(root / f"cs-spiral-{user}")
    lay(root, {"scores.csv": SCORES})
    by_id = finder.by_id(root)
    assert {id: each.name for id, each in by_id.items()} == {
        "anna-b": "Anna Berg",
        "anna-c": "Anna Cruz",
        "dora": "Dora Dee",
    }
    assert str(by_id["anna-b"].at) == "2026-10-31 09:00:00+00:00"
    assert str(by_id["dora"].problem) == "Nothing was handed in."


def test_nothing_of_a_repository_is_run_and_no_link_followed(
    tmp_path: Path, finder: Finder
) -> None:
    root, ran = tmp_path / "r", tmp_path / "ran"
    evil = repository(root / "evil")
    command = f"touch {ran}"
    for key in ("core.fsmonitor", "core.pager", "gpg.program", "core.sshCommand", "core.editor"):
        git(evil, "config", key, command)
    git(evil, "config", "log.showSignature", "true")
    git(evil, "config", "alias.cat-file", f"!{command}")
    hooks = lay(evil / ".git" / "hooks", {"post-checkout": f"#!/bin/sh\n{command}\n"})
    (hooks / "post-checkout").chmod(0o755)
    linked = repository(root / "linked")
    (linked / ".git" / "HEAD").unlink()
    (linked / ".git" / "HEAD").symlink_to(evil / ".git" / "HEAD")
    elsewhere = lay(root / "elsewhere", {"node.py": NODE})
    (elsewhere / ".git").write_text(f"gitdir: {evil / '.git'}\n")
    up = repository(root / "up")
    (up / ".git" / "HEAD").write_text("ref: refs/heads/../../../../evil/.git/refs/heads/main\n")
    found = finder(root)
    assert {each.id: each.at for each in found.hand_ins} == {
        "evil": NOON,
        "linked": None,
        "elsewhere": None,
        "up": None,
    }
    assert not ran.exists()
    assert noted(found, "Nothing says when", "elsewhere", "linked", "up")


@pytest.mark.parametrize("name", ["info/alternates", "pack/pack-a.idx", "00/" + 38 * "0"])
def test_git_is_not_asked_where_it_would_wait_for_a_pipe(
    name: str, tmp_path: Path, finder: Finder, monkeypatch: pytest.MonkeyPatch
) -> None:
    repository(tmp_path / "class" / "spiral-anna")
    pipe = tmp_path / "class" / "spiral-anna" / ".git" / "objects" / name
    pipe.parent.mkdir(exist_ok=True)
    os.mkfifo(pipe)
    monkeypatch.setattr(clones.subprocess, "run", lambda *_, **__: pytest.fail("git was asked"))
    (found,) = finder(tmp_path / "class").hand_ins
    assert found.at is None


def test_a_damaged_repository_is_a_hand_in_still(tmp_path: Path, finder: Finder) -> None:
    root = tmp_path / "r"
    broken = repository(root / "broken")
    for file in (broken / ".git" / "objects").rglob("*"):
        if file.is_file():
            file.chmod(0o644)
            file.write_bytes(b"nonsense")
    (found,) = finder(root).hand_ins
    assert found.path == broken and found.at is None


def test_a_zip_of_clones_says_when_and_brings_no_configuration(
    tmp_path: Path, finder: Finder
) -> None:
    clone = repository(tmp_path / "c" / "hw-anna")
    files = {
        f"c/hw-anna/{path.relative_to(clone)}": path.read_bytes()
        for path in clone.rglob("*")
        if path.is_file()
    }
    archive = tmp_path / "class.zip"
    archive.write_bytes(packed(files))
    (found,) = finder(archive).hand_ins
    assert (found.id, found.at) == ("hw-anna", NOON)
    assert found.path and {each.name for each in (found.path / ".git").iterdir()} == {
        "HEAD",
        "objects",
        "refs",
    }
