"""One package that is laid out, examined: one step of a stranger's code after the other."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from dataclasses import replace
from difflib import get_close_matches
from functools import partial
from pathlib import Path
from typing import Any

from grader.submission import safe_files
from grader.submission.answer import LaunchOrder
from grader.submission.examining import launches
from grader.submission.examining.launch_record import Evaluated
from grader.submission.examining.layout import Installed, Workspace
from grader.submission.examining.steps import Ended, attempt, it, step
from grader.submission.package_trace import (
    LONGEST_TEXT,
    PREFIX,
    ROS,
    Lacking,
    LaunchedNode,
    LaunchFile,
    Obstacle,
    PackageTrace,
    Setup,
)
from grader.submission.request import LaunchAsked
from grader.system import strict_json
from grader.system.strict_json import Made
from grader.text.message import NOTHING, Message, msg

_MOST_LAUNCHES, _MOST_TEXTS = 40, 20
#: Of a launch file so much is read to find a line [bytes].
_LONGEST_FILE = 1_000_000
#: Of a text that is too long, and of one too many: from a launch file, from a file.
FROM_A_LAUNCH_FILE = (
    msg("hands on a text of {length} characters; {most} at most are taken"),
    msg("hands on more than {most} descriptions and long texts"),
)
FROM_A_FILE = (
    msg("is a text of {length} characters; {most} at most are taken"),
    msg("is more than {most} descriptions and long texts"),
)

#: An inspector's `examine`.
Examine = Callable[["Examination", PackageTrace], PackageTrace]


class Examination:
    """One package that is laid out, examined.

    Attributes:
        workspace: where it is laid out.
        texts: long texts, descriptions above all, which a trace names by their numbers.
        evaluated: each launch file that came to its end, and all that was recorded of it.
        launches: of all that were evaluated.
        orders: of the launch files that came to their end.
        obstacle: why nothing is evaluated any more, if anything.
    """

    def __init__(self, workspace: Workspace, scratch: Path, asked: LaunchAsked) -> None:
        """`asked`: the launch file that is looked at first."""
        self.workspace = workspace
        self._asked = asked
        self.texts: list[str] = []
        self.evaluated: list[tuple[LaunchFile, Evaluated]] = []
        self.launches: tuple[LaunchFile, ...] = ()
        self.orders: dict[str, LaunchOrder] = {}
        self.obstacle = NOTHING
        self._scratch = scratch
        self._files: dict[str, tuple[Installed, str]] = {}

    def trace(
        self, examine: Sequence[Examine] = (), *, is_whole: bool = True, chooses: bool = False
    ) -> PackageTrace:
        """Return what was found.

        Args:
            examine: what inspectors do besides, each with what the one before has found.
            is_whole: whether more is examined than what launch files would start.
            chooses: whether launch files of packages beside are evaluated, too, for `launches`.
        """
        workspace = self.workspace
        files = _launch_files(workspace, with_beside=not is_whole)
        beside = _launch_files(workspace, with_beside=True) if chooses else {}
        names = self._asked_first(files)
        more = self._asked_first(each for each in beside if each not in files)
        left_out = names[_MOST_LAUNCHES:]
        names, more = names[:_MOST_LAUNCHES], more[: max(0, _MOST_LAUNCHES - len(names))]
        self._files = {name: (beside | files)[name] for name in (*names, *more)}
        self._miss("a setup.py")
        evaluated = [self._launch(file) for file in names]
        setup = self.shown(self._setup([files[name][0].setup for name in names]))
        of_package = self.texts[:], self.evaluated[:]
        self.launches = (*evaluated, *map(self._launch, more))
        self.texts, self.evaluated = of_package
        if is_whole:
            self._evaluate_elsewhere(evaluated)
        if left_out:
            evaluated.append(_left_out(left_out))
        packages = [each.name[:200] for each in workspace.all if each is not workspace.judged]
        found = PackageTrace(
            setup=setup,
            others=tuple(packages[:100]),
            launches=tuple(evaluated),
            texts=tuple(self.texts),
        )
        for each in examine:
            found = replace(each(self, found), texts=tuple(self.texts))
        return found

    def _asked_first(self, files: Iterable[str]) -> list[str]:
        return sorted(files, key=lambda file: not self._asked.is_called(file))

    def number(self, text: str, *, is_file: bool = False) -> int:
        """Return the number of a text; Ended: it is more than is taken."""
        limit = FROM_A_FILE if is_file else FROM_A_LAUNCH_FILE
        if len(text) > LONGEST_TEXT:
            values = {"length": f"{len(text):,}", "most": f"{LONGEST_TEXT:,}"}
            raise Ended.by_limit(limit[0].given(**values))
        if text in self.texts:
            return self.texts.index(text)
        if len(self.texts) >= _MOST_TEXTS:
            raise Ended.by_limit(limit[1].given(most=_MOST_TEXTS))
        self.texts.append(text)
        return len(self.texts) - 1

    def real(self, text: str) -> str:
        """Return a text with the places as they are here, not as a trace shows them."""
        for each in self.workspace.all:
            text = text.replace(f"/source/{each.name}", str(each.package.folder))
        places = {
            PREFIX: self.workspace.prefix,
            ROS: self.workspace.stubs,
        }
        for shown, path in places.items():
            text = text.replace(f"{shown}/", f"{path}/")
        return text

    def own(self, shown: str) -> str:
        """Return the submission's file of a path as a trace shows it; '' for others."""
        return self.workspace.own(self.real(shown))

    def step(self, work: Callable[[], Any]) -> Any:
        """Return the answer of a step, with places as a trace shows them; Ended: it has none."""
        return _cleaned(step(work, self.workspace.own), self.workspace)

    def shown(self, made: Made) -> Made:
        """Return a dataclass with the places as a trace shows them."""
        return strict_json.from_json(
            type(made), _cleaned(strict_json.to_json(made), self.workspace)
        )

    def _setup(self, setups: Sequence[Setup]) -> Setup:
        """The judged package's; with the dependencies of those whose launch files count."""
        judged = self.workspace.judged.setup
        names = [name for each in (judged, *setups) for name in each.depends]
        return replace(judged, depends=tuple(dict.fromkeys(names)))

    def _launch(self, file: str) -> LaunchFile:
        try:
            launch, found = self._evaluate(file)
        except Ended as ended:
            return LaunchFile(file, self.shown(ended.problem))
        self.evaluated.append((launch, found))
        named = {f"{of.name}/{own}": name for name, (of, own) in self._files.items()}
        included = (named[each] for each in found.order.included if each in named)
        of, own = self._files[file]
        path = os.path.relpath(of.package.folder / own, self.workspace.root)
        self.orders[file] = replace(found.order, path=path, included=tuple(included))
        return launch

    def _evaluate(self, file: str) -> tuple[LaunchFile, Evaluated]:
        """A launch file, and all that was recorded of it; Ended: it came to no end."""
        if self.obstacle:
            raise Ended.by_limit(msg("cannot be evaluated: {why}", why=self.obstacle))
        try:
            answer = self._answer(file)
        finally:
            if gone := self._miss(file):
                raise Ended.by_limit(msg("takes away {file}", file=gone))
        return attempt(lambda: self._decoded(file, answer), file)

    def _answer(self, file: str) -> Any:
        asked = (self.workspace, *self._files[file], self._asked.given)
        return self.step(partial(launches.evaluate, *asked))

    def _miss(self, by: str) -> str:
        """What is not there any more, after a file was evaluated; '' for nothing."""
        if gone := self.workspace.taken_away()[:200]:
            self.obstacle = msg("{file} has taken away {other}", file=by[:200], other=gone)
        return gone

    def _decoded(self, file: str, answer: Any) -> tuple[LaunchFile, Evaluated]:
        """A launch file of the answer of the step that evaluated it."""
        found = strict_json.from_json(Evaluated, answer)
        numbers = [self.number(text) for text in found.texts]
        there, missing = self._used_and_wrong(found)
        lacking = [replace(each, by=each.by or file) for each in found.launch.lacking]
        lacking += [Lacking("package", name, "", file) for name in missing]
        nodes = tuple(_renumbered(each, numbers) for each in found.launch.nodes)
        launch = replace(
            found.launch,
            file=file,
            nodes=nodes,
            packages=there,
            lacking=tuple(replace(each, line=self._line(file, each.name)) for each in lacking),
            remarks=(*found.launch.remarks, *_unwrapped(file, nodes)),
        )
        return launch, found

    def _line(self, file: str, name: str) -> int:
        """The one line of a launch file that has the last part of a path or name; 0 for none."""
        of, own = self._files[file]
        try:
            text = safe_files.read(of.package.folder / own, _LONGEST_FILE).decode(
                "utf-8", "replace"
            )
        except OSError:  # its own code has taken it away
            return 0
        word = name.replace(" ", "/").rstrip("/").rsplit("/", 1)[-1]
        found = [n for n, line in enumerate(text.splitlines(), 1) if word and word in line]
        return found[0] if len(found) == 1 else 0

    def _used_and_wrong(self, found: Evaluated) -> tuple[tuple[str, ...], list[str]]:
        """Packages that are used, and names that are wrong: of a package whose files are ours."""
        ours = [each.name for each in self.workspace.all]
        wrong = [
            name
            for name in found.missing
            if name in found.borrowed or get_close_matches(name, ours, 1, 0.85)
        ]
        used = [name for name in found.missing if name not in wrong]
        return (*found.launch.packages, *used), wrong

    def _evaluate_elsewhere(self, found: list[LaunchFile]) -> None:
        """Evaluate again in another place: what is missing there was named by its whole path."""
        moved = self._scratch / "moved"
        try:
            self.workspace.prefix.rename(moved)
        except OSError:  # what was evaluated last has taken it away
            return
        self.workspace = replace(self.workspace, prefix=moved)
        for number, launch in enumerate(found):
            if launch.problem is not None:
                continue
            with suppress(Ended):
                again = attempt(
                    partial(strict_json.from_json, Evaluated, self._answer(launch.file))
                )
                known = {each.name for each in launch.lacking}
                files = (each.name for each in again.launch.lacking if each.kind == "file")
                if other := next((name for name in files if name not in known), ""):
                    found[number] = replace(launch, moved=other[:1000])


