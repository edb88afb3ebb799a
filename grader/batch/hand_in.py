"""What one student, or one group, handed in, as `grader.batch.find` finds it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import datetime
from pathlib import Path

from grader.strict_json import UNSTORED


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
        path: the file or the folder that is graded; None where nothing can be. It is that of one
            machine, and in no file.
        filename: what it was called before the export gave it another name.
        attempt: counts from 1.
        at: when it was handed in, with its time zone; None where the export does not tell.
        problem: why there is nothing to grade, as a sentence for teacher and student.
    """

    id: str
    people: tuple[Person, ...]
    path: Path | None = field(default=None, metadata=UNSTORED)
    filename: str = ""
    attempt: int = 1
    at: datetime | None = None
    problem: str = ""

    @property
    def name(self) -> str:
        """For people: the names, else the ids."""
        return ", ".join(person.name or person.id for person in self.people)
