"""Reads a submission in a copy of this process with limits of time and memory.

A file can be made so that its parser uses all memory, or crashes. So no submission is read in this
process: each is read by a copy (`grader.system.limited`), which gives one answer, a line of strict
JSON, and reaches nothing else.
"""

from __future__ import annotations

import errno
import os
import signal
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Final, Self

from grader.errors import GraderError, GraderFailure, SubmissionError, UsageError
from grader.recording.recording import OwnInterfaces
from grader.recording.subject import Role
from grader.submission import folder, python_source
from grader.submission.interfaces import completed, undeclared
from grader.submission.manifest import FILE as MANIFEST
from grader.submission.manifest import exercises_named
from grader.submission.opened import opened
from grader.submission.program_choice import find, find_evaluated, find_whole, may_be_node
from grader.submission.program_source import read_imports, roles_in
from grader.submission.request import Request
from grader.submission.set_ups import Unevaluated
from grader.submission.start import Imports, Submission
from grader.system import extensions, limited, strict_json
from grader.text.message import NOTHING, Message, msg
from grader.text.strings import clip, shown

if TYPE_CHECKING:  # what only a package needs takes time to import
    from grader.submission.answer import Inspection

#: No answer is longer.
_MAX_ANSWER: Final = 1_000_000
#: So many modules are in an answer, of those that are imported surely and of the others.
_MAX_MODULES: Final = 500
_MAX_NAME: Final = 200
#: So many notes are in an answer, and so much of each [characters].
_MAX_NOTES: Final = 20
_MAX_NOTE: Final = 1000

_REFUSALS: Final = {each.whose: each for each in (SubmissionError, UsageError)}

#: The limits of reading one submission. A file of MAX_SOURCE_BYTES of ordinary Python takes
#: some 150 MB; an ordinary submission takes 0.1 s of a processor, a zip of MAX_BYTES two.
LIMITS: Final = limited.WorkLimits(
    cpu_s=10.0, wall_s=120.0, memory_bytes=512_000_000, answer_bytes=_MAX_ANSWER
)
_PLAIN: Final = msg("Hand in nothing but the files of your package, written plainly.")
_PARSER_BREAKS: Final = (signal.SIGSEGV, signal.SIGBUS, signal.SIGABRT)


@dataclass(frozen=True)
class Marks:
    """What a submission shows of its exercise before it is opened for one.

    Attributes:
        exercises: those that it names, each with the file that does.
        files: the names of its files, so many of them.
        programs: how many of them may be a node.
        roles: what its source has on the graph; none of one that names its exercise.
    """

    exercises: Mapping[str, str] = field(default_factory=dict)
    files: tuple[str, ...] = ()
    programs: int = 0
    roles: tuple[Role, ...] = ()


@dataclass(frozen=True)
class _Answer:
    """The outcome of reading a submission; one of these.

    Attributes:
        found: what to start; or what has to be evaluated first.
        refused: why the submission cannot be used, and `whose` turn it is.
        unable: why the machine cannot read it, and the system's `errno` of that.
        failed: the grader's own mistake, in words.
    """

    found: Submission | Unevaluated | None = None
    refused: Message = NOTHING
    whose: str = ""
    unable: str = ""
    errno: int | None = None
    failed: str = ""

    @classmethod
    def of_found(cls, submission: Submission | Unevaluated) -> Self:
        """Answer with a submission, its lists and texts cut to their limits."""
        if isinstance(submission, Unevaluated):
            return cls(submission)
        imports = Imports(_some(submission.imports.surely), _some(submission.imports.perhaps))
        notes = submission.notes[:_MAX_NOTES]
        short = tuple(note.map_texts(partial(clip, limit=_MAX_NOTE)) for note in notes)
        return cls(replace(submission, notes=short, imports=imports))

    @classmethod
    def of_refusal(cls, error: GraderError) -> Self:
        """Answer with the error that refuses a submission."""
        return cls(refused=error.message, whose=error.whose)

    def submission(self) -> Submission | Unevaluated:
        """Return what was found."""
        if self.whose in _REFUSALS:
            raise _REFUSALS[self.whose](self.refused)
        if self.unable:
            raise OSError(self.errno, self.unable)
        if self.found is None:
            failed = self.failed or "the answer makes no sense"
            raise GraderFailure(f"the submission could not be read: {failed[-4000:]}")
        return self.found


def decoded(line: bytes) -> _Answer:
    """Decode an answer; one that makes no sense becomes that of a failure."""
    try:
        if len(line) > _MAX_ANSWER:
            raise ValueError(f"an answer of {len(line)} bytes")
        return strict_json.of_line(_Answer, line)
    except (ValueError, RecursionError):
        return _Answer()


def _some(modules: dict[str, str]) -> dict[str, str]:
    named = ((name, where) for name, where in modules.items() if len(name) <= _MAX_NAME)
    return dict(islice(named, _MAX_MODULES))


def read(path: Path, request: Request, scratch: Path) -> Submission | Unevaluated:
    """Read a submission; see `finding.find`, or `find_whole` for one that is not started.

    Raises:
        SubmissionError: as there, or it takes more than the limits.
        UsageError, OSError: as there.
        GraderFailure: the copy has failed.
    """

    def found() -> Submission | Unevaluated:
        with readable(path):
            if not request.is_started:
                return find_whole(path, request.executable, scratch)
            started = find(path, request, scratch)
        if isinstance(started, Unevaluated):
            return started
        only = started.root / path.name if path.suffix == ".py" and not path.is_dir() else None
        return _with_its_source(started, only, request)

    return _in_copy(found, path.name or path.resolve().name)


