"""`grader batch --regrade DIR --exercise NEW.yaml [--apply]`: the effects of a changed rubric."""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Callable, Iterator
from contextlib import contextmanager, nullcontext
from pathlib import Path

from rich.console import Console
from rich.progress import TimeRemainingColumn

from grader import files
from grader.batch.class_file import ClassFile
from grader.batch.entry import Entry
from grader.batch.regrade import judging, shown
from grader.batch.regrade.changes import Regrade
from grader.batch.regrade.judging import CHANGES_CSV, CHANGES_PAGE
from grader.batch.store import BEFORE, REGRADE, Store
from grader.cli import GRADER_FAILED, JUDGED, class_progress, say
from grader.result.visible import View
from grader.translations import tr, tr_many


def run(args: Namespace, jobs: int, view: View) -> int:
    """Show the effects of a changed rubric on a class, and with --apply write them.

    The table and the page are written into --out, or into the folder REGRADE of the class.

    Returns:
        The exit code: 0; or 3 if some could not be judged again.

    Raises:
        UsageError: it is no folder of a class, is graded just now, or something cannot be written.
        ExerciseError: the exercise cannot be used.
    """
    out: Path = args.regrade
    into: Path = args.out or out / REGRADE
    console, messages = Console(highlight=False), Console(stderr=True, highlight=False)
    path = args.exercise or ClassFile.read(out).exercise
    judged = judging.check(out, path)
    with Store.opened(out) if args.apply else nullcontext() as store:
        with _progress(messages, judged, tr("judging")) as show:
            found = judging.regrade(out, path, jobs, show, store)
        shown.show(found, console)
        _write(found, into, console)
        if store is None:
            console.print(
                tr("Nothing of the class was changed. To write it: the same call with --apply")
            )
            return GRADER_FAILED if found.failures else JUDGED
        with _progress(messages, len(found.entries), tr("writing")) as show:
            judging.apply(found, store, show, view, args.assignment)
    say(console, tr("Written. What was before: {before}", before=out / BEFORE))
    return GRADER_FAILED if found.failures else JUDGED


def _write(found: Regrade, into: Path, console: Console) -> None:
    to_class = Path("..") if into.resolve().parent == found.out.resolve() else found.out.resolve()
    if into == found.out / REGRADE:
        files.clear(into)  # it may be a link to another folder
    files.make_folder(into)
    files.put(into / CHANGES_CSV, shown.table(found).encode("utf-8"))
    files.put(into / CHANGES_PAGE, shown.page(found, to_class.as_posix()).encode("utf-8"))
    say(console, tr("Table and page: {into}", into=into))


@contextmanager
def _progress(console: Console, total: int, what: str) -> Iterator[Callable[[Entry], None]]:
    """Show a bar in a terminal, a line in a log; yield the function to call with each entry."""
    if not console.is_terminal:
        console.print(
            tr_many("{what} {n:,} recording ...", "{what} {n:,} recordings ...", total, what=what)
        )
        yield lambda _: None
        return
    with class_progress.bar(console, what, total, TimeRemainingColumn()) as advance:
        yield lambda _: advance()
