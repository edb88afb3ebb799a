"""Makes a parrot of a right solution: it sends what that one sent in a run, and hears nothing.

In a run for which other values are drawn a parrot does no task: the points that it gets, anybody
gets who has seen one run. What it cannot send is nothing a task asks for: it has no subscriptions,
and looks at no request, no answer and no parameter.
"""

from __future__ import annotations

import shutil
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import fields
from pathlib import Path
from typing import Any, Final

from grader import grading
from grader.exercise.exercise import Exercise
from grader.recording.recording import Recording, Recordings
from grader.run.opening import open_submission
from grader.scenes.cast.trace import ROSOUT, CastTrace
from grader.scenes.turtlesim.messages import TWIST, of_input
from grader.scenes.turtlesim.rules import own_inputs
from grader.scenes.turtlesim.trace import TurtleTrace
from grader.submission.program import EntryPoint, Program
from turtlesim_py.world import events
from turtlesim_py.world.turtle import TICK_S

PROGRAM: Final = Path(__file__).with_name("submissions") / "parrot.py"
#: What each node has that is none of a program's.
_USUAL: Final = ("_parameters", "/get_parameter_types", "/get_type_description", "/_action/")


def record(path: Path, exercise: Exercise, recordings: Recordings, folder: Path) -> Recordings:
    """Run the parrot of a right solution, which repeats its nominal run, with another seed.

    Args:
        recordings: of the solution.
        folder: where the parrot is laid out.
    """
    with open_submission(path, **exercise.opening) as submission:
        parrot = lay_out(path, submission.programs, recordings.nominal, folder, exercise.setting)
    return grading.record(parrot, exercise, seed=exercise.varied.seed + 1)


def lay_out(
    path: Path, programs: Iterable[Program], recording: Recording, folder: Path, setting: str
) -> Path:
    """Return the path of a copy of a right solution whose programs are parrots.

    Args:
        path: the solution, a file or a folder.
        programs: those that a submission of it starts.
        recording: of the run that they repeat.
        folder: where it is laid out, a new one.
        setting: of the exercise.
    """
    copy = folder / path.name
    folder.mkdir(parents=True, exist_ok=True)
    if path.is_dir():
        shutil.copytree(path, copy, ignore=shutil.ignore_patterns("__pycache__"))
    else:
        shutil.copy(path, copy)
    for program in programs:
        entry = program.entry
        assert entry is not None
        if isinstance(entry, EntryPoint):
            name = f"{entry.module.replace('.', '/')}.py"
        else:
            name = entry.path.name
        file = next(iter(sorted(copy.rglob(name))), copy) if copy.is_dir() else copy
        owner, _, function = (entry.function or "").rpartition(".")
        made = source(recording, program.name, setting)
        made += f"\n\nclass {owner}:\n    {function} = main\n" if owner else ""
        made += f"\n\n{function} = main\n" if function else "\n\nmain()\n"
        file.write_text(made, encoding="utf-8")
    return copy


def source(recording: Recording, program: str, setting: str = "") -> str:
    """Return the source of one program's parrot."""
    text = PROGRAM.read_text(encoding="utf-8")
    facts = _recorded(recording, program, setting)
    # by name: interfaces of a hand-in's own are there for who imports them
    types = {each for node in facts["nodes"] for each in _types(node[2])}
    imports = "".join(f"import {name}\n" for name in sorted(types))
    return text.replace("RECORDED: dict[str, Any] = {}\n", f"{imports}RECORDED = {facts!r}\n")


def _types(node: Mapping[str, Any]) -> Iterator[str]:
    """Yield the modules of a node's types: 'std_msgs.msg'."""
    for key in ("topics", "services", "calls", "actions", "goals"):
        for _, kind, *_rest in node[key]:
            name = kind if isinstance(kind, str) else kind[0]
            yield ".".join(name.split("/")[:2])


def _recorded(recording: Recording, program: str, setting: str) -> dict[str, Any]:
    run, trace = recording.run, recording.trace
    casts = [each for each in (recording.cast, trace) if isinstance(each, CastTrace)]
    cast = casts[0] if casts else CastTrace()
    is_one = len(run.programs) < 2
    own = next((each for each in run.programs if each.name == program), run)
    nodes: dict[str, dict[str, Any]] = {}
    for name in dict.fromkeys(each["node"] for each in cast.of_kind("endpoint")):
        if name != "/" and (is_one or program in cast.programs.get(name, "").split(", ")):
            nodes[name] = _node(cast, name)
    if isinstance(trace, TurtleTrace) and (is_one or run.programs[0].name == program):
        node = next(iter(nodes.values()), None) or nodes.setdefault("/parrot", _node(cast, ""))
        _drive(node, own_inputs(trace, cast, setting))
    listed = [(n.rpartition("/")[2], n.rpartition("/")[0], facts) for n, facts in nodes.items()]
    return {
        "nodes": listed,
        "ends": own.outcome in ("exited", "crashed"),
        "exit_code": own.exit_code or 0,
    }


