"""One step of looking: a stranger's code, run in a copy of this process, and what came of it."""

from __future__ import annotations

import json
import os
import sys
import traceback
from collections.abc import Callable
from typing import Any, Final

from grader import limited
from grader.scenes.package.examining import leftovers
from grader.scenes.package.trace import Problem

LIMITS: Final = limited.Limits(cpu_s=20.0, wall_s=40.0, memory_bytes=2**30, answer_bytes=16_000_000)
_LONGEST: Final = 400
NONSENSE: Final = "it spoils what is taken down of it"
#: Names a file of the package's own by its path; '' for others.
Own = Callable[[str], str]


class NotKnown(Exception):
    """A package uses what the grader does not know: no fault of the package."""


class Ended(Exception):
    """A step came to no answer; `problem` says why."""

    def __init__(self, problem: Problem) -> None:
        super().__init__(problem.text)
        self.problem = problem


def step(work: Callable[[], Any], own: Own) -> Any:
    """What a function returns, as JSON, from a copy of this process.

    Args:
        own: names the package's own files, where something fails in one; '' for others.

    Raises:
        Ended: it raised something, or took too much.
    """

    def answer() -> bytes:
        try:
            made = {"made": work()}
        except MemoryError:
            raise
        except BaseException as error:  # SystemExit too
            made = {"problem": vars(problem_of(error, own))}
        return json.dumps(made).encode("ascii")

    try:
        said = json.loads(limited.call(answer, LIMITS).decode("ascii"))
    except limited.LimitHit as hit:
        raise Ended(Problem("limit", f"it {hit}")) from None
    except OSError as error:
        raise Ended(Problem("limit", f"it could not be started: {error.strerror}")) from None
    except (ValueError, RecursionError):
        raise Ended(Problem("limit", NONSENSE)) from None
    finally:
        leftovers.end()
    if "problem" in said:
        raise Ended(Problem(**said["problem"]))
    return said["made"]


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
    return Problem(kind, f"{name}{' '.join(words.split())}"[:_LONGEST].rstrip(": "), file, line)


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
