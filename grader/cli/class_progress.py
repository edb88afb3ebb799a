"""Say how far a class is: a bar in a terminal, a line for each hand-in in a log; and a summary."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from statistics import mean

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn
from rich.text import Text

from grader.batch.batch import Planned
from grader.batch.entry import Entry, State
from grader.batch.hand_in import HandIn
from grader.batch.store import Store
from grader.text import clip, count, for_terminal, points

MINUTE_S = 60.0
_STATES: dict[State, str] = {
    "judged": "judged",
    "unusable": "cannot be started",
    "nothing": "handed in nothing",
    "failed": "where the grader failed",
}


@contextmanager
def shown(console: Console, planned: Planned, store: Store) -> Iterator[Callable[[HandIn], None]]:
    """Show how far it is; yields the function that is told of each that is over."""
    total, before = planned.hand_ins, len(planned.done)
    if planned.alike:
        alike = count(planned.alike, "hand-in")
        console.print(f"{alike} not run: the same content has been run already.")
    if before:
        console.print(f"{count(before, 'hand-in')} of {total} graded before.")
    if console.is_terminal:
        with _bar(console, planned, store) as tell:
            yield tell
        return
    over = before

    def line(hand_in: HandIn) -> None:
        nonlocal over
        over += 1
        entry = Entry.read(store.student(hand_in.id))
        console.print(
            Text(for_terminal(f"[{over}/{total}] {hand_in.id}: {_told(entry)}")), soft_wrap=True
        )

    yield line


@contextmanager
def _bar(console: Console, planned: Planned, store: Store) -> Iterator[Callable[[HandIn], None]]:
    began = time.monotonic()
    over = failed = 0
    columns = (
        TextColumn("{task.completed} of {task.total}"),
        BarColumn(),
        TextColumn("{task.fields[rate]}"),
        TextColumn("{task.fields[failed]}", style="red"),
        TimeRemainingColumn(),
        TextColumn("{task.description}"),
    )
    with Progress(*columns, console=console, transient=True) as progress:
        task = progress.add_task(
            "", total=planned.hand_ins, completed=len(planned.done), rate="", failed=""
        )

        def tell(hand_in: HandIn) -> None:
            nonlocal over, failed
            over += 1
            entry = Entry.read(store.student(hand_in.id))
            failed += entry.state == "failed"
            a_minute = over * MINUTE_S / max(time.monotonic() - began, 1e-3)
            progress.update(
                task,
                advance=1,
                rate=f"{a_minute:.0f} a minute",
                failed=f"{failed} failed" if failed else "",
                description=clip(for_terminal(f"{hand_in.id}: {_told(entry)}"), 60),
            )

        yield tell


def summarise(console: Console, entries: Sequence[Entry], out: Path) -> None:
    """Say what came of it."""
    states = Counter(entry.state for entry in entries)
    told = ", ".join(f"{states[state]} {what}" for state, what in _STATES.items() if states[state])
    console.print(f"{count(len(entries), 'hand-in')}{f': {told}' if told else ''}.")
    scores = [
        entry.score for entry in entries if entry.state == "judged" and entry.score is not None
    ]
    if scores:
        most = points(entries[0].max_score)
        console.print(f"Mean of those judged: {points(round(mean(scores), 2))} of {most}.")
    for entry in entries:
        if entry.state == "failed":
            text = f"The grader failed for {entry.id}; nobody is to blame for it: {entry.message}"
            console.print(Text(for_terminal(text), "red"), soft_wrap=True)
    if states["failed"]:
        console.print("Once more for these: the same call with --again failed")
    console.print(Text(f"The class: {out}"), soft_wrap=True)


def _told(entry: Entry) -> str:
    if entry.state == "judged" and entry.score is not None:
        return f"{points(entry.score)} of {points(entry.max_score)}"
    return f"{_STATES[entry.state]}: {entry.message}" if entry.message else _STATES[entry.state]
