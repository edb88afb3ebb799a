"""What each launch file would start, as a table, and how that differs from what was started."""

from __future__ import annotations

from collections.abc import Sequence

from grader.recording.recording import NOT_THERE
from grader.scenes.view import Cell, Table
from grader.submission.package_trace import (
    PREFIX,
    Lacking,
    LaunchedNode,
    LaunchFile,
    PackageTrace,
    Skipped,
)
from grader.submission.program import EntryPoint, Script
from grader.text import strings as text
from grader.text.message import NOTHING, Message, Text, joined, msg

HEADINGS = (
    *(msg("Package"), msg("Program"), msg("Name")),
    *(msg("Parameters and arguments"), msg("Said in")),
)
#: A page has no more launch files, rows and lines of a cell.
_MOST_TABLES, _MOST_ROWS, _MOST_LINES = 12, 60, 12
_LONGEST = 160


def tables(trace: PackageTrace) -> tuple[Table, ...]:
    return tuple(_table(trace, launch) for launch in trace.launches[:_MOST_TABLES])


def _table(trace: PackageTrace, launch: LaunchFile) -> Table:
    rows = [_node(trace, launch, node) for node in launch.nodes]
    rows += [
        _row("", "", (msg("the program {name}", name=_clip(each)),), launch.file)
        for each in launch.processes
    ]
    for each in launch.includes:
        details: tuple[Text, ...] = (msg("includes {file}", file=_clip(each.file)), *each.arguments)
        rows.append(_row(each.package, "", details, launch.file))
    rows += [_skipped(each) for each in launch.skipped]
    rows += [
        _lacking(each) for each in launch.lacking if each.source or not _is_named(launch, each)
    ]
    title = msg("What {file} would start", file=_clip(launch.file))
    return Table(title, HEADINGS, tuple(rows[:_MOST_ROWS]), _note(launch, len(rows)))


def _is_named(launch: LaunchFile, lacking: Lacking) -> bool:
    """Whether a node's row says that it is missing."""
    for node in launch.nodes:
        names = {"package": node.package, "executable": f"{node.package} {node.executable}"}
        if names.get(lacking.kind) == lacking.name:
            return True
        texts = (*node.arguments, *(each.value for each in node.parameters))
        if lacking.kind == "file" and _names(texts, lacking.name):
            return True
    return False


def _note(launch: LaunchFile, rows: int) -> Message:
    notes = []
    if launch.problem is not None:
        where = _clipped(launch.problem.place) if launch.problem.line else ""
        error = launch.problem.text.map_texts(_clip)
        notes.append(msg("It ends with {error}{place}.", error=error, place=where))
    elif not rows:
        notes.append(msg("It starts nothing."))
    if launch.declared:
        notes.append(
            msg("Arguments: {names}, at their defaults.", names=_clip(", ".join(launch.declared)))
        )
    if rows > _MOST_ROWS:
        notes.append(msg("{count} more rows are not shown.", count=rows - _MOST_ROWS))
    return joined(notes, " ") if notes else NOTHING


def _node(trace: PackageTrace, launch: LaunchFile, node: LaunchedNode) -> tuple[Cell, ...]:
    details: list[Text] = [
        msg("{name} = {value}", name=_clip(each.name), value=_value(trace, each.value, each.text))
        for each in node.parameters
    ]
    if node.arguments:
        details.append(" ".join(node.arguments))
    details += [msg("remaps {names}", names=_clip(each)) for each in node.remappings]
    if node.condition:
        details.append(msg("{condition}: it is so by default", condition=_clip(node.condition)))
    if node.later:
        details.append(msg("later, when something else happens"))
    missing = {(each.kind, each.name) for each in launch.lacking}
    package, executable = node.package, node.executable
    named = "/".join(filter(None, (node.namespace.strip("/"), node.name)))
    return (
        Cell((_clip(package),), ("package", package) in missing),
        Cell((_clip(executable),), ("executable", f"{package} {executable}") in missing),
        Cell(_lines((named,))),
        Cell(_lines(details), any(k == "file" and _names(details, n) for k, n in missing)),
        Cell((_place(node.file or launch.file, node.line),)),
    )


def _names(details: Sequence[Text], file: str) -> bool:
    return any(file in str(each) for each in details)


def _skipped(each: Skipped) -> tuple[Cell, ...]:
    condition = _clip(each.condition) or msg("its condition")
    details = msg("not started: {condition} is not so by default", condition=condition)
    return _row(each.package, each.executable, (details,), _place(each.file, each.line))


