"""Compare the hand-ins of a class, and write similar.html and similar.jsonl.

It reads entry.json and similar.json of each hand-in. The same class gives the same bytes. The page
is self-contained, has no script, and the style of a report's page.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import asdict, dataclass
from functools import cache
from pathlib import Path
from typing import Any, Final

import jinja2

from grader import files
from grader.batch.entry import Entry
from grader.batch.page.students import Student, students
from grader.batch.similar import sources
from grader.batch.similar.compare import LARGE_CLASS, ONE_IN, Compared, Comparison, Pair, compare
from grader.batch.similar.features import Features
from grader.exercise.exercise import Exercise
from grader.message import Message, msg
from grader.reports.page import templating
from grader.translations import tr, translate

PAGE: Final = "similar.html"
LINES: Final = "similar.jsonl"
SCHEMA: Final = "turtlesim-grader/pair/v2"
_TEMPLATES = Path(__file__).parent / "templates"


@dataclass(frozen=True)
class Class:
    """A class, and its similar hand-ins.

    Attributes:
        students: those who handed in something.
        comparison: its numbers are indices of `students`.
        only_given: numbers of those who handed in only what everybody was given.
    """

    students: tuple[Student, ...]
    comparison: Comparison
    only_given: tuple[int, ...]


def write(entries: Sequence[Entry], exercise: Exercise, out: Path) -> None:
    """Write both files into the folder of a class.

    Raises:
        UsageError: they cannot be written.
        ExerciseError, OSError: as `compare_class`.
    """
    found = compare_class(entries, exercise)
    page = _environment().get_template("similar.html")
    html = page.render(found=found, exercise=translate(exercise.title))
    files.put(out / PAGE, html.encode("utf-8"))
    rows = (json.dumps(_row(found, pair), ensure_ascii=False) for pair in found.comparison.pairs)
    files.put(out / LINES, "".join(f"{row}\n" for row in rows).encode("utf-8"))


def compare_class(entries: Sequence[Entry], exercise: Exercise) -> Class:
    """Compare the hand-ins of a class.

    Args:
        entries: from `grader.batch.entry.entries`.

    Raises:
        ExerciseError, OSError: the given files cannot be read.
    """
    given = _hashes(sources.given_files(exercise))

    def is_given(found: Features) -> bool:
        """Whether a hand-in is what everybody was given, in a package with the name of a folder."""
        own = {file.sha256 for file in found.files} - given
        folders = {part for file in found.files for part in Path(file.name).parts[:-1]}
        return not own or any(own <= _hashes(sources.starter(exercise, each)) for each in folders)

    by_id = {student.entry.id: student for student in students(entries)}
    present = [entry for entry in entries if entry.state != "nothing"]
    found = [Features.read(entry.folder) for entry in present]
    only_given = tuple(
        number for number, each in enumerate(found) if each and each.files and is_given(each)
    )
    compared = [
        Compared("" if number in only_given else _content(entry, each), each)
        for number, (entry, each) in enumerate(zip(present, found, strict=True))
    ]
    return Class(tuple(by_id[entry.id] for entry in present), compare(compared), only_given)


def _hashes(given: Iterable[sources.File]) -> set[str]:
    return {hashlib.sha256(each.data).hexdigest() for each in given}


def _content(entry: Entry, found: Features | None) -> str:
    """Return a key of the content: of the Python files, else of everything."""
    if found is not None and found.files:
        return "\n".join(sorted(file.sha256 for file in found.files))
    return entry.key


def _row(found: Class, pair: Pair) -> dict[str, Any]:
    """Return what a line of JSON tells of a pair."""
    data = asdict(pair)
    ids = [found.students[data.pop(name)].entry.id for name in ("first", "second")]
    return {"schema": SCHEMA, "ids": ids, **data}


@cache
def _environment() -> jinja2.Environment:
    made = templating.environment(_TEMPLATES, "similar")
    made.globals.update(
        facts=_facts,
        headline=_headline,
        export=f"{sources.FOLDER}/",
        large_class=LARGE_CLASS,
        one_in=ONE_IN,
    )
    return made


def _headline(pair: Pair) -> str:
    return tr("the same files, byte for byte") if pair.same_content else tr("the same behaviour")


def _facts(size: int, pair: Pair) -> Iterator[tuple[str, str, str]]:
    """Yield in which respects two are alike: what, how, and how usual that is in the class."""
    if pair.same_content:
        same = tr("The Python files are the same, byte for byte.")
        yield tr("What was handed in"), same, ""
    how = tr(
        "{share} of them are equal, one by one; those of the first {seconds:.2f} s are the same.",
        share=_percent(pair.equal_commands),
        seconds=pair.equal_s,
    )
    usual = tr("As a whole they are not alike.")
    if pair.commands_hands:
        usual = _hands(size, pair.commands_hands, msg("send such commands"))
    yield tr("Commands"), how, usual
    if pair.path_mm is not None:
        how = tr("{m:.3f} m apart, as a mean along the way.", m=pair.path_mm / 1000)
        usual = _hands(size, pair.path_hands, msg("went as near one of the two"))
        yield tr("Way"), how, usual


def _hands(size: int, hands: int, what: Message) -> str:
    if hands <= 2:
        return tr("Of {size:,} hand-ins no others {what}.", size=size, what=what)
    return tr(
        "Of {size:,} hand-ins {hands:,} {what}, these two among them.",
        size=size,
        hands=hands,
        what=what,
    )


def _percent(share: float) -> str:
    """Format a share: 100 % is exactly all, and 0 % exactly nothing."""
    value = f"{100 * share:.0f}"
    if float(value) >= 100 and share < 1:
        return tr("more than {share} %", share="99")
    if share and not float(value):
        return tr("less than {share} %", share="1")
    return tr("{share} %", share=value)
