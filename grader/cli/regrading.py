"""`grader batch --regrade DIR --exercise NEW.yaml [--apply]`: what a changed rubric changes."""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn
from rich.text import Text

from grader import files
from grader.batch.entry import Entry
from grader.batch.regrade import applying, html, judging, shown, table
from grader.batch.regrade.applying import CHANGES_CSV, CHANGES_PAGE
from grader.batch.regrade.changes import Regrade
from grader.batch.store import BEFORE, Store
from grader.language.telling import tell, tell_many
from grader.result.visible import View
from grader.text import for_terminal

#: Where the table and the page come, in the folder of the class.
REGRADE = "regrade"
DONE, GRADER_FAILED = 0, 3


def run(args: Namespace, jobs: int, view: View) -> int:
    """Show what a changed rubric changes in the folder of a class, and write it if that is asked.

    The table and the page come into --out, or into the folder REGRADE of the class.

    Returns:
        The exit code: 0; or 3 if some could not be judged again.

    Raises:
        UsageError: it is no folder of a class, is graded just now, or something cannot be written.
        ExerciseError: the exercise cannot be used.
    """
    out: Path = args.regrade
    into: Path = args.out or out / REGRADE
    console, messages = Console(highlight=False), Console(stderr=True, highlight=False)
    if not args.apply:
        found = _found(out, args.exercise, jobs, messages)
        shown.show(found, console)
        _write(found, into, console)
        console.print(
            tell("Nothing of the class was changed. To write it: the same call with --apply")
        )
        return GRADER_FAILED if found.failures else DONE
    judging.check(out, args.exercise)
    with Store.opened(out) as store:
        found = _found(out, args.exercise, jobs, messages)
        shown.show(found, console)
        _write(found, into, console)
        with _progress(messages, len(found.entries), tell("writing")) as show:
            failures = applying.apply(found, store, jobs, show, view, args.assignment)
        for failure in failures:
            text = tell("Left as it is: {id}: {why}", id=failure.entry.id, why=failure.why)
            console.print(Text(for_terminal(text), "red"), soft_wrap=True)
    console.print(
        Text(tell("Written. What was before: {before}", before=out / BEFORE)), soft_wrap=True
    )
    return GRADER_FAILED if found.failures or failures else DONE


def _found(out: Path, exercise_path: str, jobs: int, messages: Console) -> Regrade:
    judged = judging.check(out, exercise_path)
    with _progress(messages, judged, tell("judging")) as show:
        return judging.regrade(out, exercise_path, jobs, show)


def _write(found: Regrade, into: Path, console: Console) -> None:
    to_class = Path("..") if into.resolve().parent == found.out.resolve() else found.out.resolve()
    if into == found.out / REGRADE:
        files.clear(into)  # a link leads somewhere else
    files.make_folder(into)
    files.put(into / CHANGES_CSV, table.render(found).encode("utf-8"))
    files.put(into / CHANGES_PAGE, html.render(found, to_class.as_posix()).encode("utf-8"))
    console.print(Text(tell("Table and page: {into}", into=into)), soft_wrap=True)


@contextmanager
def _progress(console: Console, total: int, what: str) -> Iterator[Callable[[Entry], None]]:
    """A bar in a terminal, a line in a log."""
    if not console.is_terminal:
        console.print(
            tell_many("{what} {n:,} recording ...", "{what} {n:,} recordings ...", total, what=what)
        )
        yield lambda _: None
        return
    columns = (
        TextColumn(
            f"{what} " + tell("{done} of {total}", done="{task.completed}", total="{task.total}")
        ),
        BarColumn(),
    )
    with Progress(*columns, TimeRemainingColumn(), console=console, transient=True) as progress:
        task = progress.add_task("", total=total)
        yield lambda _: progress.update(task, advance=1)
