"""One step of looking: a stranger's code, run in a copy of this process, and what came of it."""

from __future__ import annotations

import json
import os
import re
import sys
import traceback
from collections.abc import Callable
from pathlib import Path
from typing import Any, Final, TypeVar

from grader import limited, strict_json
from grader.scenes.package.examining import leftovers
from grader.scenes.package.examining.account import CPU_S, Account, Watch
from grader.scenes.package.trace import Problem

#: All processes of a run together may have 1 GiB: one alone comes to its own limit before.
LIMITS: Final = limited.Limits(
    cpu_s=20.0, wall_s=40.0, memory_bytes=3 * 2**28, answer_bytes=16_000_000
)
#: Of the processes that a run may have, so many are none of a step's: a step that starts others
#: without end is refused more long before these have all the memory of the run.
_NOT_OF_A_STEP: Final = 160
_NO_END: Final = (
    f"it did not come to an end in {LIMITS.cpu_s:.0f} s of processor time, or {LIMITS.wall_s:.0f} s"
)
_LONGEST: Final = 400
NONSENSE: Final = "it spoils what is taken down of it"
#: Where an object lies in memory, which is another place each time.
_ADDRESS: Final = re.compile(r"\bat 0x[0-9a-fA-F]+")
#: Names a file of the package's own by its path; '' for others.
Own = Callable[[str], str]
Made = TypeVar("Made")


class NotKnown(Exception):
    """A package uses what the grader does not know: no fault of the package."""


class Ended(Exception):
    """A step came to no answer; `problem` says why."""

    def __init__(self, problem: Problem) -> None:
        super().__init__(problem.text)
        self.problem = problem


_account = Account()


def open_account(cpu_s: float = CPU_S) -> None:
    """Begin a look: what steps took before does not count, and may be so much from here on [s]."""
    global _account
    _account = Account(cpu_s)


def step(work: Callable[[], Any], own: Own) -> Any:
    """What a function returns, as JSON, from a copy of this process.

    Args:
        own: names the package's own files, where something fails in one; '' for others.

    Raises:
        Ended: it raised something, or took too much.
    """

    def answer() -> bytes:
        _limit_processes()
        try:
            made = {"made": work()}
        except MemoryError:
            raise
        except BaseException as error:  # SystemExit too
            made = {"problem": vars(problem_of(error, own))}
        return json.dumps(made).encode("ascii")

    if _account.why_closed:
        raise Ended(Problem("limit", _account.why_closed))
    try:
        said = _read(limited.call(answer, LIMITS, Watch(_account).is_stalled))
    except limited.NoEnd as hit:
        text = f"it {hit}" if isinstance(hit, limited.Stalled) else _NO_END
        raise Ended(Problem("limit", text)) from None
    except limited.LimitHit as hit:
        raise Ended(Problem("limit", f"it {hit!s:.400}")) from None
    except OSError as error:
        raise Ended(Problem("limit", f"it could not be started: {error.strerror}")) from None
    except (ValueError, RecursionError):
        raise Ended(Problem("limit", NONSENSE)) from None
    finally:
        leftovers.end()
    if isinstance(said, Problem):
        raise Ended(said)
    return said[0]


def attempt(work: Callable[[], Made], file: str = "", line: int = 0) -> Made:
    """What a function of ours returns that reads what was handed in.

    Its failure is a finding of the file, and nobody's exit: other steps go on.

    Raises:
        Ended: it raised something.
    """
    try:
        return work()
    except Ended:
        raise
    except OSError as error:
        what = f"it cannot be read ({error.strerror})"
        raise Ended(Problem("unknown", what, file, line)) from error
    except Exception as error:
        last = traceback.extract_tb(error.__traceback__)[-1]
        words = start_of(" ".join(f"{type(error).__name__}: {error}".split()), _LONGEST)
        at = f"{Path(last.filename).name}, line {last.lineno}"
        what = f"it cannot be read ({words}, {at})"
        raise Ended(Problem("unknown", what, file, line)) from error


def _read(answer: bytes) -> Problem | tuple[Any]:
    """An answer, which the stranger's code could have written itself.

    Raises:
        ValueError, RecursionError: it is none.
    """
    said = json.loads(answer.decode("ascii"))
    if not isinstance(said, dict) or said.keys() not in ({"made"}, {"problem"}):
        raise ValueError(NONSENSE)
    if "problem" in said:
        return strict_json.from_json(Problem, said["problem"])
    return (said["made"],)


def _limit_processes() -> None:
    import resource  # here: Windows has none

    soft, _ = resource.getrlimit(resource.RLIMIT_NPROC)
    if soft != resource.RLIM_INFINITY and soft > _NOT_OF_A_STEP:
        most = soft - _NOT_OF_A_STEP
        resource.setrlimit(resource.RLIMIT_NPROC, (most, most))


def problem_of(error: BaseException, own: Own) -> Problem:
    """An exception, with the last line of the package's own that it went through."""
    chained = error
    kind = "error"
    while chained is not None:
        if isinstance(chained, NotKnown):
            kind = "unknown"
        kind = getattr(chained, "kind_of_problem", kind)
        chained = chained.__cause__ or chained.__context__  # type: ignore[assignment]
    if _is_of_environment(error):
        return Problem("unknown", f"it needs the environment variable {error.args[0]!s:.100}")
    frames = [(own(f.filename), f.lineno or 0) for f in traceback.extract_tb(error.__traceback__)]
    file, line = next((each for each in reversed(frames) if each[0]), ("", 0))
    if isinstance(error, SyntaxError) and error.filename and own(error.filename):
        file, line = own(error.filename), error.lineno or 0
    words = error.msg if isinstance(error, SyntaxError) else str(error)
    name = "" if isinstance(error, NotKnown) else f"{type(error).__name__}: "
    text = start_of(_ADDRESS.sub("at 0x...", f"{name}{' '.join(words.split())}"), _LONGEST)
    return Problem(kind, text.rstrip(": "), file, line)


def start_of(text: str, most: int) -> str:
    """A text cut at its end, and not within a path: part of one, nobody knows for what it is."""
    cut = text[:most]
    before, _, last = cut.rpartition(" ")
    return before if len(text) > most and "/" in last else cut


def end_of(text: str, most: int) -> str:
    """The same at its start."""
    return start_of(text[-most - 1 :][::-1], most)[::-1]


def _is_of_environment(error: BaseException) -> bool:
    """Whether it is what `os.environ[NAME]` raises: the user's shell may have it."""
    last = traceback.extract_tb(error.__traceback__)[-1:]
    return (
        isinstance(error, KeyError)
        and bool(last)
        and last[0].filename in (os.__file__, "<frozen os>")
    )


def in_folder(folder: str, path: list[str], env: dict[str, str]) -> None:
    """In the copy: stand in a folder, look for modules there first, have these variables."""
    os.chdir(folder)
    sys.path[:0] = path
    os.environ.update(env)
