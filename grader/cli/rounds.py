"""Gradings one after the other, for somebody who saves, looks, and saves again: `--watch`."""

from __future__ import annotations

import argparse
import time
from typing import TYPE_CHECKING

from rich.console import Console
from rich.text import Text

from grader.cli import error_file, grade_one
from grader.errors import GraderError
from grader.language.telling import tell, told
from grader.reports.wording import points as shown
from grader.result.result import Result
from grader.result.visible import student_view
from grader.text import for_terminal

if TYPE_CHECKING:
    from grader.cli.live import Live


class Rounds:
    """What has been graded so far.

    Args:
        args: of `grader run`.
        live: shows the runs while they go on.
    """

    def __init__(self, args: argparse.Namespace, live: Live | None = None) -> None:
        self._args = args
        self._live = live
        self._last: Result | None = None
        self._is_first = True

    def grade(self) -> None:
        """Grade once more; what cannot be used now may be usable after the next save."""
        console, messages = Console(highlight=False), Console(stderr=True, highlight=False)
        if not self._is_first and console.is_terminal:
            console.clear()
        self._is_first = False
        error_file.prepare(self._args)
        try:
            result = grade_one.graded(self._args, self._live)
        except GraderError as error:
            messages.print(Text(for_terminal(told(error.message))), soft_wrap=True)
            error_file.write(error, self._args)
        else:
            seen = student_view(result)
            said = f"{time.strftime('%H:%M:%S')}  {change(self._last, seen)}"
            console.print(Text(said, "bold"), soft_wrap=True)
            self._last = seen
        messages.print(tell("Waiting for the next save; Ctrl-C ends."), style="dim")


def change(last: Result | None, result: Result) -> str:
    """What a score is compared with the last one: '62 -> 80 (+18)'."""
    score = shown(result.score)
    if last is None:
        return tell("{score} of {max_score}", score=score, max_score=shown(result.max_score))
    by = round(result.score - last.score, 2)
    sign = "+" if by > 0 else ""
    return (
        f"{shown(last.score)} -> {score} ({sign}{shown(by)})"
        if by
        else tell("{score}, as before", score=score)
    )
