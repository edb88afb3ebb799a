"""What of a hand-in is compared: DIR/submissions/ID/similar.json, made once, when it is graded.

schema    which form this is
files     [name, sha256] of each of its Python files
commands  [time_ns, hash] of what it asked for in its nominal run, from the first on
path      x, y [mm] of points at equal steps along its way, from where it began
left_out  how many files and commands were too much
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
#: A path that is shorter is none [m].
SHORTEST_M: Final = 0.5
_FARTHEST_MM: Final = 10_000_000
_MOST_BYTES: Final = 2**22
BOUNDS: Final = strict_json.OURS._replace(number=2**53, may_lack=False)
#: Bytes of a hash: below 2**53, so that a number in JSON holds it whoever reads it.
_HASH_BYTES: Final = 6


class HashedFile(NamedTuple):
    """A file: its name and hash."""

    name: str
    sha256: str


class Asked(NamedTuple):
    """A command: how long after the first one [ns], and a hash of what it asks for."""

    time_ns: int
    hash: int


def _has_points(path: tuple[int, ...]) -> tuple[int, ...]:
    if len(path) not in (0, 2 * POINTS):
        raise ValueError(f"expected a path of {POINTS} points, found {len(path)} numbers")
    return path


@dataclass(frozen=True)
class Behaved:
    """What of a hand-in is compared; see the module."""

    files: tuple[HashedFile, ...] = ()
    commands: tuple[Asked, ...] = ()
    path: Annotated[tuple[int, ...], _has_points] = ()
    left_out: int = 0
    schema: Literal["turtlesim-grader/similar/v3"] = SCHEMA

    @classmethod
    def read(cls, folder: Path) -> Self | None:
        """That of a hand-in's folder; None where there is none that can be used."""
        return json_file.kept(cls, folder / NAME, _MOST_BYTES, BOUNDS)


def hash_of(words: Iterable[str]) -> int:
    """A number below 2**48; the same for the same words, on any machine."""
    data = "\0".join(words).encode("utf-8", "surrogatepass")
    return int.from_bytes(hashlib.blake2b(data, digest_size=_HASH_BYTES).digest(), "big")


def behaved(source: Path, nominal: Recording | None, left_out: int = 0) -> bytes:
    """What of a hand-in is compared, as it comes to lie in its folder.

    Args:
        source: the folder with its sources, from `sources.keep`.
        nominal: its nominal run; None where there was none.
        left_out: what `sources.keep` returned.

    Raises:
        OSError: the sources cannot be read.
    """
    commands, path, too_many = _run(nominal)
    files = (HashedFile(each.name, hashlib.sha256(each.data).hexdigest()) for each in kept(source))
    return strict_json.line(Behaved(tuple(files), commands, path, left_out + too_many))


def _run(nominal: Recording | None) -> tuple[tuple[Asked, ...], tuple[int, ...], int]:
    """Its commands, its path, and how many commands were left out."""
    if nominal is None:
        return (), (), 0
    done = load_subject(nominal.scene).behaviour(nominal.trace)
    begin = done.commands[0].time_ns if done.commands else 0
    taken = islice(done.commands, MOST_COMMANDS)
    commands = tuple(Asked(each.time_ns - begin, _hash(each)) for each in taken)
    return commands, _path(done.path), len(done.commands) - len(commands)


def _hash(command: Command) -> int:
    # Four digits: what is computed in another order is the same all the same.
    values = (f"{round(value, 6) + 0.0:.4g}" for value in command.values)
    return hash_of((command.name, *values))


def _path(points: np.ndarray[Any, np.dtype[np.float64]]) -> tuple[int, ...]:
    """Points at equal steps along a path, from its start; whole numbers, so that sums are exact."""
    if len(points) < 2:
        return ()
    driven = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))))
    if not SHORTEST_M <= driven[-1] < _FARTHEST_MM:
        return ()
    at = np.linspace(0.0, driven[-1], POINTS)
    columns = [np.interp(at, driven, points[:, axis] - points[0, axis]) for axis in (0, 1)]
    mm = np.clip(np.rint(np.column_stack(columns) * 1000), -_FARTHEST_MM, _FARTHEST_MM)
    return tuple(int(value) for value in mm.ravel())
