"""Read a folder of git repositories, as `gh teacher download` and `gh classroom clone` make it.

Classroom 50 calls them `CLASSROOM-ASSIGNMENT-USER`, GitHub Classroom `ASSIGNMENT-USER`. The common
prefix, up to a hyphen, is left out; with a roster the user is the longest end of a name that is in
it. Nothing in a repository is read: anybody can make its commits say any time. `gh teacher
download` also writes `scores.csv`: who had to hand in something, and when they did (`roster.py`).
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import Final

from grader.text import Message, msg, shown
from grader_class.find.attempt import (
    Attempt,
    Export,
    Item,
    Piece,
    add_note,
    at_least_half,
    person,
)

LAYOUT: Final = msg("a folder of git repositories")
_MARKS: Final = (".git", ".classroom50.yml")


def matches(items: Sequence[Item]) -> bool:
    """Whether a folder has this layout."""
    return at_least_half(items, _is_repository)


def read(items: Sequence[Item]) -> Export:
    """Read the attempts in a folder."""
    repositories = [item for item in items if _is_repository(item)]
    others = [item.name for item in items if not _is_repository(item)]
    prefix = ""
    if len(repositories) > 1:
        names = [item.name for item in repositories]
        shared = os.path.commonprefix(names)  # noqa: RUF071  of letters: they are no paths
        prefix = shared[: shared.rfind("-") + 1]
    notes: list[Message] = []
    if prefix:
        notes.append(
            msg(
                "All begin with {prefix}, which is left out of their ids.",
                prefix=shown(prefix),
            )
        )
    add_note(notes, msg("Left out, since they are no repositories: {names}."), others)
    return Export(LAYOUT, [_attempt(item, prefix) for item in repositories], notes)


def _is_repository(item: Item) -> bool:
    return item.is_folder and any((item.path / mark).exists() for mark in _MARKS)


def _attempt(item: Item, prefix: str) -> Attempt:
    user = person(item.name.removeprefix(prefix) or item.name)
    ends = [0, *(at + 1 for at, sign in enumerate(item.name) if sign == "-")]
    keys = tuple(item.name[end:] for end in ends)
    return Attempt(item.name, (user,), (Piece(item.path),), keys=keys)
