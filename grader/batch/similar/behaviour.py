"""What of a hand-in is compared: DIR/submissions/ID/similar.json, made once, when it is graded.

schema    which form this is
files     [name, sha256] of each of its Python files
commands  [tick, hash] of what it asked for in its nominal run, from the first on
path      x, y [mm] of points at equal steps along its way, from where it began
left_out  how many files and commands were too much
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable
from dataclasses import asdict, dataclass
from itertools import islice
from pathlib import Path
from typing import Any, Final, NamedTuple

import numpy as np

from grader import strict_json
from grader.batch.similar.sources import kept
from grader.files import read_own
from grader.recording.recording import Recording
from grader.scenes import load_scene
from grader.scenes.scene import Command

SCHEMA: Final = "turtlesim-grader/similar/v2"
NAME: Final = "similar.json"
MOST_COMMANDS: Final = 1000
#: Points of a path.
POINTS: Final = 64
#: A path that is shorter is none [m].
SHORTEST_M: Final = 0.5
_FARTHEST_MM: Final = 10_000_000
_MOST_BYTES: Final = 2**22
#: Bytes of a hash: below 2**53, so that a number in JSON holds it whoever reads it.
_HASH_BYTES: Final = 6


class Source(NamedTuple):
    """A file: its name and hash."""

    name: str
    sha256: str


class Asked(NamedTuple):
    """A command: how many ticks after the first one, and a hash of what it asks for."""

    tick: int
    hash: int


@dataclass(frozen=True)
class Behaved:
    """What of a hand-in is compared; see the module."""

    files: tuple[Source, ...] = ()
    commands: tuple[Asked, ...] = ()
    path: tuple[int, ...] = ()
    left_out: int = 0

    def to_bytes(self) -> bytes:
        """As it lies on disk; the same for the same."""
        data = {"schema": SCHEMA, **asdict(self)}
        return json.dumps(data, separators=(",", ":")).encode("ascii") + b"\n"

    @classmethod
    def of_bytes(cls, data: bytes) -> Behaved:
        """Read it back.

        Raises:
            ValueError: that is none.
        """
        try:
            found = strict_json.loads(data[:_MOST_BYTES].decode("ascii"))
            if not isinstance(found, dict) or found.get("schema") != SCHEMA:
                raise ValueError(f"is no {NAME}")
            made = cls(
                tuple(Source(*_of(each, str, str)) for each in found["files"]),
                tuple(Asked(*_of(each, int, int)) for each in found["commands"]),
                tuple(_of(found["path"], *[int] * len(found["path"]))),
                *_of([found["left_out"]], int),
            )
        except (KeyError, TypeError, RecursionError) as error:
            raise ValueError(f"is no {NAME}: {error}") from None
        if len(made.path) not in (0, 2 * POINTS):
            raise ValueError(f"is no {NAME}: a path of {len(made.path)} numbers")
        return made


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
    files = (Source(each.name, hashlib.sha256(each.data).hexdigest()) for each in kept(source))
    return Behaved(tuple(files), commands, path, left_out + too_many).to_bytes()


def read(folder: Path) -> Behaved | None:
    """That of a hand-in's folder; None where there is none that can be used."""
    try:
        return Behaved.of_bytes(read_own(folder / NAME, _MOST_BYTES))
    except (OSError, ValueError):
        return None


def _run(nominal: Recording | None) -> tuple[tuple[Asked, ...], tuple[int, ...], int]:
    """Its commands, its path, and how many commands were left out."""
    if nominal is None:
        return (), (), 0
    done = load_scene(nominal.scene).behaviour(nominal.trace)
    begin = done.commands[0].tick if done.commands else 0
    taken = islice(done.commands, MOST_COMMANDS)
    commands = tuple(Asked(each.tick - begin, _hash(each)) for each in taken)
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


def _of(values: Any, *kinds: type) -> list[Any]:
    """A list of values of these types, and no others.

    Raises:
        ValueError: it is not.
    """
    if not isinstance(values, list) or [type(value) for value in values] != list(kinds):
        raise ValueError(f"is no {NAME}: found {values!s:.60}")
    return values
