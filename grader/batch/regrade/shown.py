"""A regrade in the terminal: the line that counts, the checks, and who changes."""

from __future__ import annotations

from collections import Counter

from rich.console import Console
from rich.table import Table
from rich.text import Text

from grader.batch.entry import Entry
from grader.batch.regrade.changes import Change, Difference, OfCheck, Regrade
from grader.language.telling import tell, tell_many, told
from grader.reports.wording import points, word
from grader.text import clip, for_terminal, one_line

#: More hand-ins are in the table and on the page only.
MOST = 40
_MOST_WHYS = 5
_LONGEST = 160


def show(found: Regrade, console: Console) -> None:
    """Print it."""
    console.print(_text(found.headline, "bold"), soft_wrap=True)
    for note in found.more_notes:
        console.print(_text(tell("Note: {flag}", flag=note)), soft_wrap=True)
    if found.changes:
        console.print()
        console.print(_checks(found))
        console.print()
        console.print(_people(found))
        rest = len(found.changes) - MOST
        if rest > 0:
            more = tell_many(
                "… and {n:,} more hand-in: see the table or the page.",
                "… and {n:,} more hand-ins: see the table or the page.",
                rest,
            )
            console.print(_text(more))
    _failures(found, console)


def signed(value: float) -> str:
    """Points that somebody gets more, or less: '+5', '-2.5', '0'."""
    return f"+{points(value)}" if value > 0 else points(value) if value else "0"


def verdicts(each: Difference) -> str:
    """What was said of a check and what is: 'passed → failed'; '' where it is the same."""
    said = [tell("new") if each.before is None else word(each.before)]
    said.append(tell("gone") if each.after is None else word(each.after))
    return "" if said[0] == said[1] else " → ".join(said)


def _checks(found: Regrade) -> Table:
    table = _table(tell("check"), tell("more"), tell("fewer"), tell("in all"))
    for each in found.of_checks:
        table.add_row(_name(each), str(each.gain), str(each.lose), signed(each.points))
    return table


def _name(each: OfCheck) -> Text:
    name = _text(told(each.title), "bold")
    return Text.assemble(name, _text(f" ({each.check})", "dim")) if each.check else name


def _people(found: Regrade) -> Table:
    table = _table(*_headings(), last="left")
    for change in found.changes[:MOST]:
        told = [_told(each) for each in change.differences]
        points_now = (_score(change.before), _score(change.after), signed(change.points))
        table.add_row(_who(change), *points_now, Text("\n").join(told))
    return table


def _headings() -> tuple[str, ...]:
    return (
        tell("hand-in"),
        tell("before"),
        tell("after"),
        tell("change"),
        tell("check and why"),
    )


def _table(first: str, *others: str, last: str = "right") -> Table:
    table = Table(box=None, pad_edge=False, header_style="dim")
    table.add_column(first, overflow="fold")
    for name in others[:-1]:
        table.add_column(name, justify="right", no_wrap=True)
    table.add_column(others[-1], justify="left" if last == "left" else "right")
    return table


def _who(change: Change) -> Text:
    entry = change.before
    name = clip(one_line(entry.hand_in.name), 40)
    return _text(entry.id if name == entry.id else f"{entry.id} {name}")


def _told(each: Difference) -> Text:
    head = " ".join(part for part in (each.check, verdicts(each), signed(each.points)) if part)
    return Text.assemble(_text(head, "bold"), _text(f": {clip(one_line(each.why), _LONGEST)}"))


def _score(entry: Entry) -> str:
    return "" if entry.score is None else points(entry.score)


def _failures(found: Regrade, console: Console) -> None:
    if not found.failures:
        return
    console.print()
    said = Counter(failure.why for failure in found.failures)
    for why, number in said.most_common(_MOST_WHYS):
        first = next(failure.entry.id for failure in found.failures if failure.why == why)
        if number > 1:
            first = tell("{first} and {more} others", first=first, more=number - 1)
        text = tell(
            "Not judged again, and left as it is: {who}: {why}",
            who=first,
            why=clip(one_line(told(why)), 300),
        )
        console.print(_text(text, "red"), soft_wrap=True)
    if len(said) > _MOST_WHYS:
        console.print(_text(_more_reasons(len(said) - _MOST_WHYS), "red"))


def _more_reasons(more: int) -> str:
    return tell("… for {more} other reasons: see the table.", more=more)


def _text(value: str, style: str = "") -> Text:
    return Text(for_terminal(value), style)
