"""Show a regrade: in the terminal, as one self-contained HTML page, and as CSV.

The table has a row for each check of each hand-in that changes, or is not judged again.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from urllib.parse import quote

import jinja2
from rich.console import Console
from rich.table import Table
from rich.text import Text

from grader.batch.entry import SUBMISSIONS, Entry
from grader.batch.regrade.changes import ChangedEntry, Difference, OfCheck, Regrade
from grader.reports.csv import cell
from grader.reports.csv import table as as_csv
from grader.reports.page import templating
from grader.reports.wording import WORDS, points, word
from grader.result.result import PAGE
from grader.text import clip, for_terminal, number, one_line, plain
from grader.translations import tr, tr_many, translate

#: Hand-ins in the terminal, and on the page, which a browser must open fast. The table has all.
MOST, MOST_ON_PAGE = 40, 2000
_MOST_WHYS = 5
_LONGEST = 160
_TEMPLATES = Path(__file__).parent / "templates"
_LONGEST_ON_PAGE = 600
HEADER: tuple[object, ...] = (
    *("id", "name", "before", "after", "change"),
    *("check", "check_before", "check_after", "check_change", "verdict_before", "verdict_after"),
    "why",
)
NOT_JUDGED_AGAIN = "not judged again"
_LONGEST_IN_TABLE = 1000


def show(found: Regrade, console: Console) -> None:
    """Print a regrade."""
    console.print(_text(found.headline, "bold"), soft_wrap=True)
    for note in found.more_notes:
        console.print(_text(tr("Note: {flag}", flag=note)), soft_wrap=True)
    if found.changes:
        console.print()
        console.print(_checks(found))
        console.print()
        console.print(_people(found))
        rest = len(found.changes) - MOST
        if rest > 0:
            more = tr_many(
                "… and {n:,} more hand-in: see the table or the page.",
                "… and {n:,} more hand-ins: see the table or the page.",
                rest,
            )
            console.print(_text(more))
    _failures(found, console)


def signed(value: float) -> str:
    """Return a change of points with its sign: '+5', '-2.5', '0'."""
    return f"+{points(value)}" if value > 0 else points(value) if value else "0"


def verdicts(each: Difference) -> str:
    """Return the verdicts before and after: 'passed → failed'; '' where they are the same."""
    before = tr("new") if each.before is None else word(each.before)
    after = tr("gone") if each.after is None else word(each.after)
    return "" if before == after else f"{before} → {after}"


def _checks(found: Regrade) -> Table:
    table = _table(tr("check"), tr("more"), tr("fewer"), tr("in all"))
    for each in found.of_checks:
        table.add_row(_name(each), str(each.gain), str(each.lose), signed(each.points))
    return table


def _name(each: OfCheck) -> Text:
    name = _text(translate(each.title), "bold")
    return Text.assemble(name, _text(f" ({each.check})", "dim")) if each.check else name


def _people(found: Regrade) -> Table:
    table = _table(tr("hand-in"), tr("before"), tr("after"), tr("change"))
    table.add_column(tr("check and why"))
    for change in found.changes[:MOST]:
        differences = [_described(each) for each in change.differences]
        points_now = (_score(change.before), _score(change.after), signed(change.points))
        table.add_row(_who(change), *points_now, Text("\n").join(differences))
    return table


def _table(first: str, *numbers: str) -> Table:
    table = Table(box=None, pad_edge=False, header_style="dim")
    table.add_column(first, overflow="fold")
    for name in numbers:
        table.add_column(name, justify="right", no_wrap=True)
    return table


def _who(change: ChangedEntry) -> Text:
    entry = change.before
    name = clip(one_line(entry.hand_in.name), 40)
    return _text(entry.id if name == entry.id else f"{entry.id} {name}")


def _described(each: Difference) -> Text:
    head = " ".join(part for part in (each.check, verdicts(each), signed(each.points)) if part)
    return Text.assemble(_text(head, "bold"), _text(f": {clip(one_line(each.why), _LONGEST)}"))


def _score(entry: Entry) -> str:
    return "" if entry.score is None else points(entry.score)


def _failures(found: Regrade, console: Console) -> None:
    if not found.failures:
        return
    console.print()
    counts = Counter(failure.why for failure in found.failures)
    for why, times in counts.most_common(_MOST_WHYS):
        first = next(failure.entry.id for failure in found.failures if failure.why == why)
        if times > 1:
            first = tr("{first} and {more} others", first=first, more=times - 1)
        text = tr(
            "Not judged again, and left as it is: {who}: {why}",
            who=first,
            why=clip(one_line(translate(why)), 300),
        )
        console.print(_text(text, "red"), soft_wrap=True)
    if len(counts) > _MOST_WHYS:
        more = tr("… for {more} other reasons: see the table.", more=len(counts) - _MOST_WHYS)
        console.print(_text(more, "red"))


def _text(value: str, style: str = "") -> Text:
    return Text(for_terminal(value), style)


def page(found: Regrade, to_class: str) -> str:
    """Return the page.

    Args:
        to_class: the path from the page to the folder of the class, for links to reports.
    """
    template = _environment().get_template("regrade.html")
    return template.render(
        found=found,
        title=plain(translate(found.exercise.title)),
        checks=found.of_checks,
        changes=found.changes[:MOST_ON_PAGE],
        failures=found.failures[:MOST_ON_PAGE],
        link=lambda id: f"{to_class}/{SUBMISSIONS}/{quote(id, safe='')}/{PAGE}",
    )


@cache
def _environment() -> jinja2.Environment:
    made = templating.environment(_TEMPLATES, "regrade")
    made.filters.update(
        signed=signed,
        verdicts=verdicts,
        text=lambda value: clip(one_line(plain(value)), _LONGEST_ON_PAGE),
    )
    return made


def table(found: Regrade) -> str:
    """Return the table; its columns are those of `HEADER`."""
    rows = [HEADER, *(row for change in found.changes for row in _rows(change))]
    for failure in found.failures:
        score = _points(failure.entry.score)
        why = cell(clip(f"{NOT_JUDGED_AGAIN}: {failure.why!s}", _LONGEST_IN_TABLE))
        rows.append((*_whose(failure.entry), score, score, 0, *[""] * 6, why))
    return as_csv(rows)


def _rows(change: ChangedEntry) -> Iterator[tuple[object, ...]]:
    scores = _points(change.before.score), _points(change.after.score), number(change.points)
    for each in change.differences:
        why = cell(clip(each.why, _LONGEST_IN_TABLE))
        yield (*_whose(change.before), *scores, *_check(each), why)


def _whose(entry: Entry) -> list[str]:
    return [cell(entry.id), cell(entry.hand_in.name)]


def _check(each: Difference) -> list[object]:
    old, new = (number(v.score) if v else "" for v in (each.before, each.after))
    verdicts = [str(WORDS[v.status]) if v else "" for v in (each.before, each.after)]
    return [cell(each.check or each.title), old, new, number(each.points), *verdicts]


def _points(score: float | None) -> float | int | str:
    return "" if score is None else number(score)
