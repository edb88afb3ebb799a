"""The process that reads what was handed in: takes one request, limits itself, answers, ends."""

from __future__ import annotations

import json
import os
import signal
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any, Final

from grader.errors import SubmissionError, UsageError
from grader.language.phrase import say
from grader.submission import answer, encoding, limits, unpacking, whole
from grader.submission.finding import find
from grader.submission.folder import shown
from grader.submission.imports import read_imports
from grader.submission.start import Whole

_STDOUT: Final = 1
_SHORT_OF_MEMORY: Final = answer.short_of_memory()  # made while there is some


def main() -> None:
    """Answer the request that comes on the standard input; without one, end."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)  # Ctrl-C is for the grader, which ends us
    request = sys.stdin.buffer.readline()
    if request:
        limits.take()
        _say(_answer(json.loads(request)))
        os._exit(0)  # nothing is left to be done, and to take a large tree apart takes long


def _answer(request: dict[str, Any]) -> bytes:
    os.chdir(request["cwd"])
    path, scratch = Path(request["path"]), Path(request["scratch"])
    _tell_what_is_read(path if path.is_dir() else path.parent, *unpacking.places(scratch))
    try:
        if not request["is_started"]:
            return answer.found(whole.find(path, request["executable"], scratch))
        found = find(path, request["executable"], scratch, request["usual"])
        only = None if path.is_dir() or path.suffix != ".py" else found.root / path.name
        assert not isinstance(found.start, Whole)
        imports = read_imports(found.root, found.start, only)
        refused = encoding.faults(imports.files, found.root)
        return answer.found(replace(found, imports=imports, notes=(*refused, *found.notes)))
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
