"""Read a folder of git repositories, as `gh teacher download` and `gh classroom clone` make it.

Classroom 50 calls them `CLASSROOM-ASSIGNMENT-USER`, GitHub Classroom `ASSIGNMENT-USER`. The common
prefix, up to a hyphen, is left out; a roster decides where it ends, the same for all. `gh teacher
download` also writes `scores.csv`: who had to hand in something, and when they did (`roster.py`).

The time of the last commit is found without trusting the repository. `git log` would follow the
repository's configuration: `log.showSignature` with `gpg.program`, `core.fsmonitor`, hooks and more
are commands. `.git/logs/HEAD` would be safe to parse, but in a clone it has the time of the
cloning. So the name of the commit is read from HEAD, and `git cat-file` prints it from a separate
git folder, which only borrows the objects: no line of the repository's configuration is read,
nothing is fetched, and no working tree is inspected.
"""

from __future__ import annotations

import os
import re
import shutil
import stat
import subprocess
from collections.abc import Sequence
from datetime import datetime, timedelta
from itertools import takewhile
from pathlib import Path
from typing import Final

from grader.batch.find.attempt import Attempt, Export, Item, Piece, add_note, mostly, person, zone
from grader.message import msg
from grader.scratch import make_folder
from grader.submission.folder import shown

LAYOUT: Final = msg("a folder of git repositories")
_MARKS: Final = (".git", ".classroom50.yml")
MAX_COMMIT_BYTES: Final = 1_000_000  # a commit is a message and a few names
_MAX_FILE_BYTES: Final = 5_000_000  # packed-refs of a repository with 50,000 branches
_MOST_OBJECTS: Final = 100_000
_WAIT_S: Final = 20.0
_NAME: Final = re.compile(r"[0-9a-f]{40}")
_REF: Final = re.compile(r"ref: (?P<ref>refs/heads/[\w./+@-]+)")
_COMMITTER: Final = re.compile(
    rb"committer [^\n]*> (?P<seconds>\d{1,11}) (?P<sign>[+-])(?P<hours>\d\d)(?P<minutes>\d\d)"
)


def matches(items: Sequence[Item]) -> bool:
    """Whether a folder has this layout."""
    return mostly(items, _is_repository)


def read(items: Sequence[Item]) -> Export:
    """Read the attempts in a folder."""
    repositories = [item for item in items if _is_repository(item)]
    others = [item.name for item in items if not _is_repository(item)]
    prefix = _prefix([item.name for item in repositories])
    with make_folder() as scratch:
        commits = LastCommits(scratch)
        attempts = [_attempt(item, prefix, commits) for item in repositories]
    pairs = zip(repositories, attempts, strict=True)
    notes = []
    if prefix:
        notes.append(
            msg(
                "All begin with {prefix}, which is left out of their ids.",
                prefix=shown(prefix),
            )
        )
    if commits.git is None:
        notes.append(msg("There is no git on this machine to say when the last commits were made."))
    else:
        unknown = [item.name for item, each in pairs if each.at is None]
        add_note(notes, msg("Nothing says when these were last committed to: {names}."), unknown)
    add_note(notes, msg("Left out, since they are no repositories: {names}."), others)
    return Export(LAYOUT, attempts, notes)


def _is_repository(item: Item) -> bool:
    return item.is_folder and any((item.path / mark).exists() for mark in _MARKS)


def _prefix(names: Sequence[str]) -> str:
    """Return the common prefix of all names, up to a hyphen, if something is left of each."""
    if len(names) < 2:
        return ""
    first, last = min(names), max(names)
    same = takewhile(lambda pair: pair[0] == pair[1], zip(first, last, strict=False))
    return first[: first.rfind("-", 0, sum(1 for _ in same)) + 1]


def _attempt(item: Item, prefix: str, commits: LastCommits) -> Attempt:
    user = item.name.removeprefix(prefix) or item.name
    # with one repository alone only a roster can show where the user's name begins
    shared = prefix or item.name[: item.name.rfind("-") + 1]
    starts = [0, *(at + 1 for at, sign in enumerate(shared) if sign == "-")]
    return Attempt(
        item.name,
        (person(user),),
        (Piece(item.path),),
        at=commits.of(item.path),
        aliases=tuple(item.name[start:] for start in starts),
    )


