"""What a verb prints of a result that it has just made."""

from __future__ import annotations

import os
import sys
from pathlib import Path

from rich.console import Console
from rich.text import Text

from grader.language.telling import tell
from grader.reports import Report, terminal
from grader.text import for_terminal


def show(report: Report, page: Path | None) -> None:
    """Print the verdicts, and where the page is, if one was written."""
    console = Patient()
    try:
        terminal.show(report, console)
        if page is not None:
            where = Text(for_terminal(tell("The page with picture and plots: {page}", page=page)))
            console.print(where, highlight=False, soft_wrap=True)
    except BrokenPipeError:  # rich before 13.8 leaves it to us
        console.on_broken_pipe()


class Patient(Console):
    """A console that goes on where its reader has seen enough, as `| head -1` does."""

    def on_broken_pipe(self) -> None:
        """Print nothing more: the exit code tells of the score, not of who reads."""
        self.quiet = True
        with Path(os.devnull).open("wb") as nowhere:
            os.dup2(nowhere.fileno(), sys.stdout.fileno())
