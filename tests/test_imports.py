"""Arrows run one way: who may import whom, no circle, nothing imported from above.

All imports count, also those inside functions and for type checkers only. What is named by a string
does not, e.g. a process that is started with -m.
"""

from __future__ import annotations

import ast
import importlib.util
import re
from functools import cache
from graphlib import CycleError, TopologicalSorter
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parents[1]
#: Package -> the folder in which it lies.
PACKAGES = {
    **dict.fromkeys(("turtlesim_py", "turtlesim_challenge", "robot_py", "grader"), ROOT),
    **dict.fromkeys(("tf2_py", "tf2_ros"), ROOT / "tf2"),
}
#: What students write, and what is written as they do.
STUDENTS = re.compile(
    r"turtlesim_challenge\.starter\b|grader\.exercises\.\w+\.(starter|reference|right)\b"
)
#: Doubles of ROS's packages, by whose names they import each other.
DOUBLES = "grader.scenes.package.examining.doubles"


def below(package: str, *names: str) -> set[str]:
    return {f"{package}.{name}" for name in names}


#: What every station of the grader may import.
GROUND = below(
    "grader",
    *("errors", "text", "files", "locks", "scratch", "removal", "system", "linux", "usage"),
    *("requirements", "strict_json", "limited", "versions", "content", "language"),
)
STATIONS = below(
    "grader",
    "submission",
    "recording",
    "scenes",
    "run",
    "diagnosis",
    "exercise",
    "exercises",
    "result",
    "reports",
)