class LastCommits:
    """Finds the last commit of one repository after another.

    Args:
        scratch: an empty folder for its git folder.

    Attributes:
        git: None where there is none on this machine.
    """

    def __init__(self, scratch: Path) -> None:
        self.git = shutil.which("git")
        self._folder = scratch / "git"
        for folder in ("objects", "refs"):
            (self._folder / folder).mkdir(parents=True)
        (self._folder / "HEAD").write_text("ref: refs/heads/none\n", encoding="ascii")
        (self._folder / "config").write_text("[core]\n\tbare = true\n", encoding="ascii")

    def of(self, clone: Path) -> datetime | None:
        """Return the time of a clone's checked-out commit, by its author's clock; None: unknown."""
        commit = self.commit(clone)
        return None if commit is None else _time(commit)

    def commit(self, clone: Path) -> bytes | None:
        """Return a clone's checked-out commit; None where it cannot be read."""
        theirs = clone / ".git"
        objects = theirs / "objects"
        try:
            if not (_is_folder(theirs) and _is_folder(objects) and _are_plain(objects)):
                return None  # a link, or a file with the path of another folder
            name = _commit(theirs)
        except OSError:
            return None
        if name is None or (size := self._ask(objects, "-s", name)) is None:
            return None
        if not size.strip().isdigit() or int(size) > MAX_COMMIT_BYTES:
            return None
        return self._ask(objects, "commit", name)

    def _ask(self, objects: Path, what: str, name: str) -> bytes | None:
        if self.git is None:
            return None
        try:
            asked = subprocess.run(
                [self.git, "--no-replace-objects", "cat-file", what, name],
                cwd=self._folder,
                env=self._environment(objects),
                stdin=subprocess.DEVNULL,
                stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL,
                timeout=_WAIT_S,
                check=False,
            )
        except (OSError, subprocess.TimeoutExpired):
            return None
        return asked.stdout if asked.returncode == 0 else None

    def _environment(self, objects: Path) -> dict[str, str]:
        kept = {"PATH": os.environ["PATH"]} if "PATH" in os.environ else {}
        return {
            **kept,
            "GIT_DIR": str(self._folder),
            "GIT_OBJECT_DIRECTORY": str(objects.absolute()),
            "GIT_CONFIG_NOSYSTEM": "1",
            "GIT_CONFIG_GLOBAL": os.devnull,
            "GIT_NO_LAZY_FETCH": "1",
            "GIT_TERMINAL_PROMPT": "0",
        }


def _commit(theirs: Path) -> str | None:
    """Return the name of the commit that HEAD points to."""
    head = _read(theirs / "HEAD").strip()
    match = _REF.fullmatch(head)
    if match is None:
        return head if _NAME.fullmatch(head) else None
    if ".." in match["ref"]:
        return None
    loose = _read(theirs / match["ref"]).strip()
    if _NAME.fullmatch(loose):
        return loose
    for line in _read(theirs / "packed-refs").splitlines():
        name, _, ref = line.partition(" ")
        if ref == match["ref"] and _NAME.fullmatch(name):
            return name
    return None


def _time(commit: bytes) -> datetime | None:
    for line in commit.partition(b"\n\n")[0].split(b"\n"):
        if match := _COMMITTER.fullmatch(line):
            try:
                ahead = zone(*(match[each].decode() for each in ("sign", "hours", "minutes")))
                epoch = datetime.fromtimestamp(0, ahead)
                return epoch + timedelta(seconds=int(match["seconds"]))
            except (ValueError, OverflowError):
                return None
    return None


def _read(path: Path) -> str:
    """Read a small file, but follow no link; '' where there is none."""
    try:
        mode = path.lstat()
    except FileNotFoundError:
        return ""
    if not stat.S_ISREG(mode.st_mode) or mode.st_size > _MAX_FILE_BYTES:
        return ""
    return path.read_bytes().decode("utf-8", "replace")


def _is_folder(path: Path) -> bool:
    return stat.S_ISDIR(path.lstat().st_mode)


def _are_plain(objects: Path) -> bool:
    """Whether git would neither block on a file nor be led to other folders."""
    seen = 0
    for at, folders, files in os.walk(objects):
        seen += len(folders) + len(files)
        if seen > _MOST_OBJECTS or {"alternates", "http-alternates"} & {*files, *folders}:
            return False
        if not all(stat.S_ISREG(Path(at, name).lstat().st_mode) for name in files):
            return False
    return True
