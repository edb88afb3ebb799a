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
    "grader_robots": ROOT,
    **dict.fromkeys(("tf2_py", "tf2_ros"), ROOT / "tf2"),
}
#: What students write, and what is written as they do.
STUDENTS = re.compile(
    r"turtlesim_challenge\.starter\b"
    r"|grader(_robots)?\.exercises?(\.\w+)?\.(starter|reference|right)\b"
)


def below(package: str, *names: str) -> set[str]:
    return {f"{package}.{name}" for name in names}


#: What every room of the grader may import.
GROUND = below(
    "grader",
    *("message", "translations", "errors", "text", "files", "scratch", "removal", "system"),
    *("linux", "requirements", "strict_json", "limited", "content", "extensions", "yaml_file"),
    "expressions",
)
#: What the rooms above a run may import of those below it.
RECORDED = below("grader", "recording", "exercise", "result")

#: What may import what of ours, besides itself. A name stands for all that is below it; of two
#: names that fit a module the longer is its rule. The lowest come first.
MAY_IMPORT: dict[str, set[str]] = {
    # where ROS is not sourced, these stand for its own; nothing of ours but programs needs them
    "tf2_py": set(),
    "tf2_ros": {"tf2_py"},
    "turtlesim_challenge": {"turtlesim_py.ros.source"},
    # robots: data and arithmetic, of which only the nodes know that there is ROS
    "robot_py.__init__": set(),
    "robot_py.model": set(),
    "robot_py.urdf": {"robot_py.model"},
    "robot_py.kinematics": {"robot_py.model"},
    "robot_py.robot_state": below("robot_py", "kinematics", "model", "urdf"),
    "robot_py.joint_states": set(),
    "turtlesim_py.__init__": set(),
    "turtlesim_py.world": set(),
    "turtlesim_py.browser": set(),
    "turtlesim_py.scenario": {"turtlesim_py.world"},
    "turtlesim_py.ros": {"turtlesim_py.world"},
    # whose server a node starts where a page is wanted
    "turtlesim_py.ros.window": below("turtlesim_py", "world", "ros", "live"),
    "turtlesim_py.ros.node": below("turtlesim_py", "world", "ros", "live"),
    "turtlesim_py.live": {"turtlesim_py.world"},
    "turtlesim_py.programs": below("turtlesim_py", "world", "ros", "browser"),
    # what is installed as a command; it names its program, which it imports where it can
    "turtlesim_py.commands": {"turtlesim_py.ros.source"},
    "robot_py.commands": {"turtlesim_py.commands"},
    # ... which are nodes as the simulator is one
    "robot_py.robot_state_publisher": {"robot_py.robot_state"}
    | below("turtlesim_py.ros", "program", "rclcpp_node"),
    "robot_py.joint_state_publisher": {"robot_py.joint_states"}
    | below("turtlesim_py.ros", "program", "rclcpp_node"),
    **dict.fromkeys(GROUND, GROUND),
    "grader.requirements": GROUND | {"turtlesim_py.ros.source"},
    # a library of its own
    "grader.rosidl": below("grader", "message", "errors"),
    "grader.recording": GROUND | {"grader.rosidl.bag_types"},
    "grader.scenes": GROUND | {"grader.recording", "grader.scenes.live"},
    # the page of runs is served as the simulator's is
    "grader.scenes.live": GROUND
    | {"grader.recording"}
    | below("turtlesim_py", "live.feed", "live.server", "world.canvas"),
    "grader.scenes.joined": GROUND | below("grader", "recording") | {"turtlesim_py.__init__"},
    "grader.scenes.turtlesim": GROUND
    | below("grader", "recording", "scenes.scene", "scenes.live", "scenes.joined")
    | below("grader.rosidl", "bag_types", "cdr", "uncompiled")
    | below("turtlesim_py", "__init__", "world", "scenario", "ros", "live"),
    # scripted peers, which any scene may have beside it
    "grader.cast": GROUND
    | below("grader", "recording", "scenes.scene", "scenes.live", "scenes.joined", "rosidl"),
    # what the source shows, as it is recorded; what CMake would generate, and what of that parses
    "grader.submission": GROUND
    | below("grader", "submission", "recording")
    | below("grader.rosidl", "bag_types", "cdr", "definitions", "fields"),
    # a package is examined in the submission's process, which sees little of ours
    "grader.submission.trace": below("grader", "strict_json", "message"),
    "grader.submission.program": {"grader.strict_json"},
    "grader.submission.answer": {"grader.strict_json"}
    | below("grader.submission", "program", "trace"),
    # what checks make of it
    "grader.submission.unknown": below("grader", "message", "exercise.verdict")
    | below("grader.submission", "error_texts", "trace"),
    "grader.submission.examining": below("grader", "limited", "linux", "strict_json", "message")
    | below(
        "grader.submission",
        "trace",
        "answer",
        "folder",
        "manifest",
        "program",
        "request",
        "safe_files",
        "__init__",
    ),
    "grader.submission.examining.doubles": below("grader", "submission.examining", "message"),
    "grader.run": GROUND
    | below("grader", "submission", "recording", "scenes", "run", "rosidl.compiler")
    | {"grader.cast.script"},
    "grader.run.limits": {"grader.message"},
    "grader.run.sandbox": GROUND | {"grader.run.limits"},
    "grader.run.processes": GROUND | below("grader.run", "limits", "sandbox"),
    "grader.run.lockstep": GROUND | below("grader", "run.processes", "rosidl"),
    # virtual time, and what is observed, know nothing of each other; who starts a program puts them
    # together
    "grader.run.clock": below("grader", "message", "run.lockstep"),
    "grader.run.observe": below("grader.run", "lockstep"),
    "grader.run.student": {"grader.message"}
    | below("grader.run", "lockstep", "clock", "observe")
    | below("grader.run.processes", "__init__", "fork_server_main"),
    # what the grader's process and the simulator's have to agree on
    "grader.run.handover": GROUND | below("grader", "recording", "scenes", "run.limits"),
    "grader.run.simulator": GROUND
    | below("grader", "recording", "scenes", "cast", "run.lockstep", "run.processes")
    | below("grader.run", "handover", "limits"),
    # ... which ticks at the wall clock's pace as the node does
    "grader.run.simulator.real_time": GROUND
    | below("grader", "recording", "scenes", "run.lockstep", "run.processes", "run.handover")
    | below("grader", "run.limits", "run.simulator")
    | {"turtlesim_py.ros.program"},
    "grader.exercise": GROUND
    | below("grader", "recording", "scenes.scene", "cast")
    | below("grader.rosidl", "definitions", "fields"),
    # columns with names, and nothing of turtles but how they move
    "grader.exercise.driven_path": GROUND
    | below("grader", "exercise", "recording", "scenes.scene")
    | below("turtlesim_py.world", "trajectory", "turtle"),
    "grader.exercises": GROUND
    | below("grader", "recording", "scenes.turtlesim", "exercise", "cast.trace")
    | below("grader.submission", "trace", "error_texts", "unknown")
    | {"turtlesim_py.world"},
    "grader.diagnosis": GROUND | below("grader", "recording", "exercise.verdict", "rosidl.fields"),
    "grader.result": GROUND | below("grader", "recording", "exercise", "diagnosis.diagnosis"),
    "grader.reports": GROUND
    | below("grader", "recording", "exercise.verdict", "result", "diagnosis.diagnosis")
    | {"grader.scenes.scene"},
    "grader.judging": GROUND | RECORDED | {"grader.diagnosis"},
    "grader.grading": GROUND
    | RECORDED
    | below("grader", "judging", "run", "submission", "scenes.scene"),
    "grader.__init__": RECORDED | below("grader", "errors", "grading", "judging", "run.opening"),
    "grader.testing": GROUND
    | RECORDED
    | below("grader", "grading", "judging", "run", "diagnosis", "scenes", "reports", "result")
    | {"turtlesim_py.world.turtle"},
    # a class is graded by what stands in docs/python-api.md, and shown as single results are
    "grader.batch": GROUND
    | {"grader.batch", "grader.result"}
    | below("grader.recording", "recording", "subject", "view")
    | below("grader.exercise", "exercise", "loading", "sentences", "verdict")
    | below("grader.reports", "__init__", "beside", "csv", "wording", "page")
    | {"grader.submission.request"},
    # what was handed in is looked at before it is opened, and archives of a class are unpacked
    "grader.batch.find": GROUND
    | {"grader.batch"}
    | below("grader.submission", "folder", "unpacking", "archive", "safe_members"),
    # hand-ins are renamed, and their pages made anew
    "grader.batch.forget": GROUND
    | {"grader.batch", "grader.result"}
    | below("grader", "exercise.exercise", "submission.folder")
    | below("grader", "reports.__init__", "reports.beside"),
    "grader.batch.store": GROUND
    | {"grader.batch"}
    | below("grader", "exercise.exercise", "recording.recording", "submission.folder"),
    "grader.batch.export": GROUND
    | {"grader.batch"}
    | below("grader", "exercise.exercise", "submission.folder", "testing.solutions")
    | below("grader", "submission.manifest", "reports.csv"),
    # at which level a class is confined, and the workers of a cluster are
    "grader.batch.class_file": GROUND
    | {"grader.run.processes.levels"}
    | below("grader", "exercise.exercise", "recording.recording", "result.json_file"),
    "grader.batch.cluster": GROUND | {"grader.batch", "grader.run.processes.levels"},
    # a worker: its process, and what it opens
    "grader.batch.pool": GROUND
    | {"grader.batch", "grader.recording.recording", "grader.submission.request"}
    | below("grader.run", "fork_servers", "processes.fork_server"),
    "grader.batch.grade": GROUND
    | {"grader.batch"}
    | below("grader", "grading", "judging", "result", "run.opening", "recording.recording")
    | below("grader", "exercise.exercise", "exercise.loading")
    | below("grader", "reports.__init__", "run.processes", "run.fork_servers", "submission"),
    # a page is shown as the simulator's is
    "grader.cli.live": GROUND
    | below("grader", "recording", "run", "scenes", "exercise.exercise", "reports")
    | {"grader.result.visible", "turtlesim_py.browser"},
    # what students and teachers begin with: files
    "grader.course": GROUND
    | below("grader", "recording.subject", "exercise", "submission.folder", "submission.manifest"),
    # files to be written, one of them in Python
    "grader.course.templates": set(),
    "grader.cli": GROUND
    | RECORDED
    | below("grader", "__init__", "grading", "judging", "testing", "batch", "course", "cli.live")
    | below("grader", "reports", "run", "submission"),
    # ... and so is the page that plays
    "grader.cli.view": GROUND
    | below("grader", "recording", "result", "reports")
    | below("grader.cli", "check", "options")
    | {"turtlesim_py.browser"},
    "grader.__main__": below("grader", "cli"),
}

#: An extension: robots, and what is asked of them; nothing in grader/ knows it, or needs it.
EXTENSION = {
    "grader_robots.__init__": set(),
    "grader_robots.scene": GROUND
    | below("grader", "recording", "scenes.scene", "scenes.by_hand")
    | below("grader.rosidl", "bag_types", "cdr", "messages")
    | {"grader.submission.trace", "robot_py", "turtlesim_py.ros.program"},
    "grader_robots.inspection": {"grader.message"}
    | below("grader", "recording", "submission")
    | {"grader_robots.scene"},
    "grader_robots.exercises": GROUND
    | below("grader", "recording", "submission", "exercise")
    | {"grader_robots.scene", "robot_py", "tf2_ros"},
}
if (ROOT / "grader_robots").is_dir():
    MAY_IMPORT |= EXTENSION

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
                if imported is None or imported == importer:
                    continue
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
