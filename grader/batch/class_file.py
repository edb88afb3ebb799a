"""What the folder of a class is for: class.json. Only what fits together comes into one folder.

All of a class are confined at one level, which makes two hand-ins comparable, and is safe. It is
the best that there is where the class is begun, stands in class.json, and holds for all that is
graded into that folder later.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any, Self

from grader import files, versions
from grader.errors import NotOffered, UsageError
from grader.exercise.exercise import Exercise
from grader.message import Message, Text, msg
from grader.recording.recording import Clock
from grader.result import json_file
from grader.run.processes import levels
from grader.run.processes.levels import ADVICE, LEVELS

SCHEMA = "turtlesim-grader/class/v2"
CLASS = "class.json"
#: Characters of a value in a message: enough of a hash to tell two apart.
MOST_SHOWN = 24
#: What may be another when everything is graded anew.
MACHINE = {"grader", "ros", "python", "isolation"}
_NAMED = {
    "exercise": msg("the exercise"),
    "exercise_sha256": msg("the exercise's rubric"),
    "time": msg("the clock (--time)"),
    "seed": msg("the seed (--seed)"),
    "grader": msg("the grader's version"),
    "ros": msg("the version of rclpy and the ROS release"),
    "python": msg("the version of Python"),
    "isolation": msg("the isolation"),
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
    def of(cls, exercise: Exercise, time: Clock, seed: int | None, isolation: str = "") -> Self:
        """Of a call."""
        ros = f"rclpy {versions.rclpy()} {versions.ros_distro()}".strip()
        made_by = (versions.grader(), ros, versions.python())
        return cls(exercise.name, exercise.sha256, time, seed, *made_by, isolation=isolation)

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
                "{out} is no folder of a class: there is no {file} in it", out=str(out), file=CLASS
            )
        found: Self = json_file.made(cls._from_json, path, json_file.read(path, is_ours=True))
        return found

    def differences(self, other: Self) -> dict[str, Message]:
        """What of two does not fit together: by its field, in words."""
        pairs = {name: (getattr(self, name), getattr(other, name)) for name in _NAMED}
        return {
            name: msg(
                "{what}: there {others}, here {mine}",
                what=_NAMED[name],
                others=_shown(others),
                mine=_shown(mine),
            )
            for name, (mine, others) in pairs.items()
            if mine != others and (name != "isolation" or (mine and others))
        }

    @classmethod
    def _from_json(cls, data: Mapping[str, Any]) -> Self:
        if not isinstance(data, dict) or data.get("schema") != SCHEMA:
            raise ValueError(msg("is no class: expected the schema {schema}", schema=SCHEMA))
        found = json_file.typed(cls, {n: value for n, value in data.items() if n != "schema"})
        if found.isolation not in ("", *LEVELS):
            told = f"{found.isolation!r}"
            raise ValueError(msg("is damaged: its isolation is {told}", told=told))
        return found


def _shown(value: object) -> Text:
    # no sentence, whatever it reads like: `real` is what one writes after --time
    return str(value)[:MOST_SHOWN] if value else msg("none")


def begun_at(out: Path, again: str = "", least: str = "") -> str:
    """The level at which a class goes on; '' where it is new, or everything is done anew.

    Where that is less than `least`, the latter, which is not what class.json says.
    """
    if not (out / CLASS).is_file() or again == "all":
        return ""
    level = ClassFile.read(out).isolation
    return least if level and least and _is_less(level, least) else level


def note(out: Path, level: str) -> None:
    """Write down at which level a class is graded."""
    found = ClassFile.read(out)
    if found.isolation != level:
        replace(found, isolation=level).put(out)


def on_this_machine(level: str) -> str:
    """The level at which this machine grades all of a class: that of its beginning, or the best.

    Raises:
        UsageError: that is not to be had here.
        NotNow: it may be, but not now.
    """
    try:
        return levels.here(level).level
    except NotOffered as error:
        raise UsageError(
            "{why}. To get it: {advice}. Or give another --out, or have everything graded by "
            "this one: --again all.",
            why=error.message,
            advice=ADVICE[level],
        ) from None


@dataclass
class OfCluster:
    """The level at which the workers of a cluster grade a class.

    Attributes:
        level: '' until it is chosen.
        least: the lowest that may be; '' for any.
        settle: is told what was chosen.
    """

    level: str = ""
    least: str = ""
    settle: Callable[[str], None] = lambda _: None

    def choose(self, offered: Iterable[str]) -> None:
        """Unless that is done, take the best that workers offer; without any, that of this machine.

        Raises:
            UsageError: it is too low.
        """
        if self.level:
            return
        there = set(filter(None, offered)) or {levels.here().level, self.least}
        self.level = next((level for level in LEVELS if level in there), "")
        if self.least and (not self.level or _is_less(self.level, self.least)):
            raise self.none_offers(self.least)
        self.settle(self.level)

    def none_offers(self, level: str) -> UsageError:
        """Why a cluster cannot grade at a level."""
        return UsageError(
            "no worker of the cluster offers isolation by {level}. To get it: {advice}.",
            level=level,
            advice=ADVICE[level],
        )


def _is_less(level: str, than: str) -> bool:
    return LEVELS.index(level) > LEVELS.index(than)
