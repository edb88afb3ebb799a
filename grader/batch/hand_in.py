"""What one student, or one group, handed in, as `grader.batch.find` finds it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from datetime import datetime
from pathlib import Path
from typing import Any, Self

from grader.language.phrase import say
from grader.result import json_file


@dataclass(frozen=True)
class Person:
    """Somebody of a class.

    Attributes:
        id: as the course system has it; unique within a class.
        name: as people read it; '' where nobody has said it.
        columns: what else the roster or the export says of him, by the names of its columns: what a
            course system's import asks for.
    """

    id: str
    name: str = ""
    columns: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class HandIn:
    """The newest attempt of a student or a group, or that there is none.

    Attributes:
        id: names its folder in the output: made of letters, digits and `._@+-` alone, unique within
            a class whatever the file system does with capital letters.
        people: who gets its points; one, or the members of a group.
        path: the file or the folder that is graded; None where nothing can be.
        filename: what it was called before the export gave it another name.
        attempt: counts from 1.
        at: when it was handed in, with its time zone; None where the export does not tell.
        problem: why there is nothing to grade, as a sentence for teacher and student.
    """

    id: str
    people: tuple[Person, ...]
    path: Path | None = None
    filename: str = ""
    attempt: int = 1
    at: datetime | None = None
    problem: str = ""

    @property
    def name(self) -> str:
        """For people: the names, else the ids."""
        return ", ".join(person.name or person.id for person in self.people)

    def to_json(self) -> dict[str, Any]:
        """As files hold it; without its path, which is that of one machine."""
        return {
            "id": self.id,
            "people": [asdict(person) for person in self.people],
            "filename": self.filename,
            "attempt": self.attempt,
            "at": None if self.at is None else self.at.isoformat(),
            "problem": self.problem,
        }

    @classmethod
    def from_json(cls, data: Mapping[str, Any]) -> Self:
        """What `to_json` has written.

        Raises:
            ValueError: it is something else; so may be KeyError, TypeError and AttributeError.
        """
        at = data["at"]
        when = None if at is None else datetime.fromisoformat(at)
        people = tuple(json_file.typed(Person(**person)) for person in data["people"])
        found = json_file.typed(cls(**{**data, "people": people, "at": when}))
        if when is not None and when.utcoffset() is None:
            raise ValueError(say("is damaged: its {name} is {value}", name="at", value=str(at)))
        return found
