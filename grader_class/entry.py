"""A graded hand-in: the folder DIR/submissions/ID/ of a class.

    entry.json     an `Entry`, except its result
    result.json    report.html  canvas.png  output.txt  recording/      where there is a result

`entry.json` is written last: a folder without it is not finished, and made anew.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from datetime import datetime
from functools import cached_property
from pathlib import Path
from typing import Any, Literal, Self

from grader import Result, UsageError, Verdict
from grader.exercise import json_file
from grader.system import files, strict_json
from grader.text import NOTHING, Message, msg


@dataclass(frozen=True)
class Person:
    """A member of a class.

    Attributes:
        id: that of the course system; unique within a class.
        name: as people read it; '' where it is unknown.
        columns: the other columns of the roster or the export: what a course system's import asks
            for.
    """

    id: str
    name: str = ""
    columns: Mapping[str, str] = field(default_factory=dict)

    def column(self, *names: str) -> str:
        """Return the first of these cells that is not empty, or ''; names are of any case."""
        by_name = {name.strip().casefold(): value for name, value in self.columns.items()}
        cells = (by_name.get(name.casefold(), "").strip() for name in names)
        return next(filter(None, cells), "")


@dataclass(frozen=True)
class HandIn:
    """The newest attempt of a student or a group; also of one who handed in nothing.

    Attributes:
        id: names its folder in the output: made of letters, digits and `._@+-` alone, unique within
            a class whatever the file system does with capital letters.
        people: the student, or the members of a group: they get the points.
        path: the file or the folder that is graded; None where nothing can be. It is a path on one
            machine, and in no file.
        filename: the name that it is graded by: its original one, before the export renamed it; ''
            for that of `path`.
        attempt: counts from 1.
        at: when it was handed in, with its time zone; None where the export does not contain it.
        problem: why there is nothing to grade, as a sentence for teacher and student.
        is_marked_late: whether the export says that it is late.
    """

    id: str
    people: tuple[Person, ...]
    path: Path | None = field(default=None, metadata=strict_json.UNSTORED)
    filename: str = ""
    attempt: int = 1
    at: datetime | None = None
    problem: Message = NOTHING
    is_marked_late: bool = field(default=False, metadata=strict_json.SPARSE)

    @property
    def name(self) -> str:
        """The names of the people, else their ids."""
        return ", ".join(person.name or person.id for person in self.people)

    @property
    def known_as(self) -> str:
        """The ids of the people as they know them, in any script."""
        return ", ".join(person.id for person in self.people) or self.id


def comparable(text: str) -> str:
    """Return an id as ids are compared: one character a letter, without case and outer blanks."""
    return unicodedata.normalize("NFC", text).strip().casefold()


def id_of(ids: Sequence[str]) -> str:
    """Return the id of the hand-in of a student or a group, before it is a name of a folder."""
    whole = "+".join(ids)
    if len(whole) <= MAX_ID:
        return whole
    return f"{ids[0]}+{len(ids) - 1}" if len(ids) > 1 else ids[0]


#: Of a hand-in's id [characters]: leaves room for the paths below the folder.
MAX_ID = 80
SCHEMA = "turtlesim-grader/entry/v1"
ENTRY = "entry.json"
SUBMISSIONS = "submissions"

#: judged: there is a result. unusable: the submission cannot be started, which is the student's
#: fault and worth 0 points. nothing: nothing was handed in. failed: the grader failed.
State = Literal["judged", "unusable", "nothing", "failed"]


@dataclass(frozen=True)
class Entry:
    """One hand-in, graded.

    Attributes:
        hand_in: what was graded, without its path.
        state: see `State`.
        key: of its run in the store; '' where there was none. See `grader_class.store`.
        message: why there is no result; '' where there is one.
        max_score: what the exercise is worth [points].
        exercise_sha256: the hash of the exercise that it was judged by.
        result: the verdicts; None where `state` is not "judged".
        folder: the folder of its files.
    """

    hand_in: HandIn
    state: State
    max_score: float
    key: str = ""
    message: Message = NOTHING
    exercise_sha256: str = ""
    result: Result | None = field(default=None, metadata=strict_json.UNSTORED)
    folder: Path = field(default=Path(), metadata=strict_json.UNSTORED)

    @property
    def id(self) -> str:
        return self.hand_in.id

    @property
    def score(self) -> float | None:
        """The points for the gradebook; None where the grader failed, which costs nobody points."""
        if self.state == "failed":
            return None
        return 0.0 if self.result is None else self.result.final

    @cached_property
    def verdicts(self) -> Mapping[str, Verdict]:
        """The verdicts of the result by check; empty without a result."""
        return {} if self.result is None else {each.check: each for each in self.result.verdicts}

    def put(self) -> None:
        """Write entry.json; result.json must be there already."""
        data = {"schema": SCHEMA, **json_file.with_phrases(self)}
        files.put(self.folder / ENTRY, json_file.text(data).encode("utf-8"))

    @classmethod
    def read(cls, folder: Path) -> Self:
        """Read the folder of a hand-in."""
        path = folder / ENTRY
        entry: Self = json_file.made(cls._from_json, path, json_file.read(path, is_ours=True))
        if entry.id != folder.name:
            raise UsageError("{path} is that of another hand-in", path=str(path))
        if entry.state == "judged":
            path = folder / Result.FILE
            data = json_file.read(path, is_ours=True)
            entry = replace(entry, result=json_file.made(Result.from_json, path, data))
            json_file.made(entry._check_result, path, entry.result)
        return replace(entry, folder=folder)

    def _check_result(self, result: Result) -> None:
        """Compare a result with entry.json."""
        submitted, origin = result.handed_in, result.provenance
        if submitted is not None and submitted.id != self.id:
            raise ValueError(msg("is that of another hand-in"))
        is_same = origin is None or origin.judged.exercise_sha256 == self.exercise_sha256
        if not is_same or abs(result.max_score - self.max_score) > Result.ROUNDING:
            raise ValueError(msg("is that of another exercise"))

    @classmethod
    def _from_json(cls, data: Mapping[str, Any]) -> Self:
        if not isinstance(data, dict) or data.get("schema") != SCHEMA:
            raise ValueError(
                msg("is no entry of a class: expected the schema {schema}", schema=SCHEMA)
            )
        fields = {name: data[name] for name in data if name not in ("schema", "phrases")}
        entry = json_file.typed(cls, fields, data.get("phrases"))
        if not re.fullmatch("[0-9a-f]*", entry.key):  # it names a folder
            raise ValueError(msg("is damaged: its {name} is {value}", name="key", value=entry.key))
        return entry


def entries(out: Path, part: str = SUBMISSIONS) -> list[Entry]:
    """Read all finished entries in a part of a class's folder, sorted by id."""
    found = []
    for folder in sorted((out / part).glob("*/")):
        try:
            found.append(Entry.read(folder))
        except UsageError:
            continue  # unfinished or damaged: the next `grader batch` makes it anew
    return found
