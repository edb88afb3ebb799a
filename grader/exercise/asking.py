"""Asks checks for their findings, each within limits: an author's loop without end is no grader's.

The checks of one judging share one copy of this process (`grader.limited`); a finding comes back as
strict JSON. Where a check ends its copy, the next one gets a new copy.
"""

from __future__ import annotations

import json
import traceback
from collections.abc import Callable, Mapping
from dataclasses import asdict
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from grader import strict_json
from grader.exercise.foreign import contained
from grader.exercise.verdict import Evidence, Expected, Finding, wrong_with
from grader.language import stored
from grader.limited import Copy, Limits
from grader.recording.recording import NominalAlone, NotOver, Recordings

CheckFunction = Callable[[Recordings, Mapping[str, Any]], Finding]

LIMITS = Limits()


class NoFinding(Exception):
    """A check raised something, or returned what is no finding; the text says what and where."""

    def __init__(self, text: str, *, was_raised: bool) -> None:
        super().__init__(text)
        self.was_raised = was_raised


class Asked:
    """The findings of checks about recordings, one by one, as they are asked for.

    Args:
        functions: the checks by their names.
        told: makes a text of what a check raised.
    """

    def __init__(
        self,
        functions: Mapping[str, CheckFunction],
        recordings: Recordings,
        tolerances: Mapping[str, Any],
        told: Callable[[CheckFunction, BaseException], str] | None = None,
    ) -> None:
        self._functions = functions
        self._names = list(functions)
        self._recordings = recordings
        self._tolerances = tolerances
        self._told = told or where_it_failed
        self._copy = Copy(self._answer, LIMITS)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._copy.close()

    def __call__(self, name: str) -> Finding:
        """What a check finds.

        Raises:
            NoFinding: it raised something, or returned what is no finding.
            LimitHit: it did not come to an end.
            NotOver: it asked for a run that is not over.
        """
        words = strict_json.loads(self._copy.ask(self._names.index(name)).decode())
        match words["say"]:
            case "finding":
                found = words["finding"]
                evidence = tuple(Evidence(**item) for item in found["evidence"])
                expected = tuple(Expected.from_json(item) for item in found["expected"])
                made = Finding(**{**found, "evidence": evidence, "expected": expected})
                return stored.restored(made, words["phrases"])
            case "not over":
                raise NotOver
            case "interrupted":
                raise KeyboardInterrupt
        raise NoFinding(words["text"], was_raised=words["say"] == "raised")

    def _answer(self, number: int) -> bytes:
        return json.dumps(self._run(self._functions[self._names[number]])).encode()

    def _run(self, function: CheckFunction) -> dict[str, Any]:
        """In the copy: ask it."""
        try:
            with contained():
                finding = function(self._recordings, self._tolerances)
        except KeyboardInterrupt:
            return {"say": "interrupted"}
        except NotOver:
            return {"say": "not over"}
        except (MemoryError, RecursionError):  # limits, too
            raise
        except BaseException as error:  # SystemExit too: a check must not end us unjudged
            return {"say": "raised", "text": self._told(function, error)}
        is_alone = isinstance(self._recordings, NominalAlone)
        wrong = wrong_with(finding, 1 if is_alone else len(list(self._recordings)))
        if wrong:
            return {"say": "wrong", "text": wrong}
        said = {**asdict(finding), "share": float(finding.share)}
        return {"say": "finding", "finding": said, "phrases": stored.phrases_in(finding)}


def where_it_failed(function: CheckFunction, error: BaseException) -> str:
    """An exception in a check, with the last line of the file that the check stands in."""
    file = function.__code__.co_filename
    frames = traceback.extract_tb(error.__traceback__)
    lines = [frame.lineno for frame in frames if frame.filename == file]
    where = f"{Path(file).name}, line {lines[-1]}: " if lines else ""
    return f"{where}{type(error).__name__}: {error}".rstrip(": ")
