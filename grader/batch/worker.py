"""A process that grades one task after another; `grader.batch.pool` starts it.

A task comes as a line on standard input, its answer goes as a line to what was standard output. It
ends when nobody is there to ask it any more, in the middle of a task too: whoever is killed leaves
nothing behind that goes on working.
"""

from __future__ import annotations

import errno
import os
import queue
import sys
import threading
import traceback
from typing import IO

from grader.batch.task import Answer, Task
from grader.errors import CheckFailed, GraderError, NotNow, NotOffered
from grader.language.catalogue import speak
from grader.language.phrase import say
from grader.text import plain, plain_phrase

#: What a process may have run out of: another one, or the same a little later, may have it.
SCARCE = (errno.EMFILE, errno.ENFILE, errno.ENOMEM, errno.EAGAIN)


def main() -> None:
    """Serve until standard input ends."""
    # what anything prints by mistake must not look like an answer
    answers = os.fdopen(os.dup(1), "wb", buffering=0)
    os.dup2(2, 1)
    tasks: queue.SimpleQueue[bytes] = queue.SimpleQueue()
    threading.Thread(target=_listen, args=(sys.stdin.buffer, tasks), daemon=True).start()
    from grader.run.processes import watched

    watched.adopt_orphans()
    while True:
        answers.write(done(Task.from_line(tasks.get())).to_line())


def done(task: Task) -> Answer:
    """Do a task; whatever goes wrong is an answer."""
    from grader.batch.grade import make  # here: it takes long, and a line may wait meanwhile
    from grader.run.processes import levels

    try:
        speak(task.language)
        levels.only(task.isolation)
        make(task)
    except CheckFailed as error:
        return Answer("exercise", plain_phrase(error.message))
    except NotOffered as error:
        return Answer("unfit", plain_phrase(error.message))
    except NotNow as error:
        return Answer("again", plain_phrase(error.message))
    except GraderError as error:
        return Answer("failed", plain_phrase(error.message))
    except Exception as error:
        traceback.print_exc()
        what = "".join(traceback.format_exception_only(error)).strip()
        is_scarce = isinstance(error, OSError) and error.errno in SCARCE
        return Answer(
            "again" if is_scarce else "failed", say("unexpected: {what}", what=plain(what))
        )
    return Answer("done", ran=task.run is None)


def _listen(pipe: IO[bytes], tasks: queue.SimpleQueue[bytes]) -> None:
    for line in pipe:
        tasks.put(line)
    os._exit(0)
