"""In what a program that was started by itself differs from what launch files make of it."""

from __future__ import annotations

from grader.language.phrase import joined, say
from grader.scenes.package.trace import Launch, Node, PackageTrace


def unlike_launched(trace: PackageTrace, module: str, function: str) -> list[str]:
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


def _sentence(launch: Launch, started: str, why: str) -> str:
    return say(
        "{file} was evaluated and not run: {program} was started by itself, without {what}",
        file=launch.file,
        program=started,
        what=why,
    )


def _why(own: list[Node], started: str) -> str:
    others = sorted({node.executable for node in own} - {started})
    if others:
        return ", ".join(others)
    return next(filter(None, map(_given, own)), "")


def _given(node: Node) -> str:
    """What a launch file gives a program that makes a difference; '' for nothing."""
    parameters = [each.name for each in node.parameters if each.name != "use_sim_time"]
    parts = {
        say("its namespace"): bool(node.namespace.strip("/")),
        say("its remappings"): bool(node.remappings),
        say("its arguments"): bool(node.arguments),
        say("its parameters ({names})", names=", ".join(parameters)[:200]): bool(parameters),
    }
    given = [part for part, is_given in parts.items() if is_given]
    return joined(given, say(" and ")) if given else ""
