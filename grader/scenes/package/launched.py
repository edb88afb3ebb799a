"""In what a program that was started by itself differs from what launch files make of it."""

from __future__ import annotations

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
    found = []
    for launch in trace.launches:
        own = [node for node in launch.nodes if node.package == setup.name]
        if started and launch.problem is None and (why := _why(own, started[0])):
            found.append(_sentence(launch, started[0], why))
    return found


def _sentence(launch: Launch, started: str, why: str) -> str:
    by_itself = f"{started} was started by itself, without {why}"
    return f"{launch.file} was evaluated and not run: {by_itself}"


def _why(own: list[Node], started: str) -> str:
    others = sorted({node.executable for node in own} - {started})
    if others:
        return ", ".join(others)
    given = next((node for node in own if _is_changed(node)), None)
    return "its namespace, remappings, arguments or parameters" if given else ""


def _is_changed(node: Node) -> bool:
    parameters = [each for each in node.parameters if each.name != "use_sim_time"]
    return bool(parameters or node.remappings or node.arguments or node.namespace.strip("/"))
