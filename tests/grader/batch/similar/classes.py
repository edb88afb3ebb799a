"""Classes for tests: hand-ins with sources and behaviour, as a grading leaves them on disk."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from grader.batch.entry import SUBMISSIONS, Entry, HandIn, Person, entries
from grader.batch.similar import features, sources
from grader.batch.similar.page import Class, compare_class
from grader.exercise.loading import load_exercise
from grader.recording.recording import Recording
from grader.recording.subject import load_subject

SUBMITTED = Path(__file__).parents[3] / "submissions"
CHALLENGE = load_exercise("turtlesim_challenge")
#: Right solutions that were written each in its own way.
HONEST = {
    "quick": SUBMITTED / "quick_spiral.py",
    "timer": SUBMITTED / "styles" / "timer.py",
    "functions": SUBMITTED / "similar" / "functions.py",
    "states": SUBMITTED / "similar" / "states.py",
    "loop": SUBMITTED / "similar" / "loop.py",
    "parts": SUBMITTED / "similar" / "parts",
    "launched": SUBMITTED / "launched" / "spiral",
}


def text(name: str) -> str:
    """The source of an honest solution that is one file."""
    return HONEST[name].read_text(encoding="utf-8")


def hand_in(
    out: Path,
    who: str,
    handed_in: Path | Mapping[str, str | bytes],
    nominal: Recording | None = None,
    name: str = "",
) -> Entry:
    """What a worker leaves of a hand-in, but for its result.

    Args:
        handed_in: a file, a folder, or the names and contents of files.
        nominal: its run; else one in which it did nothing.
    """
    nominal = nominal or Recording(load_subject("turtlesim").untouched(None))
    folder = out / SUBMISSIONS / who
    if isinstance(handed_in, Path):
        kept = _files(handed_in)
    else:
        kept = {n: t.encode() if isinstance(t, str) else t for n, t in handed_in.items()}
    copy = out.parent / "copies" / who
    copy.mkdir(parents=True)
    for file, data in kept.items():
        (copy / file).parent.mkdir(parents=True, exist_ok=True)
        (copy / file).write_bytes(data)
    left_out = sources.keep(copy, folder / sources.SOURCE)
    made = features.features_file(folder / sources.SOURCE, nominal, left_out)
    (folder / features.NAME).write_bytes(made)
    entry = Entry(HandIn(who, (Person(who, name),)), "failed", 100.0, folder=folder)
    entry.put()
    return entry


def looked_at(out: Path) -> Class:
    """The class in a folder, looked at together."""
    return compare_class(entries(out), CHALLENGE)


def _files(path: Path) -> dict[str, bytes]:
    if path.is_file():
        return {path.name: path.read_bytes()}
    below = (each for each in path.rglob("*.py") if "__pycache__" not in each.parts)
    return {each.relative_to(path).as_posix(): each.read_bytes() for each in below}
