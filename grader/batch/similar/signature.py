"""What of a hand-in is compared: DIR/submissions/ID/similar.json, made once, when it is graded.

    schema    which form this is
    files     [name, sha256, lines, why it is not compared or ""]
    prints    [hash, file, first line, last line] of each fingerprint of the sources
    commands  [tick, hash] of what it asked for in its nominal run, from the first on
    path      x, y [mm] of points at equal steps along its way, from where it began
    left_out  how many files and commands were too much

What was handed in is parsed, never imported, and that in a copy of this process with limits.
"""

from __future__ import annotations

import hashlib
import json
from dataclasses import asdict, dataclass
from itertools import islice
from pathlib import Path
from typing import Any, Final, NamedTuple

import numpy as np

from grader import strict_json
from grader.batch.similar import fingerprints
from grader.batch.similar.fingerprints import Fingerprint
from grader.batch.similar.sources import File, kept
from grader.batch.similar.syntax import units
from grader.files import read_own
from grader.limited import Copy, LimitHit, Limits
from grader.recording.recording import Recording
from grader.scenes import load_scene
from grader.scenes.scene import Command
from grader.submission.python_source import parse

SCHEMA: Final = "turtlesim-grader/similar/v1"
NAME: Final = "similar.json"
MOST_PRINTS: Final = 5000
MOST_COMMANDS: Final = 1000
#: Points of a path.
POINTS: Final = 64
#: A path that is shorter is none [m].
SHORTEST_M: Final = 0.5
_FARTHEST_MM: Final = 10_000_000
#: Of one file; an ordinary one takes 10 ms. After so many that hit them no more are tried.
MOST_HITS: Final = 2
PARSING: Final = Limits(cpu_s=10.0, wall_s=60.0, memory_bytes=512 * 2**20, answer_bytes=2**22)
_MOST_BYTES: Final = 2**22


class Source(NamedTuple):
    """A file: its name, hash, number of lines, and why it is not compared ('' if it is)."""

    name: str
    sha256: str
    lines: int
    problem: str


class Print(NamedTuple):
    """A fingerprint of a source, and where: the number of the file, first and last line."""

    hash: int
    file: int
    first: int
    last: int


class Asked(NamedTuple):
    """A command: how many ticks after the first one, and a hash of what it asks for."""

    tick: int
    hash: int


@dataclass(frozen=True)
class Signature:
    """What of a hand-in is compared; see the module."""

    files: tuple[Source, ...] = ()
    prints: tuple[Print, ...] = ()
    commands: tuple[Asked, ...] = ()
    path: tuple[int, ...] = ()
    left_out: int = 0

    def to_bytes(self) -> bytes:
        """As it lies on disk; the same for the same."""
        data = {"schema": SCHEMA, **asdict(self)}
        return json.dumps(data, separators=(",", ":")).encode("ascii") + b"\n"

    @classmethod
    def of_bytes(cls, data: bytes) -> Signature:
        """Read it back.

        Raises:
            ValueError: that is none.
        """
        try:
            found = strict_json.loads(data[:_MOST_BYTES].decode("ascii"))
            if not isinstance(found, dict) or found.get("schema") != SCHEMA:
                raise ValueError(f"expected the schema {SCHEMA}")
            files = tuple(Source(*_of(each, str, str, int, str)) for each in found["files"])
            made = cls(
                files,
                tuple(Print(*_of(each, int, int, int, int)) for each in found["prints"]),
                tuple(Asked(*_of(each, int, int)) for each in found["commands"]),
                tuple(_of(found["path"], *[int] * len(found["path"]))),
                *_of([found["left_out"]], int),
            )
        except (KeyError, TypeError, RecursionError) as error:
            raise ValueError(f"is no {NAME}: {error}") from None
        if len(made.path) not in (0, 2 * POINTS):
            raise ValueError(f"is no {NAME}: a path of {len(made.path)} numbers")
        if any(not 0 <= each.file < len(files) for each in made.prints):
            raise ValueError(f"is no {NAME}: a fingerprint of no file")
        return made


def signature(source: Path, nominal: Recording | None, left_out: int = 0) -> bytes:
    """What of a hand-in is compared, as it comes to lie in its folder.

    Args:
        source: the folder with its sources, from `sources.keep`.
        nominal: its nominal run; None where there was none.
        left_out: what `sources.keep` returned.

    Raises:
        OSError: the sources cannot be read.
    """
    files = kept(source)
    parsed = _parsed(files)
    prints = [Print(p.hash, n, p.first, p.last) for n, (each, _) in enumerate(parsed) for p in each]
    commands, path, too_many = _behaviour(nominal)
    left_out += too_many + max(0, len(prints) - MOST_PRINTS)
    listed = tuple(
        Source(file.name, hashlib.sha256(file.data).hexdigest(), file.data.count(b"\n") + 1, why)
        for file, (_, why) in zip(files, parsed, strict=True)
    )
    made = Signature(listed, tuple(prints[:MOST_PRINTS]), commands, path, left_out)
    return made.to_bytes()


def read(folder: Path) -> Signature | None:
    """That of a hand-in's folder; None where there is none that can be used."""
    try:
        return Signature.of_bytes(read_own(folder / NAME, _MOST_BYTES))
    except (OSError, ValueError):
        return None


# Sources --------------------------------------------------------------------------------------


def _parsed(files: list[File]) -> list[tuple[list[Fingerprint], str]]:
    """Of each file its fingerprints, or why it has none; each within limits."""
    modules = {part for file in files for part in file.name.removesuffix(".py").split("/")}

    def answer(number: int) -> bytes:
        try:
            tree = parse(files[number].data, files[number].name)
        except SyntaxError as error:
            return json.dumps({"why": f"does not parse, line {error.lineno or '?'}"}).encode()
        found = fingerprints.of_units(units(tree, modules))
        return json.dumps({"prints": found[: MOST_PRINTS + 1]}).encode()

    found: list[tuple[list[Fingerprint], str]] = []
    hits = 0
    with Copy(answer, PARSING) as copy:
        for number in range(len(files)):
            if hits >= MOST_HITS:
                found.append(([], "not tried, since others took too much"))
                continue
            try:
                found.append(_said(copy.ask(number)))
            except LimitHit as hit:
                hits += 1
                found.append(([], f"parsing it {hit}"))
    return found


def _said(answer: bytes) -> tuple[list[Fingerprint], str]:
    said = strict_json.loads(answer.decode("ascii"))
    if "why" in said:
        return [], str(said["why"])
    return [Fingerprint(*_of(each, int, int, int)) for each in said["prints"]], ""


# Behaviour ------------------------------------------------------------------------------------


def _behaviour(nominal: Recording | None) -> tuple[tuple[Asked, ...], tuple[int, ...], int]:
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
    return fingerprints.hash_of((command.name, *values))


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
