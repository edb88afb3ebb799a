"""The error file `turtlesim-grader/error/v1`, instead of a result where there is none.

Its JSON Schema is `error.schema.json` beside this module.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any, Self

from grader.errors import GraderError, Whose
from grader.exercise.result import json_file
from grader.system import files
from grader.text.message import Message
from grader.text.strings import plain

#: What the schemas of all versions begin with.
FAMILY = "turtlesim-grader/error/"
SCHEMA = f"{FAMILY}v1"


@dataclass(frozen=True)
class ErrorResult:
    """Why there is no result.

    Attributes:
        whose: whose turn it is. The submission has earned nothing where it is the student's;
            otherwise nothing is known about it.
        message: what was found, what was expected, what to do.
        max_score: the exercise's points; None where it could not be loaded, or was not asked for.
    """

    whose: Whose
    message: Message
    max_score: float | None = None

    @classmethod
    def of(cls, error: GraderError, max_score: float | None) -> Self:
        """Make the error of an exception."""
        return cls(error.whose, error.message.map_texts(plain), max_score)

    def to_json(self) -> dict[str, Any]:
        """Return the error as its file has it."""
        return {"schema": SCHEMA, **json_file.with_phrases(self)}

    @classmethod
    def from_json(cls, data: Any) -> Self:
        """Parse the error of a file."""
        json_file.validate(data, "error", SCHEMA)
        values = {name: data[name] for name in ("whose", "message", "max_score")}
        return json_file.typed(cls, values, data.get("phrases"))

    def write(self, path: Path) -> None:
        """Write the error file."""
        files.write(path, json_file.text(self.to_json()))
