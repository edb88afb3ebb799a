"""Wait for a submission to be saved again."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import watchfiles

#: Files whose change can change a verdict, beside Python's own. What the grader writes has others.
SETUP_FILES = (".cfg", ".toml", ".xml", ".zip")


def each_save(submission: Path) -> Iterator[None]:
    """Yield at once, and then whenever the submission has been saved; ends at Ctrl-C.

    A save that comes while the caller is busy is not lost.
    """
    # The folder of a single file is watched: many editors replace a file instead of writing it.
    folder = submission if submission.is_dir() else submission.absolute().parent
    only = None if submission.is_dir() else submission.name
    changes = watchfiles.watch(
        folder,
        watch_filter=watchfiles.PythonFilter(extra_extensions=SETUP_FILES),
        debounce=300,
        rust_timeout=100,
        yield_on_timeout=True,
        raise_interrupt=True,
    )
    next(changes)  # from here on it watches
    yield
    for changed in changes:
        if changed and (only is None or any(Path(path).name == only for _, path in changed)):
            yield
