"""Git repositories on this disk, and exercises that were added from one."""

from __future__ import annotations

import subprocess
from pathlib import Path

from grader.added import pins
from grader.added.address import Address
from grader.added.fetching import fetch
from grader.added.pins import FILES, Pin


def git(folder: Path, *words: str) -> str:
    """Run git in a repository, which is made if need be; return what it prints."""
    if not (folder / ".git").exists():
        _git(folder, "init", "--quiet", "--initial-branch=main")
    return _git(folder, *words)


def _git(folder: Path, *words: str) -> str:
    who = ("-c", "user.name=t", "-c", "user.email=t@example.org")
    done = subprocess.run(["git", *who, *words], cwd=folder, check=True, capture_output=True)
    return done.stdout.decode().strip()


def commit(folder: Path) -> str:
    """Commit all that is there; return the commit."""
    git(folder, "add", "--all")
    git(folder, "commit", "--quiet", "--message=x")
    return git(folder, "rev-parse", "HEAD")


def added(repository: Path, name: str) -> Path:
    """Add the exercise of a repository without trying it; return the folder of its files."""
    fetched = fetch(Address.parse(str(repository)))
    with pins.unfinished() as place:
        fetched.write(place / FILES)
        pins.write(place, Pin(name, fetched.origin))
        pins.put(place, name)
    return pins.home() / name / FILES
