"""What each launch file would start, as a table; what is missing of it is marked."""

from __future__ import annotations

from collections.abc import Sequence

from grader import text
from grader.scenes.package.trace import PREFIX, Lacking, Launch, Node, PackageTrace, Skipped
from grader.scenes.view import Cell, Table

HEADINGS = ("Package", "Program", "Name", "Parameters and arguments", "Said in")
#: A page has no more launch files, rows and lines of a cell.
_MOST_TABLES, _MOST_ROWS, _MOST_LINES = 12, 60, 12
_LONGEST = 160


def tables(trace: PackageTrace) -> tuple[Table, ...]:
    """One for each launch file."""
    return tuple(_table(trace, launch) for launch in trace.launches[:_MOST_TABLES])


def _table(trace: PackageTrace, launch: Launch) -> Table:
    rows = [_node(trace, launch, node) for node in launch.nodes]
    rows += [_row("", "", "", (f"the program {each}",), launch.file) for each in launch.processes]
    for each in launch.includes:
        told = (f"includes {each.file}", *each.arguments)
        rows.append(_row(each.package, "", "", told, launch.file))
    rows += [_skipped(each) for each in launch.skipped]
    rows += [_lacking(each) for each in launch.lacking if each.source or not _is_told(launch, each)]
    title = f"What {_clip(launch.file)} would start"
    return Table(title, HEADINGS, tuple(rows[:_MOST_ROWS]), _note(launch, len(rows)))


def _is_told(launch: Launch, lacking: Lacking) -> bool:
    """Whether a node's row says that it is missing."""
    for node in launch.nodes:
        names = {"package": node.package, "executable": f"{node.package} {node.executable}"}
        if names.get(lacking.kind) == lacking.name:
            return True
        said = (*node.arguments, *(each.value for each in node.parameters))
        if lacking.kind == "file" and _names(said, lacking.name):
            return True
    return False


def _note(launch: Launch, rows: int) -> str:
    said = []
    if launch.problem is not None:
        where = f" ({_clip(launch.problem.file)}, line {launch.problem.line})"
        said.append(
            f"It ends with {_clip(launch.problem.text)}{where if launch.problem.line else ''}."
        )
    elif not rows:
        said.append("It starts nothing.")
    if launch.declared:
        said.append(f"Arguments: {_clip(', '.join(launch.declared))}, at their defaults.")
    if rows > _MOST_ROWS:
        said.append(f"{rows - _MOST_ROWS} more rows are not shown.")
    return " ".join(said)


def _node(trace: PackageTrace, launch: Launch, node: Node) -> tuple[Cell, ...]:
    told = [f"{each.name} = {_value(trace, each.value, each.text)}" for each in node.parameters]
    if node.arguments:
        told.append(" ".join(node.arguments))
    told += [f"remaps {each}" for each in node.remappings]
    if node.condition:
        told.append(f"{node.condition}: it is so by default")
    if node.later:
        told.append("later, when something else happens")
    missing = {(each.kind, each.name) for each in launch.lacking}
    package, executable = node.package, node.executable
    named = "/".join(filter(None, (node.namespace.strip("/"), node.name)))
    return (
        Cell((_clip(package),), ("package", package) in missing),
        Cell((_clip(executable),), ("executable", f"{package} {executable}") in missing),
        Cell(_lines((named,))),
        Cell(_lines(told), any(k == "file" and _names(told, n) for k, n in missing)),
        Cell((_place(node.file or launch.file, node.line),)),
    )


def _names(told: Sequence[str], file: str) -> bool:
    return any(file in each for each in told)


def _skipped(each: Skipped) -> tuple[Cell, ...]:
    told = f"not started: {each.condition or 'its condition'} is not so by default"
    return _row(each.package, each.executable, "", (told,), _place(each.file, each.line))


def _lacking(each: Lacking) -> tuple[Cell, ...]:
    told = f"the {each.kind} {each.name}"
    lines = (told, f"the package has {each.source}, not there") if each.source else (told,)
    return (Cell(("",)),) * 3 + (Cell(_lines(lines), True), Cell((_clip(each.by),)))


def _row(
    package: str, program: str, name: str, told: tuple[str, ...], where: str
) -> tuple[Cell, ...]:
    words = (_clip(each) for each in (package, program, name))
    return (*(Cell((each,)) for each in words), Cell(_lines(told)), Cell((_clip(where),)))


def _value(trace: PackageTrace, value: str, number: int) -> str:
    if number < 0:
        return value
    said = trace.texts[number]
    if not said.strip():
        return "an empty text"
    return f"a text of {text.count(len(said), 'character')}"


def _lines(told: list[str] | tuple[str, ...]) -> tuple[str, ...]:
    more = (f"and {len(told) - _MOST_LINES} more",) if len(told) > _MOST_LINES else ()
    return (*map(_clip, told[:_MOST_LINES]), *more)


def _place(file: str, line: int) -> str:
    return f"{_clip(file)}, line {line}" if line else _clip(file)


def _clip(said: str) -> str:
    return text.clip(text.one_line(text.plain(said.replace(f"{PREFIX}/", ""))), _LONGEST)
