"""`grader batch --regrade DIR --exercise NEW.yaml [--apply]`: the effects of a changed rubric."""

from __future__ import annotations

from argparse import Namespace
from contextlib import nullcontext
from pathlib import Path

from rich.console import Console

from grader.cli import GRADER_FAILED, JUDGED, say
from grader.exercise import View
from grader.system import files
from grader.text import msg
from grader_class import regrade
from grader_class.class_file import ClassFile
from grader_class.store import Store

#: Of the hand-ins that could not be judged again, so many are listed; the table has all.
_MOST_FAILURES = 20


def run(args: Namespace, jobs: int, view: View) -> int:
    """Print the effects of a changed rubric on a class as CSV, and with --apply write them.

    The table is also written into --out, or into the folder of the class. The exit code is 3 if
    some could not be judged again.
    """
    out, folder = Path(args.regrade), Path(args.out or args.regrade)
    messages, of_class = Console(stderr=True, highlight=False), ClassFile.read(out)
    path = args.exercise or of_class.exercise
    say(messages, msg("judging {n} hand-ins again ...", n=of_class.hand_ins))
    with Store.opened(out) if args.apply else nullcontext() as store:
        found = regrade.regrade(out, path, jobs, store)
        files.make_folder(folder)
        files.put(folder / regrade.CHANGES, found.table.encode("utf-8"))
        print(found.table, end="", flush=True)
        if store is not None:
            regrade.apply(found, store, view, args.assignment)
    say(messages, found.headline)
    for note in found.notes:
        say(messages, msg("Note: {flag}", flag=note))
    for entry, why in found.failures[:_MOST_FAILURES]:
        say(messages, msg("Left as it is, not judged again: {who}: {why}", who=entry.id, why=why))
    if store is None:
        say(messages, msg("The class was not changed. To change it: the same call with --apply"))
    return GRADER_FAILED if found.failures else JUDGED