def _node(cast: CastTrace, name: str) -> dict[str, Any]:
    """Return what a node has sent."""
    keys = ("topics", "logs", "services", "calls", "actions", "goals")
    made: dict[str, Any] = {"parameters": {}, **{key: [] for key in keys}}
    for event in cast.of_kind("endpoint", node=name):
        kind, _, channel = event["channel"].partition(" ")
        action = channel.removesuffix("/_action/send_goal")
        if action != channel:
            base = event["type"].removesuffix("_SendGoal")
            if kind == "request" and not event["writes"]:
                goals = [_goal(each) for each in _in_order(cast.of_kind("goal", action=action))]
                made["actions"].append((action, base, goals))
            elif kind == "request":
                sent = cast.of_kind("action", action=action)
                made["goals"].append((action, base, [_at(e, "goal") for e in sent]))
        elif any(part in channel for part in _USUAL) or channel == "/parameter_events":
            continue
        elif kind == "topic" and event["writes"]:
            quality = (event["type"], event["reliability"], event["durability"], event["depth"])
            messages = [m for m in cast.sent(channel) if m.node in (name, "")]
            said = [(m.time_ns / 1e9, m.data.hex()) for m in messages if m.type == event["type"]]
            made["topics"].append((channel, quality, said))
        elif kind == "request" and not event["writes"]:
            calls = _in_order(cast.of_kind("call", service=channel))
            answers = [each.get("response", {}) for each in calls]
            made["services"].append((channel, event["type"], answers))
        elif kind == "request":
            asked = cast.of_kind("served", service=channel)
            made["calls"].append((channel, event["type"], [_at(e, "request") for e in asked]))
    for event in cast.of_kind("parameter", node=name):
        for key, value in event.get("values", {}).items():
            made["parameters"].setdefault(key, value)
    made["logs"] = [*_logs(cast, name)]
    return made


def _in_order(events: Iterable[Mapping[str, Any]]) -> list[Mapping[str, Any]]:
    return sorted((e for e in events if "sent_ns" in e), key=lambda event: event["sent_ns"])


def _at(event: Mapping[str, Any], key: str) -> tuple[float, Any]:
    return event["time_ns"] / 1e9, event[key]


def _goal(event: Mapping[str, Any]) -> dict[str, Any]:
    return {
        "accepted": event.get("accepted", False),
        "feedback": [values for _, values in event["feedback"]],
        "status": event.get("status", ""),
        "result": event.get("result", {}),
    }


def _logs(cast: CastTrace, name: str) -> Iterable[tuple[float, int, str]]:
    logger = name.strip("/").replace("/", ".")
    for each in cast.sent(ROSOUT):
        values = cast.values(each)
        if values["name"] == logger:
            yield each.time_ns / 1e9, values["level"], values["msg"]


def _drive(node: dict[str, Any], inputs: Iterable[tuple[str, str, events.Event]]) -> None:
    """Add what a program has sent to turtlesim."""
    node["calls"] = [each for each in node["calls"] if not each[1].startswith("turtlesim/")]
    asked: dict[tuple[str, str], list[Any]] = defaultdict(list)
    commands: dict[str, list[Any]] = defaultdict(list)
    for name, _, event in inputs:
        time_s = (event.tick - 1) * TICK_S
        if isinstance(event, events.CmdVel):
            commands[name].append((time_s, of_input(event).data.hex()))
        elif not isinstance(event, events.RotateAbsolute):
            values = {each.name: getattr(event, each.name) for each in fields(event)[1:]}
            values.pop("turtle", None)
            kind = f"turtlesim/srv/{type(event).__name__}" if values else "std_srvs/srv/Empty"
            asked[name, kind].append((time_s, values))
    node["calls"] += [(*key, requests) for key, requests in asked.items()]
    node["topics"] = [each for each in node["topics"] if not each[0].endswith("/cmd_vel")]
    node["topics"] += [(topic, (TWIST, 1, 2, 10), said) for topic, said in commands.items()]
