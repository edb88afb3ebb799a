"""One step of looking: a stranger's code, run in a copy of this process, and what came of it.

All steps of a look have one account: of processor time and idleness, time in which nothing of a
step runs or wants to, so that a busy machine decides nothing.
"""

from __future__ import annotations

import json
import os
import re
import sys
import time
import traceback
from collections.abc import Callable
from pathlib import Path
from typing import Any, Final, Self, TypeVar

from grader.submission.examining import leftovers
from grader.submission.package_trace import Obstacle
from grader.system import limited, strict_json
from grader.text.message import NOTHING, Message, msg
from ros_doubles import NotKnown, OfAnother

#: All processes of a run together may have 1 GiB: one alone comes to its own limit before.
LIMITS: Final = limited.WorkLimits(
    cpu_s=20.0, wall_s=40.0, memory_bytes=3 * 2**28, answer_bytes=16_000_000
)
#: Of the processes that a run may have, so many are none of a step's: a step that starts others
#: without end is refused more long before these have all the memory of the run.
_NOT_OF_A_STEP: Final = 160
_NO_END: Final = msg(
    "did not come to an end in {cpu} s of processor time, or {wall} s",
    cpu=f"{LIMITS.cpu_s:.0f}",
    wall=f"{LIMITS.wall_s:.0f}",
)
_LONGEST: Final = 400
_NOT_KNOWN: Final = msg("uses {name}, which the grader does not know")
#: ... of something that belongs to another package
_NOT_HERE: Final = msg("uses {name}, which the grader does not have")
NONSENSE: Final = msg("spoils what is taken down of it")
#: Where an object lies in memory, which is another place each time.
_ADDRESS: Final = re.compile(r"\bat 0x[0-9a-fA-F]+")
#: Names a file of the package's own by its path; '' for others.
Own = Callable[[str], str]
Made = TypeVar("Made")


class Ended(Exception):
    """A step came to no answer; `problem` says why."""

    def __init__(self, problem: Obstacle) -> None:
        super().__init__(problem.text)
        self.problem = problem

    @classmethod
    def by_limit(cls, clause: Message) -> Self:
        """Of what took too much: 'it called itself too deeply'."""
        return cls(Obstacle("limit", it(clause)))


def it(clause: Message) -> Message:
    """A clause about what is evaluated; whoever tells of it may put a file's name for the "it"."""
    return msg("it {what}", what=clause)


#: All steps of a look may take so much processor time, and be idle for so long [s].
CPU_S, IDLE_S = 120.0, 20.0
#: One step may be idle for so long [s]: it waits for what does not come.
STEP_IDLE_S: Final = 4.0
_SPENT: Final = msg(
    "was not tried: the package had taken {cpu} s of processor time, or {idle} s of waiting"
)


class Account:
    """The account of one look; what was taken before it was opened does not count.

    Args:
        cpu_s: so much processor time may be taken [s].
    """

    def __init__(self, cpu_s: float = CPU_S) -> None:
        self._cpu_s = cpu_s
        self._before_s = _children_cpu_s()
        self._idle_s = 0.0

    @property
    def why_closed(self) -> Message:
        """Why there is to be no further step; nothing where there may be one."""
        used_s = _children_cpu_s() - self._before_s
        if used_s <= self._cpu_s and self._idle_s <= IDLE_S:
            return NOTHING
        return _SPENT.given(cpu=f"{self._cpu_s:.0f}", idle=f"{IDLE_S:.0f}")

    def watch(self) -> Callable[[], bool]:
        """Return whether the step that begins now waits in vain; ask about twice a second."""
        before_s, before_used_s, before_idle_s = time.monotonic(), 0.0, self._idle_s

        def is_stalled() -> bool:
            nonlocal before_s, before_used_s
            ticks, wants_more = leftovers.used()
            used_s, now_s = ticks / os.sysconf("SC_CLK_TCK"), time.monotonic()
            if not wants_more:
                self._idle_s += max(0.0, now_s - before_s - max(0.0, used_s - before_used_s))
            before_used_s, before_s = used_s, now_s
            return self._idle_s - before_idle_s > STEP_IDLE_S

        return is_stalled


