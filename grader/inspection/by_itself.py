"""In what a program that was started by itself differs from what launch files make of it."""

from __future__ import annotations

from grader.inspection.error_texts import described
from grader.inspection.trace import LaunchedNode, LaunchFile, PackageTrace
from grader.message import NOTHING, Message, joined, msg, plain_text


def not_read(trace: PackageTrace, module: str, function: str) -> list[Message]:
    """A sentence on each launch file that may start more of the package, and cannot be read."""
    scripts = trace.setup.scripts if trace.setup else ()
    name = next((s.name for s in scripts if (s.module, s.function) == (module, function)), "")
    return [
        msg(
            "{file} was not run, and what it starts cannot be read ({unread}): "
            "judged is {program} alone",
            file=launch.file,
            unread=described(launch.problem),
            program=name,
        )
        for launch in trace.launches
        if name and launch.problem is not None
    ]


def unlike_launched(trace: PackageTrace, module: str, function: str) -> list[Message]:
    """A sentence on each launch file that starts more of the package, or starts it otherwise.

    Args:
        module, function: what was started.
    """
    setup = trace.setup
    if setup is None:
        return []
    started = [s.name for s in setup.scripts if (s.module, s.function) == (module, function)]
    scripts = {script.name for script in setup.scripts}
    found = []
    for launch in trace.launches:
        own = [n for n in launch.nodes if n.package == setup.name and n.executable in scripts]
        if started and launch.problem is None and (why := _why(own, started[0])):
            found.append(_sentence(launch, started[0], why))
    return found


def _sentence(launch: LaunchFile, started: str, why: Message) -> Message:
    return msg(
        "{file} was evaluated and not run: {program} was started by itself, without {what}",
        file=launch.file,
        program=started,
        what=why,
    )


def _why(own: list[LaunchedNode], started: str) -> Message:
    others = sorted({node.executable for node in own} - {started})
    if others:
        return plain_text(", ".join(others))
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
