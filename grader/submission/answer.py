"""What the process that reads a submission answers: one line of JSON, and nothing else is taken.

Before it come lines that say where it is; of those, and of how it ended, its parent tells.
"""

from __future__ import annotations

import json
import signal
from dataclasses import replace
from itertools import islice
from pathlib import Path
from typing import Any, Final, TypeVar

from grader import strict_json
from grader.errors import GraderError, GraderFailure, SubmissionError, UsageError
from grader.language import stored
from grader.submission.set_ups import NotInspected
from grader.submission.start import Imports, Submission
from grader.text import clip

#: How a line begins that tells where the process is; a string in JSON follows.
AT: Final = b"at "
#: How the reading ended that took too long on the clock.
TOO_LATE: Final = "SIGALRM"
#: No line is longer.
MAX_BYTES: Final = 1_000_000
#: So many modules are told, of those that are imported surely and of the others.
_MAX_MODULES: Final = 500
_MAX_NAME: Final = 200
#: So many notes are told, and so much of each [characters].
_MAX_NOTES: Final = 20
_MAX_NOTE: Final = 1000

_Texts = TypeVar("_Texts", str, tuple[str, ...])

_REFUSALS: Final = {each.whose: each for each in (SubmissionError, UsageError)}


def at(place: str) -> bytes:
    """The line that says where the process is."""
    return AT + json.dumps(place).encode() + b"\n"


def ended(at: str, last: bytes, code: int) -> bytes:
    """Two lines: where a reading was at last and how it ended, and the last line that it said."""
    return json.dumps({"at": at, "end": end(code)}).encode() + b"\n" + last + b"\n"


def end(code: int) -> str:
    """How a process ended, by its exit code: that, or the name of the signal that ended it."""
    return signal.Signals(-code).name if code < 0 else str(code)


def found(submission: Submission) -> bytes:
    """The answer of one who has found what to start."""
    notes = submission.notes[:_MAX_NOTES]
    imports = Imports(_some(submission.imports.surely), _some(submission.imports.perhaps))
    told = replace(submission, notes=tuple(clip(n, _MAX_NOTE) for n in notes), imports=imports)
    return _line(strict_json.to_json(told, strict_json.OURS), submission.found, *notes)


def asks(for_: NotInspected) -> bytes:
    """The answer of one whose submission only an inspection can tell what to start of."""
    told = {"base": str(for_.base), "folders": list(for_.folders), "inside": for_.inside}
    return _line({"not_inspected": told})


def refused(error: GraderError) -> bytes:
    """The answer of one who cannot use the submission."""
    return _line({"refused": error.whose, "message": error.message}, error.message)


def unable(error: OSError) -> bytes:
    """The answer of one whose machine does not work."""
    return _line({"errno": error.errno, "message": error.strerror or str(error)})


def short_of_memory() -> bytes:
    """The answer of one who has no memory left."""
    return _line({"short_of": "memory"})


def failed(what: str) -> bytes:
    """The answer of one who has made a mistake."""
    return _line({"failed": what[-4000:]})


def parsed(line: bytes) -> dict[str, Any] | None:
    """An answer as data; None if that is none."""
    if len(line) > MAX_BYTES or not line.endswith(b"\n"):
        return None
    try:
        data = strict_json.loads(line.decode("ascii"))
    except (ValueError, RecursionError):
        return None
    return data if isinstance(data, dict) else None


def is_short_of_memory(said: dict[str, Any]) -> bool:
    """Whether an answer is that there is no memory left."""
    return said == {"short_of": "memory"}


def decoded(said: dict[str, Any]) -> Submission:
    """What was found.

    Raises:
        SubmissionError, UsageError, OSError, NotInspected: that was the answer.
        GraderFailure: the process has made a mistake.
    """
    match said:
        case {"refused": str(whose), "message": str(message)} if whose in _REFUSALS:
            raise _REFUSALS[whose](_phrased(message, said))
        case {"errno": int() | None as number, "message": str(message)}:
            raise OSError(number, message)
        case {"not_inspected": {"base": str(base), "folders": [*folders], "inside": [*inside]}}:
            asked = NotInspected(Path(base), list(map(str, folders)))
            asked.inside = list(map(str, inside))
            raise asked
        case {"failed": str(what)}:
            raise GraderFailure(f"the submission could not be read: {what}")
    try:
        made = strict_json.from_json(
            Submission, {n: told for n, told in said.items() if n != "phrases"}, strict_json.OURS
        )
    except ValueError:
        raise _nonsense() from None
    return replace(made, found=_phrased(made.found, said), notes=_phrased(made.notes, said))


def _nonsense() -> GraderFailure:
    return GraderFailure("the submission could not be read: the answer makes no sense")


def _some(modules: dict[str, str]) -> dict[str, str]:
    named = ((name, where) for name, where in modules.items() if len(name) <= _MAX_NAME)
    return dict(islice(named, _MAX_MODULES))


def _phrased(texts: _Texts, said: dict[str, Any]) -> _Texts:
    """Texts of an answer, as phrases again."""
    phrases = said.get("phrases", {})
    try:
        return stored.restored(texts, phrases)
    except (ValueError, TypeError, AttributeError):
        raise _nonsense() from None


def _line(data: dict[str, Any], *texts: str) -> bytes:
    """A line of JSON; those of its texts that are phrases are told as such beside it."""
    phrases = stored.phrases_in(texts)
    line = json.dumps({**data, "phrases": phrases} if phrases else data).encode() + b"\n"
    if len(line) > MAX_BYTES:
        raise ValueError(f"an answer of {len(line)} bytes")
    return line