def _launch_files(workspace: Workspace, *, with_beside: bool) -> dict[str, tuple[Installed, str]]:
    """By the names of a trace: the launch files.

    Args:
        with_beside: those of the packages beside as well, and not only if it has none.
    """
    judged = workspace.judged
    own = {file: (judged, file) for file in judged.package.launch_files}
    beside = {
        f"{each.name}/{file}": (each, file)
        for each in workspace.all
        if each is not judged
        for file in each.package.launch_files
    }
    return {**own, **beside} if with_beside else own or beside


def _left_out(files: Sequence[str]) -> LaunchFile:
    """The first of the launch files that are too many to be looked at, which says so of all."""
    text = msg("was left out, with {more} more: {most} launch files at most are looked at")
    what = text.given(more=len(files) - 1, most=_MOST_LAUNCHES)
    return LaunchFile(files[0], Obstacle("unknown", it(what)))


def _renumbered(node: LaunchedNode, numbers: list[int]) -> LaunchedNode:
    """A node whose texts have their numbers in a trace."""
    parameters = (
        each if each.text < 0 else replace(each, text=numbers[each.text])
        for each in node.parameters
    )
    return replace(node, parameters=tuple(parameters))


def _unwrapped(file: str, nodes: Sequence[LaunchedNode]) -> list[Message]:
    given = [each for node in nodes for each in node.parameters]
    if all(each.wrapped for each in given if each.name == "robot_description"):
        return []
    wrapped = "ParameterValue(..., value_type=str)" if file.endswith(".py") else 'type="str"'
    remark = msg(
        "robot_description is put through YAML, which takes most descriptions and not all: {code} "
        "keeps it as it is",
        code=wrapped,
    )
    return [remark]


def _cleaned(value: Any, workspace: Workspace) -> Any:
    """JSON with the places as a trace shows them."""
    if isinstance(value, str):
        return workspace.shown(value)
    if isinstance(value, dict):
        return {str(key): _cleaned(each, workspace) for key, each in value.items()}
    if isinstance(value, list | tuple):
        return [_cleaned(each, workspace) for each in value]
    return value
