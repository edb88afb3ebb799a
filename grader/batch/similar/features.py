"""The features by which hand-ins are compared: DIR/submissions/ID/similar.json.

It is made once, when the hand-in is graded.

schema    the version of the format
files     [name, sha256] of each of its Python files
commands  [time_ns, hash] of each command of its nominal run; times from the first one
path      x, y [mm] of points at equal steps along its path, relative to its start
left_out  the number of files and commands beyond the limits
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterable
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import Annotated, Any, Final, Literal, NamedTuple, Self

import numpy as np

from grader import strict_json
from grader.batch.similar.sources import kept
from grader.recording.recording import Recording
from grader.recording.subject import Command, load_subject
from grader.result import json_file

SCHEMA: Final = "turtlesim-grader/similar/v3"
NAME: Final = "similar.json"
MOST_COMMANDS: Final = 1000
#: Points of a path.
POINTS: Final = 64
#: A shorter path is ignored [m].
SHORTEST_M: Final = 0.5
_FARTHEST_MM: Final = 10_000_000
_MOST_BYTES: Final = 2**22
BOUNDS: Final = strict_json.OURS._replace(number=2**53, may_lack=False)
#: Bytes of a hash: below 2**53, so that any reader of JSON gets the exact number.
_HASH_BYTES: Final = 6


class HashedFile(NamedTuple):
    """The name and the hash of a file."""

    name: str
    sha256: str


class TimedCommand(NamedTuple):
    """A command: its time after the first one [ns], and a hash of its values."""

    time_ns: int
    hash: int


def _has_points(path: tuple[int, ...]) -> tuple[int, ...]:
    if len(path) not in (0, 2 * POINTS):
        raise ValueError(f"expected a path of {POINTS} points, found {len(path)} numbers")
    return path


@dataclass(frozen=True)
class Features:
    """The content of similar.json; see the module."""

    files: tuple[HashedFile, ...] = ()
    commands: tuple[TimedCommand, ...] = ()
    path: Annotated[tuple[int, ...], _has_points] = ()
    left_out: int = 0
    schema: Literal["turtlesim-grader/similar/v3"] = SCHEMA

    @classmethod
    def read(cls, folder: Path) -> Self | None:
        """Read that of a hand-in's folder; None where there is no valid one."""
        return json_file.kept(cls, folder / NAME, _MOST_BYTES, BOUNDS)


def hash_of(words: Iterable[str]) -> int:
    """Return a number below 2**48; the same for the same words, on any machine."""
    data = "\0".join(words).encode("utf-8", "surrogatepass")
    return int.from_bytes(hashlib.blake2b(data, digest_size=_HASH_BYTES).digest(), "big")


def features_file(source: Path, nominal: Recording, left_out: int = 0) -> bytes:
    """Return the content of similar.json.

    Args:
        source: the folder with the sources, from `sources.keep`.
        nominal: the nominal run.
        left_out: the return value of `sources.keep`.

    Raises:
        OSError: the sources cannot be read.
    """
    commands, path, too_many = _run(nominal)
    return strict_json.line(Features(hashed(source), commands, path, left_out + too_many))


def hashed(source: Path) -> tuple[HashedFile, ...]:
    """Return the names and hashes of kept sources.

    Raises:
        OSError: they cannot be read.
    """
    files = kept(source)
    return tuple(HashedFile(each.name, hashlib.sha256(each.data).hexdigest()) for each in files)


def _run(nominal: Recording) -> tuple[tuple[TimedCommand, ...], tuple[int, ...], int]:
    """Return the commands of a run, its path, and how many commands were left out."""
    done = load_subject(nominal.scene).behaviour(nominal.trace)
    begin = done.commands[0].time_ns if done.commands else 0
    kept_ones = islice(done.commands, MOST_COMMANDS)
    commands = tuple(TimedCommand(each.time_ns - begin, _hash(each)) for each in kept_ones)
    return commands, _path(done.path), len(done.commands) - len(commands)


def _hash(command: Command) -> int:
    # four digits: another order of computation gives the same hash
    values = (f"{round(value, 6) + 0.0:.4g}" for value in command.values)
    return hash_of((command.name, *values))


def _path(points: np.ndarray[Any, np.dtype[np.float64]]) -> tuple[int, ...]:
    """Return points at equal steps along a path; whole numbers, so that sums are exact."""
    if len(points) < 2:
        return ()
    driven = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))))
    if not SHORTEST_M <= driven[-1] < _FARTHEST_MM:
        return ()
    at = np.linspace(0.0, driven[-1], POINTS)
    columns = [np.interp(at, driven, points[:, axis] - points[0, axis]) for axis in (0, 1)]
    mm = np.clip(np.rint(np.column_stack(columns) * 1000), -_FARTHEST_MM, _FARTHEST_MM)
    return tuple(int(value) for value in mm.ravel())
