"""The process that reads what was handed in: each in a fork of itself, which limits itself."""

from __future__ import annotations

import gc
import json
import os
import select
import signal
import sys
import time
from dataclasses import replace
from pathlib import Path
from typing import Any, Final, NoReturn

from grader.errors import SubmissionError, UsageError
from grader.language.phrase import say
from grader.submission import answer, encoding, limits, slips, unpacking, whole
from grader.submission.finding import find, find_inspected, in_archive
from grader.submission.folder import shown
from grader.submission.imports import read_imports
from grader.submission.set_ups import NotInspected
from grader.submission.start import Submission, Whole

_STDIN, _STDOUT, _STDERR = range(3)
_SHORT_OF_MEMORY: Final = answer.short_of_memory()  # made while there is some


def main() -> None:
    """Answer the requests that come on the standard input, a line each; end with it."""
    gc.freeze()  # to look through it all would copy it into each fork
    while line := sys.stdin.buffer.readline():
        request = json.loads(line)
        _say(_forked(request))


def _forked(request: dict[str, Any]) -> bytes:
    """What a fork of this process says to a request, and how it ends."""
    here, there = os.pipe()
    if not (pid := os.fork()):
        _be_fork(request, there)
    os.close(there)
    at, last = _heard(here, time.monotonic() + limits.WALL_S)
    is_late = not select.select([here], [], [], 0)[0]  # else it has hung up
    if is_late:
        os.kill(pid, signal.SIGKILL)
    os.close(here)
    code = os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1])
    return answer.ended(at, last, -signal.SIGALRM if is_late else code)


def _heard(here: int, deadline: float) -> tuple[str, bytes]:
    """Where it was and what it said last, when it hangs up or its time is over."""
    at, last, rest = b"", b"", b""
    while select.select([here], [], [], max(deadline - time.monotonic(), 0))[0]:
        if not (some := os.read(here, 2**16)):
            break
        *lines, rest = (rest[: answer.MAX_BYTES] + some).split(b"\n")
        for line in lines:
            if line.startswith(answer.AT):
                at = line.removeprefix(answer.AT)
            else:
                last = line
    return at.decode("ascii", "replace"), rest or last


def _be_fork(request: dict[str, Any], there: int) -> NoReturn:
    """Answer, with nothing in reach of what the other requests come and are answered by."""
    os.dup2(os.open(os.devnull, os.O_RDONLY), _STDIN)
    for stream in (_STDOUT, _STDERR):
        os.dup2(there, stream)
    limits.take()
    _say(_answer(request))
    os._exit(0)  # nothing is left to be done, and to take a large tree apart takes long


def _answer(request: dict[str, Any]) -> bytes:
    os.chdir(request["cwd"])
    path, scratch = Path(request["path"]), Path(request["scratch"])
    _tell_what_is_read(path if path.is_dir() else path.parent, *unpacking.places(scratch))
    try:
        if not request["is_started"]:
            return answer.found(whole.find(path, request["executable"], scratch))
        found = _found(request, path, scratch)
        only = None if path.is_dir() or path.suffix != ".py" else found.root / path.name
        assert not isinstance(found.start, Whole)
        imports = read_imports(found.root, found.start, only)
        refused = encoding.faults(imports.files, found.root)
        notes, shows = (*refused, *found.notes), slips.look(found.root, imports.files)
        return answer.found(replace(found, imports=imports, notes=notes, slips=shows))
    except NotInspected as asks:
        return answer.asks(asks)
    except (SubmissionError, UsageError) as error:
        return answer.refused(error)
    except OSError as error:
        return answer.unable(error)
    except RecursionError:
        name = shown(path.name or path.resolve().name)
        return answer.refused(
            SubmissionError(say("{name} is nested too deeply to be read.", name=name))
        )
    except MemoryError:
        return _SHORT_OF_MEMORY
    except Exception:
        import traceback  # here: most submissions are read without

        return answer.failed(traceback.format_exc())


def _found(request: dict[str, Any], path: Path, scratch: Path) -> Submission:
    """What to start, by the rules; of a package, by what an inspection has said."""
    executable, usual = request["executable"], request["usual"]
    if request["inspected"] is None:
        return find(path, executable, scratch, usual)
    from grader.scenes.package import inspection  # here: most submissions need none

    said = inspection.decode(request["inspected"].encode("ascii"))
    name = path.name or path.resolve().name
    found = find_inspected(Path(request["base"]), name, executable, scratch, usual, said)
    for archive in request["inside"]:
        found = in_archive(found, archive)
    return found


def _tell_what_is_read(*folders: Path) -> None:
    """Say before any file of these folders is opened which one it is.

    It may be the last thing that is said.
    """
    bases = [str(folder.resolve()) + os.sep for folder in folders]

    def note(event: str, arguments: tuple[Any, ...]) -> None:
        if event == "open" and isinstance(arguments[0], str):
            for base in bases:
                if arguments[0].startswith(base):
                    _say(answer.at(arguments[0].removeprefix(base)))

    sys.addaudithook(note)


def _say(line: bytes) -> None:
    while line:
        line = line[os.write(_STDOUT, line) :]
