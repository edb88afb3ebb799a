"""The result file `turtlesim-grader/result/v1`: one judged run, for people's tools.

Its JSON Schema is `result.schema.json` beside this module.
"""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from importlib.resources import files
from pathlib import Path
from typing import Any

import jsonschema

from grader.errors import UsageError
from grader.exercise.loading import Exercise
from grader.exercise.sentences import remarks
from grader.exercise.verdict import Verdict
from grader.recording.recording import Recording, Recordings

SCHEMA = "turtlesim-grader/result/v1"
Result = dict[str, Any]


def build(
    submission: str,
    exercise: Exercise,
    recordings: Recordings,
    verdicts: Sequence[Verdict],
    artifacts: Mapping[str, str],
) -> Result:
    """Put a result together; `artifacts` are paths relative to the result file."""
    return {
        "schema": SCHEMA,
        "exercise": exercise.name,
        "submission": submission,
        "score": round(sum(v.score for v in verdicts), 2),
        "max_score": round(sum(v.max_score for v in verdicts), 2),
        "verdicts": [v.as_json() for v in verdicts],
        "run": _run(recordings.nominal),
        "varied_runs": [_run(recording) for recording in recordings.varied],
        "artifacts": dict(artifacts),
    }


def _run(recording: Recording) -> dict[str, Any]:
    run = asdict(recording.run)
    run["flags"] = [*recording.run.flags, *remarks(recording)]
    if recording.start is not None:
        run["start"] = asdict(recording.start)
    return run


def schema() -> dict[str, Any]:
    """The JSON Schema of a result."""
    text = (files("grader.result") / "result.schema.json").read_text(encoding="utf-8")
    loaded: dict[str, Any] = json.loads(text)
    return loaded


def write(result: Result, path: Path) -> None:
    """Write a result whole or not at all; into a device or a pipe it is simply written."""
    text = json.dumps(result, indent=2, ensure_ascii=False, allow_nan=False) + "\n"
    if path.exists() and not path.is_file():
        path.write_text(text, encoding="utf-8")
        return
    path = path.resolve()  # a link stays a link
    path.parent.mkdir(parents=True, exist_ok=True)
    unfinished = path.with_name(f".{path.name}.{os.getpid()}")
    unfinished.write_text(text, encoding="utf-8")
    unfinished.replace(path)


def read(path: Path) -> Result:
    """Read a result.

    Raises:
        UsageError: it cannot be read or is no result of this version.
    """
    try:
        result: Result = json.loads(path.read_text(encoding="utf-8"))
        jsonschema.validate(result, schema())
    except OSError as error:
        raise UsageError(f"cannot read the result {path}: {error.strerror}") from None
    except ValueError as error:
        raise UsageError(f"{path} is not JSON: {error}") from None
    except jsonschema.ValidationError as error:
        raise UsageError(f"{path} is no result of {SCHEMA}: {error.message}") from None
    return result
