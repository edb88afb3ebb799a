"""The error file `turtlesim-grader/error/v1`: what stands in place of a result where there is none.

Its JSON Schema is `error.schema.json` beside this module.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Self

from grader import files
from grader.errors import GraderError, Whose
from grader.language import stored
from grader.result import json_file
from grader.text import plain_phrase

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
    message: str
    max_score: float | None = None

    @classmethod
    def of(cls, error: GraderError, max_score: float | None) -> Self:
        """What an exception says."""
        return cls(error.whose, plain_phrase(error.message), max_score)

    def to_json(self) -> dict[str, Any]:
        """The error as its file holds it."""
        phrases = stored.phrases_in(self)
        return {
            "schema": SCHEMA,
            **asdict(self),
            **({"phrases": phrases} if phrases else {}),
        }

    @classmethod
    def from_json(cls, data: Any) -> Self:
        """The error that a file holds.

        Raises:
            ValueError: it does not follow the schema.
        """
        json_file.validate(data, "error", SCHEMA)
        told = {name: data[name] for name in ("whose", "message", "max_score")}
        found = json_file.typed(cls, told)
        return stored.restored(found, data.get("phrases", {}))

    def write(self, path: Path) -> None:
        """Write the error file.

        Raises:
            UsageError: it cannot be written.
        """
        files.write(path, json_file.text(self.to_json()))
