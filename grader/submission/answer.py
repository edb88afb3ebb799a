"""What the process that reads a submission answers: one line of JSON, and nothing else is taken.

Before it come lines that say where it is; of those, and of how it ended, its parent tells.
"""

from __future__ import annotations

import json
import signal
from itertools import islice
from pathlib import Path
from typing import Any, Final, TypeVar

from grader import strict_json
from grader.errors import GraderError, GraderFailure, SubmissionError, UsageError
from grader.language import stored
from grader.submission.set_ups import NotInspected
from grader.submission.start import (
    EntryPoint,
    Imports,
    Launch,
    Program,
    Script,
    Slip,
    Submission,
    Whole,
)
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
    return _line(
        {
            "name": submission.name,
            "root": str(submission.root),
            "start": _told(submission.start),
            "found": submission.found,
            "surely": _some(submission.imports.surely),
            "perhaps": _some(submission.imports.perhaps),
            "notes": [clip(note, _MAX_NOTE) for note in submission.notes[:_MAX_NOTES]],
            "slips": submission.slips,
            "added": [str(each) for each in submission.added],
            "in_package": str(submission.package) if submission.package else None,
        },
        submission.found,
        *submission.notes[:_MAX_NOTES],
    )


def _told(start: EntryPoint | Script | Launch | Whole) -> dict[str, object]:
    match start:
        case EntryPoint(module, function):
            return {"module": module, "function": function}
        case Script(path, function):
            return {"path": str(path), "function": function}
        case Whole(package):
            return {"package": package}
    return {
        "programs": [
            {"name": each.name, "entry": _told(each.entry), "arguments": list(each.arguments)}
            for each in start.programs
        ]
    }


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
        case {
            "name": str(name),
            "root": str(root),
            "start": dict(start),
            "found": str(sentence),
            "surely": dict(surely),
            "perhaps": dict(perhaps),
            "notes": list(notes),
            "slips": list(slips),
            "added": list(added),
            "in_package": str() | None as package,
        } if all(isinstance(note, str) for note in (*notes, *added)):
            imports = Imports(_texts(surely), _texts(perhaps))
            return Submission(
                *(name, Path(root), _start(start), _phrased(sentence, said), imports),
                notes=_phrased(tuple(notes), said),
                slips=tuple(map(_slip, slips)),
                added=tuple(map(Path, added)),
                package=Path(package) if package else None,
            )
    raise _nonsense()


def _start(said: dict[str, Any]) -> EntryPoint | Script | Launch | Whole:
    match said:
        case {"programs": list(programs)} if programs:
            return Launch(tuple(map(_program, programs)))
        case {"module": str(module), "function": str(function)}:
            return EntryPoint(module, function)
        case {"path": str(path), "function": str() | None as function}:
            return Script(Path(path), function)
        case {"package": str(package)}:
            return Whole(package)
    raise _nonsense()


def _program(said: object) -> Program:
    match said:
        case {"name": str(name), "entry": dict(entry), "arguments": list(arguments)}:
            start = _start(entry)
            if isinstance(start, EntryPoint) and all(isinstance(each, str) for each in arguments):
                return Program(name, start, tuple(arguments))
    raise _nonsense()


def _slip(said: object) -> Slip:
    match said:
        case [str(kind), str(name), str(near), str(file), int(line), str(text)]:
            return Slip(kind, name, near, file, line, text)
    raise _nonsense()


def _texts(said: dict[str, Any]) -> dict[str, str]:
    if not all(isinstance(text, str) for text in said.values()):
        raise _nonsense()
    return said


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
