"""class.json: what a class's folder is for, so that only gradings that fit together share it.

All hand-ins of a class are confined at one level, which makes them comparable, and is safe. It is
the best level on the machine where the class is begun; class.json holds it, and it applies to all
that is graded into that folder later.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any, Self

from grader import Exercise, UsageError, errors
from grader.exercise import json_file
from grader.recording import Clock
from grader.run import levels
from grader.system import files
from grader.text import Message, msg

SCHEMA = "turtlesim-grader/class/v2"
CLASS = "class.json"
#: Characters of a value in a message: enough of a hash to distinguish two.
MOST_SHOWN = 24
#: The fields that may change when everything is graded anew, and what to do about them.
MACHINE = {"grader", "ros", "python", "isolation"}
ANOTHER_MACHINE = msg("Give another --out, or have everything graded by this one: --again all.")
_NAMED = {
    "exercise": msg("the exercise"),
    "exercise_sha256": msg("the exercise's rubric"),
    "time": msg("the clock (--time)"),
    "seed": msg("the seed (--seed)"),
    "seed_file": msg("the secret (--seed-file)"),
    "pseudonyms": msg("the key of the pseudonyms (--pseudonyms)"),
    "start": msg("what is started"),
    "grader": msg("the grader's version"),
    "ros": msg("the version of rclpy and the ROS release"),
    "python": msg("the version of Python"),
    "isolation": msg("the isolation"),
}


@dataclass(frozen=True)
class ClassFile:
    """What everything in the folder of a class was graded with.

    Attributes:
        exercise: its name.
        exercise_sha256: the hash of all that it judges by.
        time: the clock of the submissions.
        seed: chose where the varied runs start; None: the exercise's own.
        seed_file: shows which secret gave each hand-in its seed; '' for none.
        pseudonyms: shows which key gave the students their pseudonyms; '' where they have names.
        start: the option that says what is started of each; '' where the grader finds it.
        grader, ros, python: versions.
        hand_ins: how many there will be when the class is finished; 0 while that is unknown.
        isolation: the level at which all are run; '' before the first run, or where there is none.
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
    seed_file: str = ""
    pseudonyms: str = ""
    start: str = ""

    def put(self, out: Path) -> None:
        """Write class.json."""
        text = json_file.text({"schema": SCHEMA, **asdict(self)})
        files.put(out / CLASS, text.encode())

    @classmethod
    def read(cls, out: Path) -> Self:
        """Read the class.json of a folder."""
        path = out / CLASS
        if not path.is_file():
            raise UsageError(
                "{out} is no folder of a class: there is no {file} in it", out=str(out), file=CLASS
            )
        return json_file.made(cls._from_json, path, json_file.read(path, is_ours=True))

    def check_exercise(self, out: Path, exercise: Exercise, path: str) -> None:
        """Refuse another exercise than that of the class; `path` is what the user called it."""
        if exercise.name != self.exercise:
            raise UsageError(
                "{out} was graded for the exercise {then!r}, and {path} is one of {now!r}: give an "
                "edited copy of that exercise's exercise.yaml",
                out=str(out),
                then=self.exercise,
                path=path,
                now=exercise.name,
            )

    def differences(self, other: Self) -> dict[str, Message]:
        """Return what differs between two class files: field -> a sentence."""
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
        if found.isolation not in ("", *levels.LEVELS):
            raise ValueError(msg("is damaged: its isolation is {told}", told=repr(found.isolation)))
        return found


def _shown(value: object) -> str | Message:
    # no sentence, whatever it reads like: `real` is what one writes after --time
    return str(value)[:MOST_SHOWN] if value else msg("none")


def begun_at(out: Path, again: str = "", least: str = "") -> str:
    """Return the level at which a class goes on; '' where it is new, or all is done anew.

    Where class.json has a lower level than `least`, return `least`: the difference is then refused.
    """
    if not (out / CLASS).is_file() or again == "all":
        return ""
    level = ClassFile.read(out).isolation
    return least if level and least and is_less(level, least) else level


def note(out: Path, level: str) -> None:
    """Record in class.json at which level a class is graded."""
    found = ClassFile.read(out)
    if found.isolation != level:
        replace(found, isolation=level).put(out)


def on_this_machine(level: str) -> str:
    """Return the level at which this machine grades a class: the recorded one, else the best.

    Raises:
        UsageError: this machine does not offer it.
        NotNow: it may offer it later.
    """
    try:
        return levels.here(level).level
    except errors.NotOffered as error:
        raise UsageError(
            "{why}. To get it: {advice}. {or_else}",
            why=error.message,
            advice=levels.ADVICE[level],
            or_else=ANOTHER_MACHINE,
        ) from None


def is_less(level: str, than: str) -> bool:
    """Whether a level of isolation protects less well than another."""
    return levels.LEVELS.index(level) > levels.LEVELS.index(than)
