"""The verdict table for a terminal."""

from __future__ import annotations

from typing import Any

from rich.console import Console
from rich.markup import escape
from rich.table import Table

from grader.result import Result

_MARKS = {
    "passed": "[green]passed[/]",
    "failed": "[red]failed[/]",
    "not_judged": "[yellow]not judged[/]",
}


def show(result: Result, console: Console) -> None:
    """Print the first thing to mend, the table, what each failed check saw, and the score."""
    verdicts = result["verdicts"]
    lost = [v for v in verdicts if v["status"] == "failed"]
    if lost:
        console.print(escape(lost[0]["rationale"]), style="bold", highlight=False, soft_wrap=True)
    table = Table(
        title=f"{escape(result['submission'])}: {result['exercise']}", title_justify="left"
    )
    table.add_column("check")
    table.add_column("asked for")
    table.add_column("verdict")
    table.add_column("points", justify="right")
    for verdict in verdicts:
        points = f"{verdict['score']:g} / {verdict['max_score']:g}"
        table.add_row(verdict["check"], verdict["title"], _MARKS[verdict["status"]], points)
    console.print(table)
    for verdict in lost:
        _explain(verdict, console)
    run = result["run"]
    console.print(
        f"Run: {run['outcome']}, {run['simulated_s']:.1f} s simulated in {run['wall_s']:.1f} s "
        f"({run['time']} time).",
        highlight=False,
    )
    for flag in run["flags"]:
        console.print(f"Note: {escape(flag)}", highlight=False)
    console.print(
        f"Score: {result['score']:g} of {result['max_score']:g}", style="bold", highlight=False
    )


def _explain(verdict: dict[str, Any], console: Console) -> None:
    console.print(f"[red]{verdict['check']}[/]: {escape(verdict['rationale'])}", highlight=False)
    for item in verdict["evidence"]:
        place = f"({item['x']:.2f}, {item['y']:.2f})"
        console.print(
            f"    at {item['time_s']:.2f} s, {place}: {escape(item['note'])}", highlight=False
        )
    if verdict["help"]:
        console.print(f"    -> {escape(verdict['help'])}", highlight=False)
