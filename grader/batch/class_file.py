"""What the folder of a class is for: class.json. Only what fits together comes into one folder."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Self

from grader import files
from grader.errors import UsageError
from grader.exercise.loading import Exercise
from grader.recording.recording import Clock
from grader.result import json_file

FAMILY = "turtlesim-grader/class/"
SCHEMA = f"{FAMILY}v1"
CLASS = "class.json"
_NAMED = {
    "exercise": "the exercise",
    "exercise_sha256": "the exercise's rubric",
    "time": "the clock (--time)",
    "seed": "the seed (--seed)",
    "shard": "the shard (--shard)",
}


@dataclass(frozen=True)
class ClassFile:
    """By what everything in the folder of a class was made.

    Attributes:
        exercise: its name.
        exercise_sha256: of all that it judges by.
        time: the clock that submissions lived by.
        seed: chose where the varied runs start; None: the exercise's own.
        shard: "I/N" where the folder holds one of several parts of a class; '' for all of it.
    """

    exercise: str
    exercise_sha256: str
    time: Clock = "virtual"
    seed: int | None = None
    shard: str = ""

    @classmethod
    def of(cls, exercise: Exercise, time: Clock, seed: int | None, shard: str = "") -> Self:
        """Of a call."""
        return cls(exercise.name, exercise.sha256, time, seed, shard)

    def put(self, out: Path) -> None:
        """Write it.

        Raises:
            UsageError: it cannot be written.
        """
        text = json_file.text({"schema": SCHEMA, **asdict(self)})
        files.put(out / CLASS, text.encode())

    @classmethod
    def read(cls, out: Path) -> Self:
        """What the folder of a class is for.

        Raises:
            UsageError: it is not the folder of a class.
        """
        path = out / CLASS
        if not path.is_file():
            raise UsageError(f"{out} is no folder of a class: there is no {CLASS} in it")
        found: Self = json_file.made(cls._from_json, path, json_file.read(path))
        return found

    def difference(self, other: Self) -> str:
        """What of two does not fit together: '' if they do."""
        for name, told in _NAMED.items():
            mine, others = getattr(self, name), getattr(other, name)
            if mine != others:
                return f"{told}: there {_shown(others)}, here {_shown(mine)}"
        return ""

    @classmethod
    def _from_json(cls, data: Mapping[str, Any]) -> Self:
        if not isinstance(data, dict) or data.get("schema") != SCHEMA:
            raise ValueError(f"is no class: expected the schema {SCHEMA}")
        try:
            return cls(**{name: value for name, value in data.items() if name != "schema"})
        except TypeError as error:
            raise ValueError(f"is damaged: {error}") from None


def _shown(value: object) -> str:
    return value[:12] if isinstance(value, str) and value else "none" if not value else str(value)
