"""A folder of git repositories, as `gh teacher download` and `gh classroom clone` make it.

Classroom 50 calls them `CLASSROOM-ASSIGNMENT-USER`, GitHub Classroom `ASSIGNMENT-USER`. What all
begin with, up to a hyphen, is left out; a roster settles where that ends, the same for all. Beside
them `gh teacher download` lays `scores.csv`, which says who was to hand in something, and when
(`roster.py`).
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import takewhile
from typing import Final

from grader.batch.find.attempt import Attempt, Item, Piece, Reading, mostly, person
from grader.batch.find.git_time import LastCommits
from grader.language.phrase import say
from grader.scratch import make_folder
from grader.submission.folder import listed, shown

LAYOUT: Final = say("a folder of git repositories")
_MARKS: Final = (".git", ".classroom50.yml")


def looks_like(items: Sequence[Item]) -> bool:
    """Whether a folder is one."""
    return mostly(items, _is_repository)


def read(items: Sequence[Item]) -> Reading:
    """The hand-ins in one."""
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
            say(
                "All begin with {prefix}, which is left out of their ids.",
                prefix=shown(prefix),
            )
        )
    if not commits.can_be_asked:
        notes.append(say("There is no git on this machine to say when the last commits were made."))
    elif unknown := [item.name for item, each in pairs if each.at is None]:
        notes.append(
            say("Nothing says when these were last committed to: {names}.", names=listed(unknown))
        )
    if others:
        notes.append(
            say("Left out, since they are no repositories: {names}.", names=listed(others))
        )
    return Reading(LAYOUT, attempts, notes)


def _is_repository(item: Item) -> bool:
    return item.is_folder and any((item.path / mark).exists() for mark in _MARKS)


def _prefix(names: Sequence[str]) -> str:
    """What all names begin with, up to a hyphen, if something is left of each."""
    if len(names) < 2:
        return ""
    first, last = min(names), max(names)
    same = takewhile(lambda pair: pair[0] == pair[1], zip(first, last, strict=False))
    return first[: first.rfind("-", 0, sum(1 for _ in same)) + 1]


def _attempt(item: Item, prefix: str, commits: LastCommits) -> Attempt:
    user = item.name.removeprefix(prefix) or item.name
    # of one repository alone nobody knows where the user's name begins, but a roster may
    shared = prefix or item.name[: item.name.rfind("-") + 1]
    starts = [0, *(at + 1 for at, sign in enumerate(shared) if sign == "-")]
    return Attempt(
        item.name,
        (person(user),),
        (Piece(item.path),),
        at=commits.of(item.path),
        aliases=tuple(item.name[start:] for start in starts),
    )
