"""Say what is going on while a run takes its time."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rich.console import Console

from grader.language.telling import tell

#: Where no line can be overwritten, as in a CI log, one is printed this often [simulated s].
LINE_EVERY_S = 10.0


@contextmanager
def shown(console: Console, what: str) -> Iterator[Callable[[float], None]]:
    """Show `what` and the simulated seconds; yields the function that takes them."""
    if console.is_terminal:
        with console.status(what) as status:
            yield lambda seconds: status.update(
                tell("{what}: {seconds:.0f} s simulated", what=what, seconds=seconds)
            )
        return
    due = LINE_EVERY_S

    def line(seconds: float) -> None:
        nonlocal due
        if seconds >= due:
            due = seconds + LINE_EVERY_S
            console.print(
                tell("{what}: {seconds:.0f} s simulated", what=what, seconds=seconds),
                soft_wrap=True,
            )

    yield line