def _lacking(each: Lacking) -> tuple[Cell, ...]:
    name = _clip(each.name)
    details: Text = {
        "file": msg("the file {name}", name=name),
        "package": msg("the package {name}", name=name),
        "executable": msg("the executable {name}", name=name),
    }.get(each.kind) or f"the {each.kind} {name}"
    there = msg("the package has {source}, not there", source=_clip(each.source))
    lines = (details, there) if each.source else (details,)
    return (Cell(("",)),) * 3 + (Cell(_lines(lines), True), Cell((_clip(each.by),)))


def _row(package: str, program: str, details: tuple[Text, ...], where: Text) -> tuple[Cell, ...]:
    words = (_clip(each) for each in (package, program, ""))
    return (*(Cell((each,)) for each in words), Cell(_lines(details)), Cell((_clipped(where),)))


def _value(trace: PackageTrace, value: str, number: int) -> Text:
    if number < 0:
        return value
    content = trace.texts[number]
    if not content.strip():
        return msg("an empty text")
    return msg("a text of {n:,} character", "a text of {n:,} characters", n=len(content))


def _lines(details: Sequence[Text]) -> tuple[Text, ...]:
    left = len(details) - _MOST_LINES
    more = [msg("and {count} more", count=left)] if left > 0 else []
    return (*map(_clipped, details[:_MOST_LINES]), *more)


def _place(file: str, line: int) -> Text:
    return msg("{file}, line {line}", file=_clip(file), line=line) if line else _clip(file)


def _clip(content: str) -> str:
    return text.shown(content.replace(f"{PREFIX}/", ""), _LONGEST)


def _clipped(content: Text) -> Text:
    return content.map_texts(_clip) if isinstance(content, Message) else _clip(content)


# A program that was started by itself ------------------------------------------------------------


def not_read(trace: PackageTrace, entry: EntryPoint | Script | None) -> list[Message]:
    """A sentence on each launch file that may start more of the package, and cannot be read."""
    scripts = trace.setup.scripts if trace.setup else ()
    name = next((s.name for s in scripts if EntryPoint(s.module, s.function) == entry), "")
    return [
        msg(
            "{file} was not run, and what it starts cannot be read ({unread}): "
            "judged is {program} alone",
            file=launch.file,
            unread=launch.problem.described,
            program=name,
        )
        for launch in trace.launches
        if name and launch.problem is not None
    ]


def not_installed(trace: PackageTrace) -> list[Message]:
    """A sentence on what `ros2 launch` would not find: a file, or a program of the package."""
    setup, found = trace.setup, list[Message]()
    if setup is None or not setup.programs:
        return found
    names = ", ".join(setup.programs)[:200]
    for launch in trace.launches:
        if launch.file in setup.left:
            words = {"file": launch.file, "set_up": setup.file, "place": setup.place}
            found.append(
                msg(
                    "`ros2 launch` would not find {file}: {set_up} does not install it; list it in "
                    "{place}",
                    **words,
                )
            )
        for node in launch.nodes:
            if node.package == setup.name and node.executable not in setup.programs:
                words = {"file": launch.file, "program": node.executable, "set_up": setup.file}
                found.append(NOT_THERE.given(**words, names=names))
    return found


def unlike_launched(trace: PackageTrace, entry: EntryPoint | Script | None) -> list[Message]:
    """A sentence on each launch file that starts more of the package, or starts it otherwise.

    Args:
        entry: what was started.
    """
    setup = trace.setup
    if setup is None:
        return []
    started = [s.name for s in setup.scripts if EntryPoint(s.module, s.function) == entry]
    scripts = {script.name for script in setup.scripts}
    found = []
    for launch in trace.launches:
        own = [n for n in launch.nodes if n.package == setup.name and n.executable in scripts]
        if started and launch.problem is None and (why := _why(own, started[0])):
            text = msg(
                "{file} was evaluated and not run: {program} was started by itself, without {what}"
            )
            found.append(text.given(file=launch.file, program=started[0], what=why))
    return found


def _why(own: list[LaunchedNode], started: str) -> Message:
    others = sorted({node.executable for node in own} - {started})
    if others:
        return Message.of(", ".join(others))
    return next(filter(None, map(_given, own)), NOTHING)


def _given(node: LaunchedNode) -> Message:
    """What a launch file gives a program that makes a difference; '' for nothing."""
    parameters = [each.name for each in node.parameters if each.name != "use_sim_time"]
    parts = {
        msg("its namespace"): bool(node.namespace.strip("/")),
        msg("its remappings"): bool(node.remappings),
        msg("its arguments"): bool(node.arguments),
        msg("its parameters ({names})", names=", ".join(parameters)[:200]): bool(parameters),
    }
    given = [part for part, is_given in parts.items() if is_given]
    return joined(given, msg(" and ")) if given else NOTHING