#: What may import what of ours, besides itself. A name stands for all that is below it; of two
#: names that fit a module the longer is its rule. The lowest come first.
MAY_IMPORT: dict[str, set[str]] = {
    # where ROS is not sourced, these stand for its own; nothing of ours but programs needs them
    "tf2_py": set(),
    "tf2_ros": {"tf2_py"},
    "turtlesim_challenge": set(),
    # robots: data and arithmetic, of which only the nodes know that there is ROS
    "robot_py.__init__": set(),
    "robot_py.model": set(),
    "robot_py.findings": set(),
    "robot_py.logs": set(),
    "robot_py.urdf": below("robot_py", "model", "findings"),
    "robot_py.kinematics": {"robot_py.model"},
    "robot_py.robot_state": below("robot_py", "findings", "kinematics", "logs", "model", "urdf"),
    "robot_py.joint_states": set(),
    "robot_py.drawing": below("robot_py", "kinematics", "model"),
    "turtlesim_py.__init__": set(),
    "turtlesim_py.world": set(),
    "turtlesim_py.png": {"turtlesim_py.world"},
    "turtlesim_py.browser": set(),
    "turtlesim_py.replay": {"turtlesim_py.world"},
    "turtlesim_py.scenario": below("turtlesim_py", "world", "replay", "png"),
    "turtlesim_py.ros": below("turtlesim_py", "world", "png"),
    # whose server a node starts where a page is wanted
    "turtlesim_py.ros.live": below("turtlesim_py", "world", "ros", "live"),
    "turtlesim_py.ros.node": below("turtlesim_py", "world", "ros", "png", "live"),
    "turtlesim_py.live": below("turtlesim_py", "world"),
    "turtlesim_py.programs": below("turtlesim_py", "world", "ros", "browser"),
    # ... which are nodes as the simulator is one
    "robot_py.ros": {"robot_py", *below("turtlesim_py.ros", "program", "rclcpp_node")},
    **dict.fromkeys(GROUND, GROUND),
    # what an inspection answers, as data
    "grader.submission": GROUND | below("grader.scenes.package", "inspection", "said", "trace"),
    "grader.scenes": GROUND,
    "grader.scenes.turtlesim": GROUND | {"grader.scenes", "turtlesim_py"},
    # the same clock says "tick"
    "grader.scenes.robot": GROUND | {"grader.scenes", "robot_py", "turtlesim_py.ros.pacer"},
    # what both scenes with a robot show of it
    "grader.scenes.robot_parts": GROUND | {"grader.scenes", "robot_py"},
    "grader.scenes.package": GROUND | {"grader.scenes", "robot_py"},
    # a package is looked at in the submission's process, which sees little of ours
    "grader.scenes.package.trace": {"grader.strict_json"},
    "grader.scenes.package.inspection": {"grader.strict_json", "grader.scenes.package.trace"},
    "grader.scenes.package.examining": below("grader", "limited", "linux", "strict_json", "usage")
    | below("grader.scenes.package", "trace", "inspection", "__init__"),
    "grader.scenes.package.examining.doubles": {"grader.scenes.package.examining"},
    "grader.recording": GROUND | {"grader.scenes"},
    "grader.run": GROUND | below("grader", "submission", "recording", "scenes", "run"),
    # what all runs of a grading spend of
    "grader.run.budget": set(),
    "grader.run.processes": GROUND | {"grader.run.budget"},
    "grader.run.lockstep": GROUND | {"grader.run.processes"},
    "grader.run.student": below(
        "grader.run", "lockstep", "processes.__init__", "processes.cores", "processes.forking"
    ),
    # what the grader's process and the simulator's have to agree on
    "grader.run.plan": below("grader", "scenes", "run.budget", "strict_json"),
    "grader.run.handover": GROUND | below("grader", "recording", "scenes"),
    "grader.run.simulator": GROUND
    | below("grader", "recording", "scenes", "run.lockstep", "run.processes")
    | below("grader.run", "plan", "handover"),
    "grader.exercise": GROUND | below("grader", "recording", "scenes"),
    # columns with names, and nothing of turtles
    "grader.exercise.driven_path": GROUND
    | below("grader", "exercise", "recording", "scenes")
    | {"turtlesim_py.world.trajectory"},
    "grader.exercises": GROUND
    | below("grader", "recording", "scenes", "exercise")
    | {"turtlesim_py", "robot_py"},
    "grader.diagnosis": GROUND | below("grader", "recording", "scenes", "exercise.verdict"),
    "grader.result": GROUND
    | below("grader", "recording", "scenes", "exercise")
    | below("grader.diagnosis", "diagnosis", "costliest"),
    "grader.reports": GROUND
    | below("grader", "recording", "scenes", "exercise.verdict", "result", "diagnosis.diagnosis"),
    "grader.judging": GROUND | STATIONS - below("grader", "reports", "run", "submission"),
    "grader.grading": GROUND | STATIONS - below("grader", "reports") | {"grader.judging"},
    "grader.__init__": GROUND | STATIONS | below("grader", "grading", "judging"),
    "grader.batch": GROUND | STATIONS | below("grader", "grading", "judging", "testing.solutions"),
    "grader.testing": GROUND
    | STATIONS
    | {*below("grader", "__init__", "grading", "judging"), "turtlesim_py", "robot_py"},
    # a page is shown as the simulator's is
    "grader.cli.live": GROUND | STATIONS | {"turtlesim_py.browser"},
    "grader.cli": GROUND
    | STATIONS
    | below("grader", "__init__", "grading", "judging", "testing", "batch", "cli.live"),
    # ... and so is the page that plays
    "grader.cli.view": GROUND
    | STATIONS
    | below("grader.cli", "place", "error_file")
    | {"turtlesim_py.browser"},
    "grader.__main__": {"grader.cli"},
}

#: The world knows no ROS, no clock, no threads, no files.
NOT_IN_WORLD = {"rclpy", "time", "threading", "asyncio", "os", "io", "pathlib", "tempfile"}
WORLD_OPENS_FILES = {"open", "save", "read_text", "write_text", "read_bytes", "write_bytes"}


class Import(NamedTuple):
    importer: str
    imported: str
    line: int


@cache
def modules() -> dict[str, ast.Module]:
    """Every module by its name, parsed; a package's own file is NAME.__init__."""
    names = {
        ".".join(path.relative_to(folder).with_suffix("").parts): path
        for package, folder in PACKAGES.items()
        for path in (folder / package).rglob("*.py")
    }
    return {
        name: ast.parse(path.read_bytes())
        for name, path in sorted(names.items())
        if not STUDENTS.match(name)
    }


