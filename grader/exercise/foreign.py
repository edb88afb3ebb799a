"""Running an author's code in our process: its prints and its current folder stay its own."""

from __future__ import annotations

import contextlib
import os
import sys
import threading
from collections.abc import Iterator
from pathlib import Path

# Standard output and the current folder belong to the whole process; two that change them and
# change them back at the same time would leave them changed.
_one_at_a_time = threading.RLock()


@contextlib.contextmanager
def contained() -> Iterator[None]:
    """What is printed goes to standard error; the current folder is the same afterwards.

    Standard output may be a result that a program reads, and paths of the command line may be
    relative.
    """
    with _one_at_a_time, contextlib.redirect_stdout(sys.stderr):
        before: Path | None
        try:
            before = Path.cwd()
        except OSError:  # it was deleted
            before = None
        try:
            yield
        finally:
            if before is not None:
                with contextlib.suppress(OSError):
                    os.chdir(before)
