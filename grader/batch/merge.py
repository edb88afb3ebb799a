"""Parts of a class that were graded apart, as one: `grader batch --merge DIR...`."""

from __future__ import annotations

import shutil
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from grader.batch.batch import check_same_class
from grader.batch.class_file import ClassFile
from grader.batch.entry import Entry, entries
from grader.batch.store import RUN, SHARED, STUDENTS, Store
from grader.errors import UsageError
from grader.exercise.exercise import Exercise
from grader.language.phrase import Phrase, joined, say


def merge(parts: Sequence[Path], exercise: Exercise, store: Store) -> list[str]:
    """Bring the parts of a class into one folder; they stay as they are.

    Returns:
        Notes: which parts are missing, or not finished.

    Raises:
        UsageError: one is no part of a class, two do not fit together, or tell different things of
            the same hand-in, or another exercise has judged them. Nothing has changed then.
    """
    found = {part: ClassFile.read(part) for part in parts}
    whole = _common(found)
    _must_be_judged_by(exercise, whole)
    graded = {part: entries(part) for part in parts}
    _must_agree(graded)
    check_same_class(store, whole)
    for part, those in graded.items():
        for entry in those:
            _take(entry, Store(part), store)
    whole.put(store.out)
    unfinished = [
        note for part, file in found.items() for note in file.unfinished(part, len(graded[part]))
    ]
    return [*_missing([file.shard for file in found.values()]), *unfinished]


def _common(found: dict[Path, ClassFile]) -> ClassFile:
    hand_ins = {file.shard: file.hand_ins for file in found.values()}
    (first, whole), *others = (
        (part, replace(file, shard="", hand_ins=sum(hand_ins.values())))
        # nothing of a part may have been run: it fits to any level
        for part, file in sorted(found.items(), key=lambda each: not each[1].isolation)
    )
    cuts = {shard.partition("/")[2] for shard in hand_ins}
    if len(cuts) > 1:
        shards = sorted(shard or say("a whole class") for shard in hand_ins)
        raise UsageError(
            say(
                "these are not parts of one class, cut in one way: {shards}. Nothing was changed.",
                shards=joined(shards, ", "),
            )
        )
    for part, other in others:
        if differences := whole.differences(other):
            raise UsageError(
                say(
                    "{part} does not fit to {first} ({differences}). Nothing was changed. Have all "
                    "parts graded by the same exercise and grader.",
                    part=str(part),
                    first=str(first),
                    differences=joined(list(differences.values()), "; "),
                )
            )
    return whole


def _must_be_judged_by(exercise: Exercise, whole: ClassFile) -> None:
    ours = replace(whole, exercise=exercise.name, exercise_sha256=exercise.sha256)
    if differences := ours.differences(whole):
        raise UsageError(
            say(
                "these parts were judged by something else ({differences}). Nothing was changed. "
                "Name what they were judged by: --exercise ...",
                differences=joined(list(differences.values()), "; "),
            )
        )


def _must_agree(graded: dict[Path, list[Entry]]) -> None:
    seen: dict[str, tuple[Path, Entry]] = {}
    for part, those in graded.items():
        for entry in those:
            other, before = seen.setdefault(entry.id, (part, entry))
            if replace(before, folder=Path(), result=None) != replace(
                entry, folder=Path(), result=None
            ):
                raise UsageError(
                    say(
                        "{other} and {part} both have {id}, and not the same of it. Nothing was "
                        "changed. Remove one of the two folders submissions/{id}",
                        other=str(other),
                        part=str(part),
                        id=Phrase(entry.id),
                    )
                )


def _take(entry: Entry, source: Store, store: Store) -> None:
    """Copy an entry, and its run where that is not there yet."""
    place = store.new_place()
    try:
        if source.has(entry.key) and not store.has(entry.key):
            shutil.copytree(source.run(entry.key), place / RUN, symlinks=True)
        leave = shutil.ignore_patterns(*SHARED)
        shutil.copytree(entry.folder, place / STUDENTS / entry.id, symlinks=True, ignore=leave)
    except (OSError, shutil.Error) as error:
        raise UsageError(
            say("cannot copy {folder}: {why}", folder=str(entry.folder), why=str(error))
        ) from None
    store.put(entry.key, place)


def _missing(shards: Sequence[str]) -> Iterator[str]:
    """Parts that a number speaks of, and nobody has given."""
    named = [tuple(map(int, shard.split("/"))) for shard in shards if shard]
    for parts in sorted({parts for _, parts in named}):
        there = {part for part, of in named if of == parts}
        if lost := sorted(set(range(1, parts + 1)) - there):
            numbers = ", ".join(map(str, lost))
            yield say("Not among these: part {numbers} of {parts}.", numbers=numbers, parts=parts)