@cache
def imports() -> list[Import]:
    """Every import of a module of ours."""
    found = []
    for importer, tree in modules().items():
        package = importer.rpartition(".")[0]
        for node in ast.walk(tree):
            if isinstance(node, ast.Import):
                names = [(alias.name, "") for alias in node.names]
            elif isinstance(node, ast.ImportFrom):
                origin = importlib.util.resolve_name(
                    "." * node.level + (node.module or ""), package
                )
                names = [(origin, alias.name) for alias in node.names]
            else:
                continue
            for origin, name in names:
                imported = defining(origin, name)
                if imported is not None and imported != importer:
                    found.append(Import(importer, imported, node.lineno))
    return found


def defining(origin: str, name: str) -> str | None:
    """The module that `from origin import name` loads; None where it is not ours."""
    of_package = [f"{origin}.{name}.__init__", f"{origin}.{name}"] if name else []
    candidates = [*of_package, f"{origin}.__init__", origin]
    return next((module for module in candidates if module in modules()), None)


def inside(module: str, name: str) -> bool:
    return f"{module}.".startswith(f"{name}.")


@cache
def rule(module: str) -> str | None:
    return max((name for name in MAY_IMPORT if inside(module, name)), key=len, default=None)


def allowed(edge: Import) -> bool:
    own = rule(edge.importer)
    if own is None or rule(edge.imported) == own:
        return own is not None
    return any(inside(edge.imported, name) for name in MAY_IMPORT[own])


def test_nobody_imports_what_stands_above_or_beside():
    wrong = [
        f"{edge.importer}, line {edge.line}, must not import {edge.imported}"
        for edge in imports()
        if not allowed(edge)
    ]
    assert not wrong, "\n".join(["", *wrong])


def test_every_module_has_its_rule_and_every_rule_its_module():
    rules = {rule(module) for module in modules()}
    assert sorted(module for module in modules() if rule(module) is None) == []
    assert sorted(MAY_IMPORT.keys() - rules) == []


def test_nothing_goes_round_in_a_circle():
    """Neither modules nor packages: what directly is in a package has an order."""
    circles = []
    for package in sorted({name.rpartition(".")[0] for name in modules()}):
        arrows: dict[str, dict[str, Import]] = {}
        for edge in imports():
            importer, imported = child(package, edge.importer), child(package, edge.imported)
            if importer and imported and importer != imported:
                arrows.setdefault(importer, {})[imported] = edge
        try:
            TopologicalSorter(arrows).prepare()
        except CycleError as error:
            circle = pairwise(reversed(error.args[1]))
            steps = [arrows[importer][imported] for importer, imported in circle]
            circles.append(", ".join(f"{e.importer} imports {e.imported}" for e in steps))
    assert not circles, "\n".join(["", *circles])


def child(package: str, module: str) -> str | None:
    """What directly in the package holds the module."""
    if not inside(module, package):
        return None
    return module.removeprefix(f"{package}.").partition(".")[0]


def test_the_world_knows_no_ros_no_clock_no_threads_and_no_files():
    wrong = []
    for module, tree in modules().items():
        if not inside(module, "turtlesim_py.world"):
            continue
        for node in ast.walk(tree):
            if isinstance(node, ast.Import):
                used = {alias.name.partition(".")[0] for alias in node.names} & NOT_IN_WORLD
            elif isinstance(node, ast.ImportFrom):
                used = {(node.module or "").partition(".")[0]} & NOT_IN_WORLD
            elif isinstance(node, ast.Call):
                function = node.func
                called = getattr(function, "id", getattr(function, "attr", ""))
                used = {called} & WORLD_OPENS_FILES
            else:
                continue
            wrong += [f"{module}, line {node.lineno}: {name}" for name in used]
    assert not wrong, "\n".join(["", *wrong])


def test_every_module_says_in_its_first_line_what_is_inside():
    silent = []
    for module, tree in modules().items():
        first = (ast.get_docstring(tree) or "").partition("\n")[0]
        if len(first.split()) < 3:
            silent.append(f"{module}: {first!r}")
    assert not silent, "\n".join(["", *silent])