def read_evaluated(
    package: Unevaluated, inspection: Inspection, name: str, request: Request, scratch: Path
) -> Submission:
    """Read a submission that was evaluated; see `read`."""

    def found() -> Submission:
        with readable(package.base):
            started = find_evaluated(package, inspection, name, request, scratch)
        return _with_its_source(started, None, request)

    submission = _in_copy(found, name)
    if isinstance(submission, Unevaluated):
        raise GraderFailure("the answer makes no sense")
    return submission


def _in_copy(found: Callable[[], Submission | Unevaluated], name: str) -> Submission | Unevaluated:
    extensions.load_all(extensions.DIAGNOSES)  # the copy could not

    def answered() -> bytes:
        _be_confined()
        return strict_json.line(_answer(found, name))

    try:
        return decoded(limited.call(answered, LIMITS)).submission()
    except limited.LimitHit as hit:
        raise _error_of(hit, name) from None


def read_marks(path: Path, scratch: Path) -> Marks:
    """Read what a submission shows of its exercise; of one that cannot be read, nothing."""

    def found() -> bytes:
        _be_confined()
        return strict_json.line(_marks(path, scratch))

    try:
        return strict_json.of_line(Marks, limited.call(found, LIMITS))
    except (limited.LimitHit, ValueError):
        return Marks()


def _error_of(hit: limited.LimitHit, name: str) -> GraderError:
    """Return the error for a copy that reached a limit and gave no answer."""
    if too_much := _too_much(hit):
        words = {"name": shown(name), "too_much": too_much, "plain": _PLAIN}
        return SubmissionError("{name} cannot be read: {too_much}. {plain}", **words)
    return GraderFailure(f"the submission could not be read: the process for it {hit.why!s}")


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


def _be_confined() -> None:
    import resource  # here: Windows has none

    from grader.system import linux

    nowhere = os.open(os.devnull, os.O_RDWR)
    for stream in range(3):
        os.dup2(nowhere, stream)
    linux.lower_limit(resource.RLIMIT_FSIZE, folder.MAX_BYTES, folder.MAX_BYTES)


def _marks(path: Path, scratch: Path) -> Marks:
    try:
        if path.suffix == ".py" and path.is_file():
            base, files = path.parent, [path]
        else:
            submitted, files, _ = opened(path, Request(), scratch)
            base = submitted.base
        exercises = {
            shown(exercise): shown(file.relative_to(base))
            for file in reversed(files)
            if (file.name == MANIFEST or file.suffix == ".py") and not file.is_symlink()
            for exercise in exercises_named(file)
        }
    except (SubmissionError, UsageError, OSError):
        return Marks()
    names = tuple(shown(file.name) for file in files[:_MAX_MODULES])
    programs = [file for file in files if may_be_node(file) and not file.is_symlink()]
    roles = [] if exercises else sorted(roles_in(programs))
    roles = [each for each in roles if len(each.name) <= _MAX_NAME]
    return Marks(_some(exercises), names, len(programs), tuple(roles[:_MAX_MODULES]))


@contextmanager
def readable(path: Path) -> Iterator[None]:
    """Turn an OSError of one file of the submission into a SubmissionError."""
    try:
        yield
    except OSError as error:
        if error.errno not in folder.UNREADABLE:
            raise
        base, culprit = path.resolve(), Path(error.filename or path)
        advice = msg("Check its permissions, and hand it in again.")
        if error.errno == errno.ENAMETOOLONG:
            advice = msg("Shorten its name, and hand it in again.")
        raise SubmissionError(
            "{file} cannot be read: {why}. {advice}",
            file=shown(culprit.relative_to(base) if base in culprit.parents else path),
            why=str(error.strerror),
            advice=advice,
        ) from error


def _answer(found: Callable[[], Submission | Unevaluated], name: str) -> _Answer:
    """Find what to start, and answer with it or with the error."""
    try:
        return _Answer.of_found(found())
    except (SubmissionError, UsageError) as error:
        return _Answer.of_refusal(error)
    except OSError as error:
        return _Answer(unable=error.strerror or str(error), errno=error.errno)
    except RecursionError:
        deep = SubmissionError("{name} is nested too deeply to be read.", name=shown(name))
        return _Answer.of_refusal(deep)
    except MemoryError:
        raise
    except Exception:
        import traceback  # here: most submissions are read without

        return _Answer(failed=traceback.format_exc())


def _with_its_source(found: Submission, only: Path | None, request: Request) -> Submission:
    """Add to a submission what its source shows: imports, interfaces, faults, lint findings.

    Args:
        only: the one file that is the submission, if it is one.
    """
    imports = read_imports(found.root, found.programs, only, found.beside)
    files = [each for each in imports.files if each.is_relative_to(found.root)]
    refused = python_source.byte_faults(files, found.root)
    notes = [*refused, *found.notes]
    diagnosers = extensions.load_all(extensions.DIAGNOSES)
    shows = tuple(finding for each in diagnosers for finding in each.lint(found.root, files))
    defined = completed(found.interfaces, request.interfaces)
    known = {*imports.surely, *imports.perhaps} & defined.packages
    interfaces = defined if known else OwnInterfaces()
    if found.package is not None:
        notes += undeclared(found.package / MANIFEST, known & found.interfaces.packages)
    for name in known:
        imports.surely.pop(name, None)
        imports.perhaps.pop(name, None)
    found = replace(found, imports=imports, interfaces=interfaces, defined=defined)
    return replace(found, notes=tuple(notes), lint_findings=shows)
