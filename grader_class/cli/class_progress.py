"""Show the progress of a class: a bar in a terminal, lines in a log; and print a summary."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from statistics import mean

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

from grader.cli import say
from grader.reports.wording import points
from grader.text import Message, clip, for_terminal, msg, tr, translate
from grader_class.batch import Planned
from grader_class.entry import Entry, HandIn, State
from grader_class.store import Store

#: The time that is left follows from the speed within the last so many [s].
SPEED_OF_S = 3600.0
_STATES: dict[State, Message] = {
    "judged": msg("judged"),
    "unusable": msg("cannot be started"),
    "nothing": msg("handed in nothing"),
    "failed": msg("where the grader failed"),
}


@contextmanager
def shown(console: Console, planned: Planned, store: Store) -> Iterator[Callable[[HandIn], None]]:
    """Show the progress; yield the function to call with each finished hand-in."""
    total, before = planned.hand_ins, len(planned.done)
    if planned.alike:
        alike = tr(
            "{n:,} hand-in not run: the same content has been run already.",
            "{n:,} hand-ins not run: the same content has been run already.",
            n=planned.alike,
        )
        console.print(alike)
    if before:
        graded = tr(
            "{n:,} hand-in of {total} graded before.",
            "{n:,} hand-ins of {total} graded before.",
            n=before,
            total=total,
        )
        console.print(graded)
    if console.is_terminal:
        with _bar(console, planned, store) as show:
            yield show
        return
    over = before

    def line(hand_in: HandIn) -> None:
        nonlocal over
        over += 1
        outcome = _outcome(Entry.read(store.student(hand_in.id)))
        say(console, f"[{over}/{total}] {hand_in.known_as}: {outcome}")

    yield line


@contextmanager
def _bar(console: Console, planned: Planned, store: Store) -> Iterator[Callable[[HandIn], None]]:
    failed = 0
    with Progress(
        TextColumn(tr("{done} of {total}", done="{task.completed}", total="{task.total}")),
        BarColumn(),
        TextColumn("{task.fields[failed]}", style="red"),
        TimeRemainingColumn(),
        TextColumn("{task.description}"),
        console=console,
        transient=True,
        speed_estimate_period=SPEED_OF_S,
    ) as progress:
        # those that need no run are over at once, and tell nothing of the time that runs take
        done = len(planned.done) + len(planned.trivial)
        bar = progress.add_task("", total=planned.hand_ins, completed=done, failed="")

        def show(hand_in: HandIn) -> None:
            nonlocal failed
            if hand_in.path is None:
                return
            entry = Entry.read(store.student(hand_in.id))
            failed += entry.state == "failed"
            progress.update(
                bar,
                advance=1,
                failed=tr("{failed} failed", failed=failed) if failed else "",
                description=clip(for_terminal(f"{hand_in.known_as}: {_outcome(entry)}"), 60),
            )

        yield show


def summarise(console: Console, entries: Sequence[Entry], out: Path) -> None:
    """Print the numbers of hand-ins by state, their mean score, and what failed."""
    states = Counter(entry.state for entry in entries)
    counts = ", ".join(
        tr("{number} {state}", number=states[state], state=what)
        for state, what in _STATES.items()
        if states[state]
    )
    summary = tr(
        "{n:,} hand-in: {counts}.", "{n:,} hand-ins: {counts}.", n=len(entries), counts=counts
    )
    console.print(summary)
    scores = [e.score for e in entries if e.state == "judged" and e.score is not None]
    if scores:
        of = {"points": points(round(mean(scores), 2)), "most": points(entries[0].max_score)}
        console.print(tr("Mean of those judged: {points} of {most}.", **of))
    for entry in entries:
        if entry.state == "failed":
            text = tr(
                "The grader failed for {id}; nobody is to blame for it: {message}",
                id=entry.hand_in.known_as,
                message=entry.message,
            )
            say(console, text, "red")
    if states["failed"]:
        console.print(tr("Once more for these: the same call with --again failed"))
    say(console, tr("The class: {out}", out=out))


def _outcome(entry: Entry) -> str:
    if entry.state == "judged" and entry.score is not None:
        score, most = points(entry.score), points(entry.max_score)
        return tr("{score} of {max_score}", score=score, max_score=most)
    state = _STATES[entry.state]
    if not entry.message:
        return translate(state)
    return tr("{state}: {message}", state=state, message=entry.message)
