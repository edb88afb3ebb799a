"""Parts of a class that were graded apart, as one: `grader batch --merge DIR...`."""

from __future__ import annotations

import shutil
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from grader.batch.class_file import ClassFile
from grader.batch.entry import Entry, entries
from grader.batch.store import RUN, SHARED, STUDENTS, Store
from grader.errors import UsageError


def merge(parts: Sequence[Path], store: Store) -> list[str]:
    """Bring the parts of a class into one folder; they stay as they are.

    Returns:
        Notes: which parts are missing.

    Raises:
        UsageError: one is no part of a class, two do not fit together, or tell different things of
            the same hand-in. Nothing has changed then.
    """
    found = {part: ClassFile.read(part) for part in parts}
    whole = _common(found)
    graded = {part: entries(part) for part in parts}
    _must_agree(graded)
    for part, those in graded.items():
        for entry in those:
            _take(entry, Store(part), store)
    whole.put(store.out)
    return list(_missing([file.shard for file in found.values()]))


def _common(found: dict[Path, ClassFile]) -> ClassFile:
    (first, whole), *others = ((part, replace(file, shard="")) for part, file in found.items())
    for part, other in others:
        if differences := whole.differences(other):
            told = "; ".join(differences.values())
            raise UsageError(
                f"{part} does not fit to {first} ({told}). Nothing was changed. Have all parts "
                "graded by the same exercise and grader."
            )
    return whole


def _must_agree(graded: dict[Path, list[Entry]]) -> None:
    seen: dict[str, tuple[Path, Entry]] = {}
    for part, those in graded.items():
        for entry in those:
            other, before = seen.setdefault(entry.id, (part, entry))
            if replace(before, folder=Path(), result=None) != replace(
                entry, folder=Path(), result=None
            ):
                raise UsageError(
                    f"{other} and {part} both have {entry.id}, and not the same of it. Nothing was "
                    "changed. Remove one of the two folders submissions/" + entry.id
                )


def _take(entry: Entry, source: Store, store: Store) -> None:
    """Copy an entry, and its run where that is not there yet."""
    place = store.new_place()
    try:
        if source.has(entry.key) and not store.has(entry.key):
            shutil.copytree(source.run(entry.key), place / RUN)
        leave = shutil.ignore_patterns(*SHARED)
        shutil.copytree(entry.folder, place / STUDENTS / entry.id, ignore=leave)
    except (OSError, shutil.Error) as error:
        raise UsageError(f"cannot copy {entry.folder}: {error}") from None
    store.put(entry.key, place)


def _missing(shards: Sequence[str]) -> Iterator[str]:
    """Parts that a number speaks of, and nobody has given."""
    named = [tuple(map(int, shard.split("/"))) for shard in shards if shard]
    for parts in sorted({parts for _, parts in named}):
        there = {part for part, of in named if of == parts}
        if lost := sorted(set(range(1, parts + 1)) - there):
            yield f"Not among these: part {', '.join(map(str, lost))} of {parts}."
