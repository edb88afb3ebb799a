"""What a launch file would start, asks for and lacks: the other side of the doubles."""

from __future__ import annotations

import json
import os
import re
import shlex
from collections import defaultdict
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Any, Final

from grader.submission import safe_files
from grader.submission.answer import LaunchOrder
from grader.submission.examining import commands
from grader.submission.examining.layout import Workspace
from grader.submission.examining.steps import LIMITS, end_of, it
from grader.submission.package_trace import (
    Include,
    Lacking,
    LaunchedNode,
    LaunchFile,
    Obstacle,
    Parameter,
    Skipped,
)
from grader.submission.program import (
    BASE,
    LONGEST_ARGUMENTS,
    OF_THE_RUN,
    PREFIX,
    Program,
    Script,
)
from grader.system.strict_json import STRANGERS
from grader.text.message import Message, msg
from ros_doubles import NotKnown, frontend, known
from ros_doubles.frontend_substitutions import substitutions
from ros_doubles.launch_time import LaunchTime

#: A text that is longer is no name or number, but a description.
LONG: Final = 300
_MOST: Final = 200
#: So much of what a program says is kept, from its end.
_LONGEST_SAID: Final = 1000
#: Actions that decide what is started, and are followed.
FOLLOWED: Final = (
    # each of these is named, or known
    *("ExecuteProcess", "ExecuteLocal", "RegisterEventHandler"),
    *("DeclareLaunchArgument", "GroupAction", "IncludeLaunchDescription", "LaunchDescription"),
    *("LogInfo", "Node", "LifecycleNode", "ComposableNodeContainer", "OpaqueFunction"),
    *("PushROSNamespace", "PushRosNamespace", "PushEnvironment", "PopEnvironment"),
    *("SetEnvironmentVariable", "AppendEnvironmentVariable", "UnsetEnvironmentVariable"),
    *("PushLaunchConfigurations", "PopLaunchConfigurations", "ResetEnvironment"),
    *("ROSTimer", "UnregisterEventHandler", "ResetLaunchConfigurations", "SetLaunchConfiguration"),
    *("SetParameter", "SetParametersFromFile", "SetROSLogDir", "SetRemap", "SetUseSimTime"),
    *("TimerAction", "UnsetLaunchConfiguration"),
)
#: Where a context has the launch file that is evaluated.
_FILE: Final = "file_that_is_evaluated"
_FILE_OPTIONS: Final = ("-d", "--display-config", "-file", "--file")
#: How the names of files end that a node may be told to read.
SUFFIXES: Final = (
    *(".rviz", ".urdf", ".xacro", ".xml", ".yaml", ".yml", ".sdf", ".world", ".py", ".dae", ".stl"),
    *(".launch", ".config", ".json", ".vcg"),
)


#: What a shell would not take as words.
_OF_A_SHELL: Final = re.compile(r"[;&|<>$`*?~\n]")
_PYTHON: Final = re.compile(r"python3?(\.\d+)?")


@dataclass(frozen=True)
class Evaluated:
    """What was taken down of a launch file.

    Attributes:
        launch: as far as this file tells alone; `packages` are those that are there.
        texts: what the numbers of its texts stand for.
        sources: descriptions that were read, in their order.
        refused: what xacro said where it made nothing.
        borrowed: packages that are not there, with files of the submission's.
        missing: packages that were asked for, and are not there.
        order: of its nodes.
    """

    launch: LaunchFile
    texts: Annotated[tuple[str, ...], STRANGERS._replace(characters=LIMITS.answer_bytes)]
    sources: tuple[str, ...]
    refused: tuple[str, ...]
    borrowed: tuple[str, ...]
    missing: tuple[str, ...]
    order: LaunchOrder


