"""What the folder of a class is for: class.json. Only what fits together comes into one folder."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Self

from grader import files, versions
from grader.errors import UsageError
from grader.exercise.exercise import Exercise
from grader.language.phrase import Phrase, say, say_many
from grader.recording.recording import Clock
from grader.result import json_file
from grader.run.processes.levels import LEVELS

FAMILY = "turtlesim-grader/class/"
SCHEMA = f"{FAMILY}v2"
CLASS = "class.json"
#: Characters of a value in a message: enough of a hash to tell two apart.
MOST_SHOWN = 24
#: What may be another when everything is graded anew.
MACHINE = {"grader", "ros", "python", "isolation"}
_NAMED = {
    "exercise": say("the exercise"),
    "exercise_sha256": say("the exercise's rubric"),
    "time": say("the clock (--time)"),
    "seed": say("the seed (--seed)"),
    "grader": say("the grader's version"),
    "ros": say("the version of rclpy and the ROS release"),
    "python": say("the version of Python"),
    "isolation": say("the isolation"),
}


@dataclass(frozen=True)
class ClassFile:
    """By what everything in the folder of a class was made.

    Attributes:
        exercise: its name.
        exercise_sha256: of all that it judges by.
        time: the clock that submissions lived by.
        seed: chose where the varied runs start; None: the exercise's own.
        grader, ros, python: versions.
        hand_ins: how many there will be when it is finished; 0 where nobody has said it yet.
        isolation: the level at which all are run; '' where none has been yet, or there is none.
    """

    exercise: str
    exercise_sha256: str
    time: Clock = "virtual"
    seed: int | None = None
    grader: str = ""
    ros: str = ""
    python: str = ""
    hand_ins: int = 0
    isolation: str = ""

    @classmethod
    def of(cls, exercise: Exercise, time: Clock, seed: int | None) -> Self:
        """Of a call."""
        ros = f"rclpy {versions.rclpy()} {versions.ros_distro()}".strip()
        ours, python = versions.grader(), versions.python()
        return cls(exercise.name, exercise.sha256, time, seed, ours, ros, python)

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
            raise UsageError(
                say(
                    "{out} is no folder of a class: there is no {file} in it",
                    out=str(out),
                    file=CLASS,
                )
            )
        found: Self = json_file.made(cls._from_json, path, json_file.read(path, is_ours=True))
        return found

    def differences(self, other: Self) -> dict[str, str]:
        """What of two does not fit together: by its field, in words."""
        pairs = {name: (getattr(self, name), getattr(other, name)) for name in _NAMED}
        return {
            name: say(
                "{what}: there {others}, here {mine}",
                what=_NAMED[name],
                others=_shown(others),
                mine=_shown(mine),
            )
            for name, (mine, others) in pairs.items()
            if mine != others and (name != "isolation" or (mine and others))
        }

    def unfinished(self, out: Path, graded: int) -> list[str]:
        """What to say of a folder in which so many are graded; nothing where all are."""
        if graded >= self.hand_ins:
            return []
        return [
            say_many(
                "{part} is not finished: {graded} of {n:,} hand-in.",
                "{part} is not finished: {graded} of {n:,} hand-ins.",
                self.hand_ins,
                part=str(out),
                graded=graded,
            )
        ]

    @classmethod
    def _from_json(cls, data: Mapping[str, Any]) -> Self:
        if not isinstance(data, dict) or data.get("schema") != SCHEMA:
            raise ValueError(say("is no class: expected the schema {schema}", schema=SCHEMA))
        found = json_file.typed(cls, {n: value for n, value in data.items() if n != "schema"})
        if found.isolation not in ("", *LEVELS):
            told = f"{found.isolation!r}"
            raise ValueError(say("is damaged: its isolation is {told}", told=told))
        return found


def _shown(value: object) -> str:
    # no sentence, whatever it reads like: `real` is what one writes after --time
    return Phrase(str(value)[:MOST_SHOWN]) if value else say("none")