def _children_cpu_s() -> float:
    import resource  # here: Windows has none

    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


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
            made = {"problem": strict_json.to_json(problem_of(error, own))}
        return json.dumps(made).encode("ascii")

    if _account.why_closed:
        raise Ended.by_limit(_account.why_closed)
    try:
        return _read(limited.call(answer, LIMITS, _account.watch()))
    except limited.NoEnd as hit:
        raise Ended.by_limit(hit.why if isinstance(hit, limited.Stalled) else _NO_END) from None
    except limited.LimitHit as hit:
        raise Ended.by_limit(hit.why) from None
    except OSError as error:
        why = msg("could not be started: {error}", error=error.strerror)
        raise Ended.by_limit(why) from None
    except (ValueError, RecursionError):
        raise Ended.by_limit(NONSENSE) from None
    finally:
        leftovers.end()


def attempt(work: Callable[[], Made], file: str = "") -> Made:
    """What a function of ours returns that reads what was handed in.

    Its failure is a finding of the file, and nobody's exit: other steps go on.

    Raises:
        Ended: it raised something.
    """
    try:
        return work()
    except Ended:
        raise
    except Exception as error:
        last = traceback.extract_tb(error.__traceback__)[-1]
        words = start_of(" ".join(f"{type(error).__name__}: {error}".split()), _LONGEST)
        why = f"{words}, {Path(last.filename).name}, line {last.lineno}"
        if isinstance(error, OSError):
            why = str(error.strerror)
        what = msg("cannot be read ({error})", error=why)
        raise Ended(Obstacle("unknown", it(what), file)) from error


def _read(answer: bytes) -> Any:
    """What an answer says was returned; the stranger's code could have written it itself."""
    answered = json.loads(answer.decode("ascii"))
    if not isinstance(answered, dict) or answered.keys() not in ({"made"}, {"problem"}):
        raise ValueError(str(NONSENSE))
    if "problem" in answered:
        raise Ended(strict_json.from_json(Obstacle, answered["problem"]))
    return answered["made"]


def _limit_processes() -> None:
    import resource  # here: Windows has none

    from grader.system import linux

    soft, _ = resource.getrlimit(resource.RLIMIT_NPROC)
    if soft != resource.RLIM_INFINITY and soft > _NOT_OF_A_STEP:
        linux.lower_limit(resource.RLIMIT_NPROC, soft - _NOT_OF_A_STEP, soft - _NOT_OF_A_STEP)


def problem_of(error: BaseException, own: Own) -> Obstacle:
    """An exception, with the last line of the package's own that it went through."""
    chained = error
    kind = "error"
    while chained is not None:
        if isinstance(chained, NotKnown):
            kind = "unknown"
        kind = getattr(chained, "kind_of_problem", kind)
        chained = chained.__cause__ or chained.__context__  # type: ignore[assignment]
    if _is_of_environment(error):
        name = f"{error.args[0]!s:.100}"
        return Obstacle("unknown", it(msg("needs the environment variable {name}", name=name)))
    frames = [(own(f.filename), f.lineno or 0) for f in traceback.extract_tb(error.__traceback__)]
    file, line = next((each for each in reversed(frames) if each[0]), ("", 0))
    if isinstance(error, SyntaxError) and error.filename and own(error.filename):
        file, line = own(error.filename), error.lineno or 0
    if isinstance(error, NotKnown):
        what = error.args[0]
        if not isinstance(what, Message):
            what = it((_NOT_HERE if isinstance(error, OfAnother) else _NOT_KNOWN).given(name=what))
        return Obstacle(kind, what, file, line)
    words = error.msg if isinstance(error, SyntaxError) else str(error)
    raised = f"{type(error).__name__}: {' '.join(words.split())}"
    text = start_of(_ADDRESS.sub("at 0x...", raised), _LONGEST)
    return Obstacle(kind, Message.of(text.rstrip(": ")), file, line)


def start_of(text: str, most: int) -> str:
    """A text cut at its end, and not within a path: part of one, nobody knows for what it is."""
    cut = text[:most]
    before, _, last = cut.rpartition(" ")
    return before if len(text) > most and "/" in last else cut


def end_of(text: str, most: int) -> str:
    return start_of(text[-most - 1 :][::-1], most)[::-1]


def _is_of_environment(error: BaseException) -> bool:
    """Whether it is what `os.environ[NAME]` raises: the user's shell may have it."""
    last = traceback.extract_tb(error.__traceback__)[-1:]
    is_there = bool(last) and last[0].filename in (os.__file__, "<frozen os>")
    return is_there and isinstance(error, KeyError)


def in_folder(folder: str, path: list[str], env: dict[str, str]) -> None:
    """In the copy: stand in a folder, look for modules there first, have these variables."""
    os.chdir(folder)
    sys.path[:0] = path
    os.environ.update(env)
