"""What the files of this package have in common: JSON that follows a schema beside the module."""

from __future__ import annotations

import json
from collections.abc import Callable
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from grader import strict_json
from grader.errors import UsageError
from grader.language.phrase import joined, reason, say

if TYPE_CHECKING:
    import jsonschema

Made = TypeVar("Made")


def schema(name: str) -> dict[str, Any]:
    """The JSON Schema of `result` or `error`."""
    text = (files("grader.result") / f"{name}.schema.json").read_text(encoding="utf-8")
    loaded: dict[str, Any] = json.loads(text)
    return loaded


def validate(data: object, name: str, version: str) -> None:
    """Hold data against a schema.

    Raises:
        ValueError: it does not follow it.
    """
    found = data.get("schema") if isinstance(data, dict) else None
    family = version.rpartition("/")[0]
    if isinstance(found, str) and found != version and found.startswith(f"{family}/"):
        raise ValueError(f"is no {name} of {version}: it is of another version, {found:.60}")
    from jsonschema.exceptions import best_match  # here: what is only written is not validated

    error = best_match(_validator(name).iter_errors(data))
    if error is not None:
        raise ValueError(f"is no {name} of {version}: {error.message}")


def text(data: dict[str, Any]) -> str:
    """The text of a file."""
    return json.dumps(data, indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def read(path: Path) -> Any:
    """Read JSON.

    Raises:
        UsageError: it cannot be read or is none.
    """
    try:
        # utf-8-sig: some editors put a mark at the start
        return strict_json.loads(path.read_text(encoding="utf-8-sig"))
    except OSError as error:
        raise UsageError(
            say("cannot read the result {path}: {why}", path=path, why=error.strerror)
        ) from None
    except (ValueError, RecursionError) as error:
        raise UsageError(say("{path} is not JSON: {why}", path=path, why=str(error))) from None


def made(make: Callable[[Any], Made], path: Path, data: object) -> Made:
    """What a `from_json` makes of a file's data.

    Raises:
        UsageError: the data does not follow the schema; the text names the file.
    """
    try:
        return make(data)
    except ValueError as error:
        raise UsageError(joined([f"{path} ", reason(error)])) from None


@cache
def _validator(name: str) -> jsonschema.Draft202012Validator:
    import jsonschema

    return jsonschema.Draft202012Validator(schema(name))
