"""Reads and writes the files of this package: JSON that follows a schema beside the module.

The error file `turtlesim-grader/error/v1` takes the place of a result where there is none.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Self

from grader.errors import GraderError, UsageError, Whose
from grader.system import files, strict_json
from grader.system.files import read_ours
from grader.system.strict_json import Made
from grader.text.message import Message, joined, msg
from grader.text.strings import plain

#: No file of ours is longer [bytes].
MOST_BYTES = 2**26
#: What the schemas of all versions of the error file begin with.
ERROR_FAMILY = "turtlesim-grader/error/"
ERROR_SCHEMA = f"{ERROR_FAMILY}v1"


def validate(data: object, name: str, version: str) -> None:
    """Validate data by a schema."""
    found = data.get("schema") if isinstance(data, dict) else None
    family = version.rpartition("/")[0]
    if isinstance(found, str) and found != version and found.startswith(f"{family}/"):
        raise ValueError(f"is no {name} of {version}: it is of another version, {found:.60}")
    error = strict_json.first_error("grader.exercise.result", name, data)
    if error is not None:
        raise ValueError(f"is no {name} of {version}: {error.message}")


def text(data: dict[str, Any]) -> str:
    """Return the text of a file."""
    return json.dumps(data, indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def read(path: Path, *, is_ours: bool = False) -> Any:
    """Read JSON.

    Args:
        is_ours: whether the file has a name of the grader in a folder for results: see `read_ours`.
    """
    try:
        # utf-8-sig: some editors put a mark at the start
        data = read_ours(path, MOST_BYTES) if is_ours else path.read_bytes()
        return strict_json.loads(data.decode("utf-8-sig"))
    except OSError as error:
        raise UsageError(
            "cannot read the result {path}: {why}", path=path, why=error.strerror
        ) from None
    except (ValueError, RecursionError) as error:
        raise UsageError("{path} is not JSON: {why}", path=path, why=str(error)) from None


def with_phrases(value: Any) -> dict[str, Any]:
    """Return a dataclass as a file has it: its messages in English.

    Beside them, by these texts, are the serialised messages, for other languages.
    """
    phrases: dict[str, Any] = {}

    def write(message: Message) -> str:
        text = str(message)
        if message and message.text is None:
            phrases[text] = message.serialise()
        return text

    data: dict[str, Any] = strict_json.to_json(value, strict_json.OURS._replace(write=write))
    return {**data, **({"phrases": dict(sorted(phrases.items()))} if phrases else {})}


def typed(kind: type[Made], data: Any, phrases: Any = None) -> Made:
    """Return a dataclass filled with a file's data.

    Args:
        phrases: serialised messages, by their English texts.
    """
    if not isinstance(phrases or {}, dict):
        raise ValueError(msg("is damaged: {why}", why="its phrases: expected an object"))
    known = phrases or {}

    def read(text: Any) -> Message:
        if not isinstance(text, str):
            raise ValueError(f"expected a text, found {text!r:.80}")
        return Message.parse(known[text]) if text in known else Message.of(text)

    try:
        return strict_json.from_json(kind, data, strict_json.OURS._replace(read=read))
    except ValueError as error:
        raise ValueError(msg("is damaged: {why}", why=str(error))) from None


def kept(kind: type[Made], path: Path, most_bytes: int) -> Made | None:
    """Read a dataclass from a small file of ours; None where there is no valid one."""
    try:
        return strict_json.of_line(kind, read_ours(path, most_bytes))
    except (OSError, ValueError):
        return None


def made(make: Callable[[Any], Made], path: Path, data: object) -> Made:
    """Apply a `from_json` to a file's data."""
    try:
        return make(data)
    except ValueError as error:
        raise UsageError(joined([str(path), Message.of(error)], " ")) from None


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
        return {"schema": ERROR_SCHEMA, **with_phrases(self)}

    @classmethod
    def from_json(cls, data: Any) -> Self:
        """Parse the error of a file."""
        validate(data, "error", ERROR_SCHEMA)
        values = {name: data[name] for name in ("whose", "message", "max_score")}
        return typed(cls, values, data.get("phrases"))

    def write(self, path: Path) -> None:
        """Write the error file."""
        files.write(path, text(self.to_json()))