class LaunchRecord:
    """What is taken down of a launch file; the `record` of a double's context."""

    def __init__(self, place: Workspace) -> None:
        self._place = place
        self.context: Any = None
        #: entries of the fields of `LaunchFile` and `Evaluated`, by their names
        self._found: dict[str, list[Any]] = defaultdict(list)
        self._texts: list[str] = []
        self._depth = 0
        #: descriptions that were read, in their order
        self.sources: list[str] = []
        self.time = LaunchTime(self)
        #: with their places
        self._nodes: list[tuple[tuple[int, ...], LaunchedNode]] = []

    def evaluated(
        self, file: str, problem: Obstacle | None, there: Sequence[str], missing: Sequence[str]
    ) -> Evaluated:
        """All of it; with packages that were asked for, those that are there and the others."""
        found: dict[str, Any] = {name: tuple(each) for name, each in self._found.items()}
        found["nodes"] = tuple(node for _, node in sorted(self._nodes, key=lambda each: each[0]))
        ordered = {name: found.pop(name, ()) for name in ("programs", "included", "ignored")}
        of_all = {name: found.pop(name, ()) for name in ("refused", "borrowed")}
        order = LaunchOrder(**ordered)
        launch = LaunchFile(file, problem, packages=tuple(there), **found)
        texts, sources = tuple(self._texts), tuple(self.sources[:20])
        return Evaluated(launch, texts, sources, missing=tuple(missing), order=order, **of_all)

    def _add(self, field: str, entry: Any) -> None:
        to = self._found[field]
        if entry not in to and len(to) < _MOST:
            to.append(entry)

    # Called by the doubles ----------------------------------------------------------------------

    def node(
        self,
        node: dict[str, Any],
        ros: Sequence[str] = (),
        lacking: Sequence[str] = (),
        action: Any = None,
        command: str = "",
    ) -> None:
        """A node that would start.

        Args:
            ros: its arguments with those of ROS.
            lacking: what it cannot get.
            action: that starts it.
            command: what it calls, where it is no Node.
        """
        given = [*node["parameters"], *self._by_argument(node)]
        parameters = tuple(self._parameter(each) for each in given)
        self._look_for_paths(node["arguments"])
        most = int(STRANGERS.characters)
        words = {
            each: tuple(word[:most] for word in node[each]) for each in ("arguments", "remappings")
        }
        made = {**self._from_where(node), **words, "parameters": parameters}
        if len(self._nodes) < _MOST:  # one may be there twice
            launched = LaunchedNode(**made, later=self.time.is_later)
            self._nodes.append((self.time.next_place(), launched))
        package, executable = node["package"], node["executable"]
        start = Program("", package, executable, arguments=tuple(ros), lacking=tuple(lacking))
        if type(action).__name__ == "LifecycleNode":
            start = Program("", "", f"LifecycleNode {package} {executable}")
        self._start(start, action, command or executable)

    def _start(self, start: Program, action: Any, program: str) -> None:
        """Note a program that starts now."""
        starts = self._found["programs"]
        if len(starts) >= _MOST:
            return
        number, name = len(starts), os.path.basename(program)
        if action is not None:
            name = action.printed(self.context, program)
            respawn_s, respawns = action.respawns(self.context)
            start = replace(start, respawn_s=respawn_s, respawns=respawns)
            for option in action.ignored:
                self.ignored(f"{option} of {start.executable}")
            if action.on_exit is not None:
                from launch.event_handlers import OnProcessExit

                self.time.handler(OnProcessExit(target_action=action, on_exit=action.on_exit))
        after, delay_s = self.time.when
        words, lacking = self._placed(start.arguments)
        environment = self._environment(start, action)
        printed = f"{name}-{number + 1}"[:LONG]
        starts.append(
            replace(
                start,
                name=printed,
                executable=start.executable[:LONG],
                arguments=words,
                environment=environment,
                lacking=(*start.lacking, *lacking)[:_MOST],
                after=after,
                delay_s=delay_s,
            )
        )
        if action is not None:
            self.time.started(number, printed, action)

    def _placed(self, words: Sequence[str]) -> tuple[tuple[str, ...], list[str]]:
        """Arguments with the marks of places, see `program`; and what cannot be given."""
        given, lacking, room = list[str](), list[str](), LONGEST_ARGUMENTS
        for word in words:
            marked = self._marked(word)
            if marked is not None and (size := len(json.dumps(marked))) < room:
                given.append(marked)
                room -= size
                continue
            lacking.append(word[:LONG])
            if given[-1:] in (["-p"], ["-r"], ["--params-file"]):
                given.pop()
        return tuple(given[:_MOST]), lacking

    def _marked(self, text: str) -> str | None:
        """A text with the marks of places; None of one that no process of a run can get."""
        place = self._place
        marked = text.replace(str(place.prefix), PREFIX).replace(str(place.root), BASE)
        return None if str(place.asked.parent) in marked or "\0" in text else marked

    def _environment(self, start: Program, action: Any) -> tuple[str, ...]:
        """The variables that a launch file sets for a program."""
        first = self.context.first_environment
        now = self.context.environment | (action.environment(self.context) if action else {})
        found = list[str]()
        for name, value in now.items():
            if first.get(name) == value:
                continue
            marked = self._marked(value)
            if marked is None or len(marked) > 1000 or name.startswith(OF_THE_RUN):
                self.ignored(f"{name} of {start.executable}")
            elif len(found) < _MOST:
                found.append(f"{name[:LONG]}={marked}")
        return tuple(found)

    def skipped(self, node: dict[str, Any]) -> None:
        """A node that would start on a condition that is not met."""
        self._add("skipped", Skipped(**self._from_where(node)))

    def _from_where(self, node: dict[str, Any]) -> dict[str, Any]:
        """A node with the file and line that say that it starts."""
        described = {"condition": "", **node}
        path, line = described.pop("made", ("", 0))
        file = self._place.own(path)
        return {
            **described,
            "file": file or self._place.own(self.context.locals_.get(_FILE, "")),
            "line": line if file else 0,
            "condition": described["condition"][:LONG],
        }

    def visited(self, kind: str) -> None:
        if kind not in FOLLOWED:
            self.ignored(kind)

    def ignored(self, what: str) -> None:
        """An action or an option that changes what is started, and is not followed."""
        self._add("ignored", what[:LONG])

    def process(self, words: list[str], action: Any) -> None:
        """Another program that would start; a node, where it is plainly one."""
        command = words[0] if words else ""
        if action.shell and not _OF_A_SHELL.search(text := " ".join(words)):
            words = shlex.split(text)
        program = os.path.basename(words[0]) if words else ""
        if [program, *words[1:2]] == ["ros2", "run"] and len(words) > 3:
            package, executable, *arguments = words[2:]
        elif program == "rviz2":
            package, executable, arguments = program, program, words[1:]
        else:
            package, executable, arguments = "", "", []
        if package:
            self.executable(package, executable)
            described = {"package": package, "executable": executable, "arguments": arguments}
            described |= {"name": "", "namespace": "", "parameters": [], "remappings": []}
            self.node(described, arguments, (), action, command)
            return
        self._look_for_paths(words)
        self._add("processes", " ".join(words)[:1000])
        own = self._own_script(words)
        start = Program("", "", self._place.shown(" ".join(words)), *own)
        self._start(start, action, command)

    def _own_script(self, words: list[str]) -> tuple[Script | None, Path, tuple[str, ...]]:
        """The submission's file that a command runs in Python, no root, and its arguments."""
        rest = words[1:] if words and _PYTHON.fullmatch(os.path.basename(words[0])) else words
        script = rest[1:] if rest[:1] == ["-u"] else rest
        if not script or not script[0].endswith(".py"):
            return None, Path(), ()
        path = os.path.abspath(script[0])
        sources = (
            each.package.folder / own
            for each in self._place.all
            if (own := each.own(path, self._place.prefix))
        )
        source = next(sources, None)
        entry = None if source is None else Script(source.relative_to(self._place.root))
        return entry, Path(), tuple(script[1:])

    def declared(self, name: str) -> None:
        self._add("declared", name)

    def chose(self, name: str, value: str) -> None:
        """An argument without a default gets the first of its choices."""
        self.remark(
            msg(
                "its argument {name} has no default: looked at with {value}, the first of its "
                "choices",
                name=name,
                value=value,
            )
        )

    def remark(self, remark: Message) -> None:
        self._add("remarks", remark)

    def executable(self, package: str, name: str) -> None:
        """A program of a package is wanted."""
        from ament_index_python.packages import PackageNotFoundError, get_package_prefix

        try:
            prefix = get_package_prefix(package)
        except PackageNotFoundError:
            return
        ours = [each.name for each in self._place.all]
        if package in ours:
            there = safe_files.is_file(Path(prefix) / "lib" / package / name)
        else:
            programs = known.PROGRAMS.get(package)
            there = programs is None or name in programs
            programs_of = (self._place.prefix / "lib" / each / name for each in ours)
            is_known = self._place.knows(package)
            if not is_known and any(map(safe_files.is_file, programs_of)):
                self._add("borrowed", package)
        if not there:
            self.lack("executable", f"{package} {name}", "")

    def path(self, wanted: str) -> str:
        """Where a file is, or the one that was meant.

        Raises:
            NotKnown: it is of another package, of which nobody knows the files here.
        """
        if os.path.exists(wanted):
            return wanted
        package, own = self._place.borrowed(wanted)
        if package:
            self._add("borrowed", package)
            return self.path(own)
        if wanted.startswith(f"{self._place.stubs}/"):
            name = self._place.shown(wanted)
            raise NotKnown(it(msg("needs {name}, a file of another package", name=name)))
        meant = self._place.meant(wanted)
        self.lack("file", wanted, meant)
        return meant or wanted

    def include(self, path: str, action: Any, arguments: Sequence[tuple[str, str]]) -> None:
        """Another launch file: followed where it is the submission's own."""
        if self._place.borrowed(path)[0]:
            path = self.path(path)
        if path.startswith(f"{self._place.stubs}/share/"):
            self._include_external(path, dict(arguments))
            return
        self._depth += 1
        if self._depth > 20:
            raise RecursionError("launch files that include each other")
        for each in self._place.all:
            if own := each.own(path, self._place.prefix):
                self._add("included", f"{each.name}/{own}"[:LONG])
        self.run(path, lambda description: action.included(description, arguments))
        self._depth -= 1

    def _include_external(self, path: str, arguments: dict[str, str]) -> None:
        from ament_index_python.packages import get_package_share_directory

        package, _, file = path.removeprefix(f"{self._place.stubs}/share/").partition("/")
        given = [f"{name}:={value}"[:1000] for name, value in arguments.items()]
        if file not in known.FILES.get(package, (file,)):
            self.lack("file", path, "")
        self._add("includes", Include(package, file, tuple(given)))

        def expand(model: str) -> str:
            return self.command(["xacro", model], "fail")

        share = get_package_share_directory
        for node in known.nodes_of(package, file, arguments, share, expand):
            self.node(node)

    def add_external(self, package: str, name: str) -> None:
        """An action of another package, of which no more is known."""
        self._add("includes", Include(package, f"{name}()"[:1000], ()))

    def command(self, words: list[str], on_stderr: str) -> str:
        """What a `Command` prints.

        Raises:
            SubstitutionFailure: as the original does: it is not there, fails, or complains.
        """
        from ament_index_python.packages import get_package_prefix
        from launch.substitutions import SubstitutionFailure

        if words and os.path.basename(words[0]) == "ros2":
            words = ["ros2", *words[1:]]
        if words[:2] == ["ros2", "run"] and len(words) > 3:
            words = words[3:]
        if words[:1] == ["ros2"]:
            output = commands.ros2(words, get_package_prefix)
            if output is None:
                command = " ".join(words[:3])
                asks = msg(
                    "`{command}` asks a running system, which nobody has here", command=command
                )
                self.remark(asks)
            return output or ""
        shown = self._place.shown(" ".join(words))
        if words and os.path.basename(words[0]) == "xacro":
            code, out, errors = self.xacro(words[1:])
            if code:  # the launch file has done what it should
                self._add("refused", f"xacro: {_end(errors)}")
                return ""
        else:
            code, out, errors = commands.other(words, self.path)
        if code:
            raise SubstitutionFailure(
                f"executed command failed. Command: {shown}. It says: {_end(errors)}"
            )
        if errors.strip() and on_stderr == "fail":
            raise SubstitutionFailure(
                f"executed command showed stderr output. Command: {shown}. It says: {_end(errors)}"
            )
        return out

    # Files ----------------------------------------------------------------------------------------

    def run(self, path: str, entities: Callable[[Any], list[Any]] = lambda made: [made]) -> None:
        """Evaluate a launch file.

        Args:
            entities: what is done of its description.
        """
        from launch._core import walk

        read, before = self.path(path), self.context.locals_.get(_FILE, "")
        description = frontend.description(path, read)
        self.context.locals_ |= {_FILE: path, "current_launch_file_path": path}
        walk(entities(description), self.context)
        self.context.locals_[_FILE] = before  # `ThisLaunchFile` stays, as in the original

    def filled(self, text: str) -> str:
        """A text with its substitutions, as in a launch file of XML."""
        from launch._core import perform_substitutions

        return str(perform_substitutions(self.context, substitutions(text)))

    def xacro(self, words: list[str]) -> commands.Ended:
        """What xacro does: its exit code, and what it prints to either side."""
        given = [
            each if each.startswith("-") or ":=" in each else self.path(each) for each in words
        ]
        return commands.xacro(given)

    def _by_argument(self, node: dict[str, Any]) -> list[dict[str, Any]]:
        """The file that a robot_state_publisher reads where it has no parameter, with a warning."""
        has_one = any(each["name"] == "robot_description" for each in node["parameters"])
        files = [each for each in node["arguments"] if each.endswith((".urdf", ".xml", ".xacro"))]
        if has_one or not files or node["executable"] != "robot_state_publisher":
            return []
        self.remark(
            msg(
                "robot_state_publisher gets the description as a file, which it still reads, with "
                "a warning: give it the parameter robot_description"
            )
        )
        try:
            with open(os.path.abspath(files[0]), encoding="utf-8") as file:
                text = file.read()
        except OSError:
            return []
        return [{"name": "robot_description", "value": text, "wrapped": True}]

    def _parameter(self, given: dict[str, Any]) -> Parameter:
        value, name = given["value"], str(given["name"])[:LONG]
        if isinstance(value, str) and (len(value) > LONG or name == "robot_description"):
            if value not in self._texts:
                self._texts.append(value)
            return Parameter(name, "", self._texts.index(value), given["wrapped"])
        if isinstance(value, str):
            self._look_for_paths([value])
        text = value if isinstance(value, str) else json.dumps(value, default=str)
        return Parameter(name, text[:1000], -1, given["wrapped"])

    def _look_for_paths(self, words: list[str]) -> None:
        """Files that a node is told to read have to be there."""
        for before, word in zip(("", *words), words, strict=False):
            path = word.removeprefix("file://")
            if before in _FILE_OPTIONS and not path.startswith("/"):
                path = os.path.abspath(path)  # from where the launch file is started
            if path.startswith("/") and path.endswith(SUFFIXES) and " " not in path:
                if path.startswith(f"{self._place.stubs}/"):
                    continue
                self.path(path)

    def lack(self, kind: str, name: str, source: str) -> None:
        """Something is named that is not there; `source` is where the file lies that was meant."""
        own = self._place.own(source) if source else ""
        self._add("lacking", Lacking(kind, name, own, ""))


def _end(text: str) -> str:
    return end_of(" ".join(text.split()), _LONGEST_SAID)
