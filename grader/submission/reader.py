"""Reads a submission in a copy of this process with limits of time and memory.

A file can be made so that its parser uses all memory, or crashes. So no submission is read in this
process: each is read by a copy (`grader.limited`), which gives one answer (`answer.py`) and reaches
nothing else.
"""

from __future__ import annotations

import mmap
import os
import signal
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from grader import limited, strict_json
from grader.errors import SubmissionError, UsageError
from grader.message import NOTHING, Message, msg
from grader.submission import encoding, folder, unpacking, whole
from grader.submission.answer import MAX_BYTES, Answer, decoded
from grader.submission.finding import find, find_inspected
from grader.submission.folder import USUAL_NAME, shown
from grader.submission.imports import read_imports
from grader.submission.lint import lint
from grader.submission.set_ups import NotInspected
from grader.submission.start import Submission, Whole

if TYPE_CHECKING:  # what only a package needs takes time to import
    from grader.scenes.package.inspection import Inspection

#: The limits of reading one submission. A file of MAX_SOURCE_BYTES of ordinary Python takes
#: some 150 MB; an ordinary submission takes 0.1 s of a processor, a zip of MAX_BYTES two.
LIMITS: Final = limited.WorkLimits(
    cpu_s=10.0, wall_s=120.0, memory_bytes=512_000_000, answer_bytes=MAX_BYTES
)
_PLAIN: Final = msg("Hand in nothing but the files of your package, written plainly.")
_PARSER_BREAKS: Final = (signal.SIGSEGV, signal.SIGBUS, signal.SIGABRT)


def read(
    path: Path,
    executable: str | None,
    scratch: Path,
    *,
    is_started: bool = True,
    usual: str = USUAL_NAME,
    again: tuple[NotInspected, Inspection] | None = None,
) -> Submission:
    """Read a submission; see `finding.find`, or `whole.find` for one that is not started.

    Args:
        again: the first reading's request for an inspection, and that inspection.

    Raises:
        NotInspected: it is a package; read it again, with its inspection.
        SubmissionError: as there, or it takes more than the limits.
        UsageError, OSError: as there.
        GraderFailure: the copy has failed.
    """
    name = path.name or path.resolve().name

    def found() -> Submission:
        if not is_started:
            return whole.find(path, executable, scratch)
        if again is None:
            return _with_its_source(find(path, executable, scratch, usual), path)
        return _with_its_source(find_inspected(*again, name, executable, scratch, usual), path)

    with mmap.mmap(-1, mmap.PAGESIZE) as place:  # shared with the copy
        try:
            answer = decoded(limited.call(lambda: _answered(found, path, scratch, place), LIMITS))
        except limited.LimitHit as hit:
            answer = _of_hit(hit, name, place)
    return answer.submission()


def _of_hit(hit: limited.LimitHit, name: str, place: mmap.mmap) -> Answer:
    """Make the answer for a copy that reached a limit and gave none."""
    too_much = _too_much(hit)
    if not too_much:
        return Answer(failed=f"the process for it {hit.why!s}")
    at = bytes(place).rstrip(b"\0").decode("utf-8", "replace")
    return Answer.of_refusal(
        SubmissionError(
            "{name} cannot be read: {too_much}{place}. {plain}",
            name=shown(name),
            too_much=too_much,
            place=msg(" (it got as far as {place})", place=shown(at)) if at else NOTHING,
            plain=_PLAIN,
        )
    )


def _too_much(hit: limited.LimitHit) -> Message:
    """Say which limit was exceeded; NOTHING where the reading failed by our own fault."""
    if isinstance(hit, limited.Slow):
        return msg("that takes more than {wall_s} s", wall_s=int(LIMITS.wall_s))
    if isinstance(hit, limited.NoEnd):
        return msg("that takes more than {cpu_s} s of a processor's time", cpu_s=int(LIMITS.cpu_s))
    ended_by = hit.why.values.get("signal")
    if hit.why == limited.TOO_MUCH or ended_by == str(int(signal.SIGKILL)):
        return msg(
            "that takes more than {memory_bytes:.0f} MB of memory",
            memory_bytes=LIMITS.memory_bytes / 1e6,
        )
    if ended_by in [str(int(each)) for each in _PARSER_BREAKS]:
        return msg("Python's own parser breaks down over it")
    return NOTHING


# In the copy ----------------------------------------------------------------------------------


def _answered(
    found: Callable[[], Submission], path: Path, scratch: Path, place: mmap.mmap
) -> bytes:
    import resource  # here: Windows has none

    from grader import linux

    nowhere = os.open(os.devnull, os.O_RDWR)
    for stream in range(3):
        os.dup2(nowhere, stream)
    linux.lower_limit(resource.RLIMIT_FSIZE, folder.MAX_BYTES, folder.MAX_BYTES)
    base = path if path.is_dir() else path.parent
    _note_what_is_read(place, base, *unpacking.places(scratch))
    return strict_json.line(_answer(found, path))


def _answer(found: Callable[[], Submission], path: Path) -> Answer:
    """Find what to start, and answer with it or with the error."""
    try:
        return Answer.of_found(found())
    except NotInspected as asks:
        return Answer(asks=asks)
    except (SubmissionError, UsageError) as error:
        return Answer.of_refusal(error)
    except OSError as error:
        return Answer(unable=error.strerror or str(error), errno=error.errno)
    except RecursionError:
        name = shown(path.name or path.resolve().name)
        deep = SubmissionError("{name} is nested too deeply to be read.", name=name)
        return Answer.of_refusal(deep)
    except MemoryError:
        raise
    except Exception:
        import traceback  # here: most submissions are read without

        return Answer(failed=traceback.format_exc())


def _with_its_source(found: Submission, path: Path) -> Submission:
    """Add to a submission what its source shows: imports, faults and lint findings."""
    only = None if path.is_dir() or path.suffix != ".py" else found.root / path.name
    assert not isinstance(found.start, Whole)
    imports = read_imports(found.root, found.start, only)
    refused = encoding.faults(imports.files, found.root)
    notes, shows = (*refused, *found.notes), lint(found.root, imports.files)
    return replace(found, imports=imports, notes=notes, lint_findings=shows)


def _note_what_is_read(place: mmap.mmap, *folders: Path) -> None:
    """Record which file of these folders is opened, before it is: it may be the last."""
    bases = [str(folder.resolve()) + os.sep for folder in folders]

    def note(event: str, arguments: tuple[Any, ...]) -> None:
        if event == "open" and isinstance(arguments[0], str):
            for base in bases:
                if arguments[0].startswith(base):
                    name = os.fsencode(arguments[0].removeprefix(base))[: len(place)]
                    place[:] = name.ljust(len(place), b"\0")

    sys.addaudithook(note)
