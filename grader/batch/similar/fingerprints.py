"""Fingerprints of a sequence of words: numbers that two sequences share where they run alike.

A fingerprint is the hash of `LENGTH` words that follow one another. Of those of a source some are
selected by winnowing: the smallest of each `WINDOW` that follow one another, the last of equal
ones. What two sources have in common is then found for certain where it is at least
`LENGTH + WINDOW - 1` words long, and never where it is shorter than `LENGTH`
(Schleimer, Wilkerson, Aiken: Winnowing, SIGMOD 2003; MOSS, Dolos and copydetect go by it, too).
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple

from grader.batch.similar.syntax import MOST_WORDS, Unit

LENGTH = 8
WINDOW = 3
#: Bytes of a hash: below 2**53, so that a number in JSON holds it whoever reads it.
_BYTES = 6


class Fingerprint(NamedTuple):
    """A hash, and the lines from which it was made, first and last."""

    hash: int
    first: int
    last: int


def hash_of(words: Iterable[str]) -> int:
    """A number below 2**48; the same for the same words, on any machine."""
    data = "\n".join(words).encode("utf-8", "surrogatepass")
    return int.from_bytes(hashlib.blake2b(data, digest_size=_BYTES).digest(), "big")


def of_units(units: Iterable[Unit]) -> list[Fingerprint]:
    """The selected fingerprints of a source, in its order."""
    left = MOST_WORDS
    selected: list[Fingerprint] = []
    for unit in units:
        selected += _winnowed(list(_all(unit[:left])))
        left -= len(unit)
        if left <= 0:
            break
    return selected


def all_of(units: Iterable[Unit]) -> set[int]:
    """Every hash of a source, selected or not: what is known is to be known in any surroundings."""
    return {each.hash for unit in units for each in _all(unit)}


def _all(unit: Unit) -> Iterator[Fingerprint]:
    for start in range(len(unit) - LENGTH + 1):
        words = unit[start : start + LENGTH]
        lines = [word.line for word in words]
        yield Fingerprint(hash_of(word.text for word in words), min(lines), max(lines))


def _winnowed(every: Sequence[Fingerprint]) -> list[Fingerprint]:
    selected: dict[int, Fingerprint] = {}
    for start in range(max(1, len(every) - WINDOW + 1)):
        window = range(start, min(start + WINDOW, len(every)))
        if window:
            least = min(window, key=lambda at: (every[at].hash, -at))
            selected[least] = every[least]
    return list(selected.values())
