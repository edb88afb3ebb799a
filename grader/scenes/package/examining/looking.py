"""One package that is laid out, looked at: one step of a stranger's code after the other."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import replace
from difflib import get_close_matches
from functools import partial
from pathlib import Path
from typing import Any

from grader import strict_json
from grader.message import NOTHING, Message, msg, plain_text
from grader.scenes.package import trace
from grader.scenes.package.examining import descriptions, launches, paths, surfaces
from grader.scenes.package.examining.layout import Installed, Workspace
from grader.scenes.package.examining.steps import (
    Ended,
    attempt,
    open_account,
    step,
)
from grader.scenes.package.examining.taken import Evaluated
from grader.scenes.package.trace import (
    Description,
    Lacking,
    LaunchedNode,
    LaunchFile,
    NamedMesh,
    Obstacle,
    PackageTrace,
    Setup,
    Varied,
)
from grader.strict_json import Made

_MOST_LAUNCHES, _MOST_TEXTS = 40, 20
#: Of a launch file so much is looked at for a line [bytes].
_LONGEST_FILE = 1_000_000
#: Of a text that is too long, and of one too many: from a launch file, from a file.
_HANDED_ON = (
    msg("hands on a text of {length} characters; {most} at most are taken"),
    msg("hands on more than {most} descriptions and long texts"),
)
_FROM_A_FILE = (
    msg("is a text of {length} characters; {most} at most are taken"),
    msg("is more than {most} descriptions and long texts"),
)


class Looking:
    """One package that is laid out, looked at."""

    def __init__(self, place: Workspace, scratch: Path) -> None:
        self._place = place
        self._scratch = scratch
        self._texts: list[str] = []
        self._triangles: list[str] = []
        self._surfaces: dict[str, int] = {}
        self._descriptions: list[Description] = []
        #: the first description that is made of a file of ours: its number, and that file
        self._first: tuple[int, str] | None = None
        self._files: dict[str, tuple[Installed, str]] = {}
        #: launch files in which there is nothing but nodes
        self.plain: list[str] = []
        #: why no launch file is evaluated any more, if anything
        self._gone = NOTHING

    def trace(self, *, is_whole: bool = True) -> PackageTrace:
        """All of it, or what launch files would start."""
        place = self._place
        self._files = _launch_files(place)
        self._miss("a setup.py")
        found = [self._launch(told) for told in self._files]
        varied = self._besides(found) if is_whole else []
        return PackageTrace(
            setup=_told(self._setup(), place),
            others=tuple(each.name[:200] for each in place.all if each is not place.judged)[:100],
            launches=tuple(found),
            descriptions=tuple(self._descriptions),
            varied=tuple(varied),
            texts=tuple(self._texts),
            surfaces=tuple(self._triangles),
        )

    def _besides(self, found: list[LaunchFile]) -> list[Varied]:
        """What is looked at beside launch files; descriptions with other numbers."""
        if not any(each.text >= 0 for each in self._descriptions):
            self._from_files()
        varied = self._varied()
        self._elsewhere(found)
        self._read_meshes()
        return varied

    def _setup(self) -> Setup:
        """The judged package's; with the dependencies of those whose launch files count."""
        setups = [of.setup for of, _ in self._files.values()]
        names = [n for each in (self._place.judged.setup, *setups) for n in each.depends]
        return replace(self._place.judged.setup, depends=tuple(dict.fromkeys(names)))

    def _launch(self, file: str) -> LaunchFile:
        try:
            return self._evaluate(file)
        except Ended as ended:
            return _ended(file, _told(ended.problem, self._place))

    def _evaluate(self, file: str) -> LaunchFile:
        """A launch file as what was taken down of it; Ended: nothing was."""
        if self._gone:
            raise Ended.by_limit(msg("cannot be evaluated: {why}", why=self._gone))
        try:
            said = _said(partial(launches.evaluate, self._place, *self._files[file]), self._place)
        finally:
            if gone := self._miss(file):
                raise Ended.by_limit(msg("takes away {file}", file=gone))
        return attempt(lambda: self._taken(file, said), file)

    def _miss(self, by: str) -> str:
        """What is not there any more, after a file was evaluated; '' for nothing."""
        if gone := self._place.taken_away()[:200]:
            self._gone = msg("{file} has taken away {other}", file=by[:200], other=gone)
        return gone

    def _taken(self, file: str, said: Any) -> LaunchFile:
        """A launch file as what was taken down of it."""
        found = strict_json.from_json(Evaluated, said)
        numbers = [self._number(text) for text in found.texts]
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
        if not found.others:
            self.plain.append(file)
        for node in launch.nodes:
            if "robot_state_publisher" in (node.executable, node.package):
                for each in node.parameters:
                    if each.name == "robot_description":
                        is_empty = not self._texts[each.text].strip()
                        refused = found.refused[0][:400] if is_empty and found.refused else ""
                        self._describe(each.text, launch.file, found.sources, refused)
        return launch

    def _line(self, file: str, name: str) -> int:
        """The one line of a launch file that has the last part of a path or name; 0 for none."""
        of, own = self._files[file]
        try:
            text = paths.read(of.package.folder / own, _LONGEST_FILE).decode("utf-8", "replace")
        except OSError:  # its own code has taken it away
            return 0
        word = name.replace(" ", "/").rstrip("/").rsplit("/", 1)[-1]
        found = [n for n, line in enumerate(text.splitlines(), 1) if word and word in line]
        return found[0] if len(found) == 1 else 0

    def _used_and_wrong(self, found: Evaluated) -> tuple[tuple[str, ...], list[str]]:
        """Packages that are used, and names that are wrong: of a package whose files are ours."""
        ours = [each.name for each in self._place.all]
        wrong = [
            name
            for name in found.missing
            if name in found.borrowed or get_close_matches(name, ours, 1, 0.85)
        ]
        used = [name for name in found.missing if name not in wrong]
        return (*found.launch.packages, *used), wrong

    def _number(self, text: str, *, is_file: bool = False) -> int:
        """The number of a text; Ended: it is more than is taken."""
        of = _FROM_A_FILE if is_file else _HANDED_ON
        if len(text) > trace.LONGEST_TEXT:
            values = {"length": f"{len(text):,}", "most": f"{trace.LONGEST_TEXT:,}"}
            raise Ended.by_limit(of[0].given(**values))
        if text in self._texts:
            return self._texts.index(text)
        if len(self._texts) >= _MOST_TEXTS:
            raise Ended.by_limit(of[1].given(most=_MOST_TEXTS))
        self._texts.append(text)
        return len(self._texts) - 1

    def _describe(
        self, number: int, by: str, sources: Sequence[str], refused: str = "", launched: bool = True
    ) -> None:
        """Take down a description, once; `refused`: why xacro has made none."""
        if any(each.text == number for each in self._descriptions):
            return
        text = self._texts[number] if number >= 0 else ""
        real = self._real(text)
        named = descriptions.meshes(real, self._place)
        made = Description(
            text=number,
            by=by,
            is_launched=launched,
            source=next((each for each in map(self._own, sources) if each), ""),
            problem=Obstacle("error", plain_text(refused)) if refused else None,
            meshes=named or (),
            is_xml=named is not None,
        )
        is_ours = bool(sources) and sources[0].startswith((f"{trace.PREFIX}/", "/source/"))
        if is_ours and self._first is None:
            self._first = len(self._descriptions), self._real(sources[0])
        self._descriptions.append(made)

    def _read_meshes(self) -> None:
        """What the meshes look like; last and by an account of its own, since it earns nothing."""
        open_account(surfaces.CPU_S)
        for number, each in enumerate(self._descriptions):
            meshes = tuple(replace(mesh, surface=self._surface(mesh)) for mesh in each.meshes)
            self._descriptions[number] = replace(each, meshes=meshes)

    def _surface(self, mesh: NamedMesh) -> int:
        """The number of a mesh's triangles; -1 where nobody can read it."""
        path = mesh.path if mesh.is_mesh and mesh.state == "found" else ""
        if path and path not in self._surfaces and len(self._surfaces) < surfaces.MOST_MESHES:
            self._surfaces[path] = -1
            with suppress(Ended):
                work = partial(surfaces.surface, self._real(path))
                said = str(step(work, self._place.own))
                if said and len(said) <= trace.LONGEST_SURFACE:
                    self._surfaces[path] = len(self._triangles)
                    self._triangles.append(said)
        return self._surfaces.get(path, -1)

    def _own(self, told: str) -> str:
        return self._place.own(self._real(told))

    def _real(self, text: str) -> str:
        """A text with the places as they are here."""
        for each in self._place.all:
            text = text.replace(f"/source/{each.name}", str(each.package.folder))
        places = {trace.PREFIX: self._place.prefix, trace.ROS: self._place.stubs}
        for told, path in places.items():
            text = text.replace(f"{told}/", f"{path}/")
        return text

    def _from_files(self) -> None:
        """Descriptions that no launch file hands on; they stand in for one that should."""
        place = self._place
        try:
            if self._gone:
                raise Ended(Obstacle("limit", msg("nobody can look at it: {why}", why=self._gone)))
            said = _said(partial(descriptions.from_files, place), place)
            attempt(partial(self._take_files, said))
        except Ended as ended:
            problem = _told(ended.problem, place)
            self._descriptions.append(Description(-1, "", False, "", problem, (), False))

    def _take_files(self, said: list[dict[str, str]]) -> None:
        for each in said:
            self._from_file(str(each["file"]), str(each["text"]), str(each["errors"]))

    def _from_file(self, file: str, text: str, errors: str) -> None:
        """What xacro makes of a file, or says of it."""
        problem = Obstacle("error", plain_text(f"xacro: {errors}"[:1000]), file, 0)
        if text:
            try:
                self._describe(self._number(text, is_file=True), file, [file], launched=False)
                return
            except Ended as ended:
                problem = replace(ended.problem, file=file)
        self._descriptions.append(Description(-1, file, False, file, problem, (), False))

    def _varied(self) -> list[Varied]:
        if self._first is None or not self._first[1].endswith((".xacro", ".xml", ".urdf")):
            return []
        of, source = self._first
        with suppress(Ended):
            said = step(partial(descriptions.varied, self._place, source), self._place.own)
            return attempt(partial(self._vary, of, said))
        return []

    def _vary(self, of: int, said: list[dict[str, str]]) -> list[Varied]:
        made = []
        for each in said:
            name, text = str(each["name"])[:200], str(each["text"])
            if len(text) > trace.LONGEST_TEXT or len(self._texts) > 100:
                continue
            if text and text not in self._texts:
                self._texts.append(text)
            made.append(Varied(of, name, self._texts.index(text) if text else -1))
        return made

    def _elsewhere(self, found: list[LaunchFile]) -> None:
        """The same at another place: what is found there no more was named by its whole path."""
        before = self._place
        moved = self._scratch / "moved"
        try:
            before.prefix.rename(moved)
        except OSError:  # what was evaluated last has taken it away
            return
        self._place = place = replace(before, prefix=moved)
        for number, launch in enumerate(found):
            if launch.problem is not None:
                continue
            again: list[str] = []
            with suppress(Ended):
                said = _said(partial(launches.evaluate, place, *self._files[launch.file]), place)
                again = attempt(partial(_lacking_files, said))
            known = {each.name for each in launch.lacking}
            other = next((name for name in again if name not in known), "")
            if other:
                found[number] = LaunchFile(**{**vars(launch), "moved": other[:1000]})


def _launch_files(place: Workspace) -> dict[str, tuple[Installed, str]]:
    """As it is told of -> a launch file; of the packages beside the judged one if it has none."""
    own = {file: (place.judged, file) for file in place.judged.package.launch_files}
    beside = {
        f"{each.name}/{file}": (each, file)
        for each in place.all
        if each is not place.judged
        for file in each.package.launch_files
    }
    return dict(list((own or beside).items())[:_MOST_LAUNCHES])


def _said(work: Callable[[], Any], place: Workspace) -> Any:
    """What a step says, with the places as everybody knows them; Ended: it says nothing."""
    return _cleaned(step(work, place.own), place)


def _lacking_files(said: Any) -> list[str]:
    launch = strict_json.from_json(Evaluated, said).launch
    return [each.name for each in launch.lacking if each.kind == "file"]


def _renumbered(node: LaunchedNode, numbers: list[int]) -> LaunchedNode:
    """A node whose texts have their numbers in a trace."""
    parameters = (
        each if each.text < 0 else replace(each, text=numbers[each.text])
        for each in node.parameters
    )
    return replace(node, parameters=tuple(parameters))


def _ended(file: str, problem: Obstacle) -> LaunchFile:
    return LaunchFile(file, problem, (), (), (), (), (), (), (), "")


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


def _told(made: Made, place: Workspace) -> Made:
    """A dataclass with the places as everybody knows them."""
    return strict_json.from_json(type(made), _cleaned(strict_json.to_json(made), place))


def _cleaned(value: Any, place: Workspace) -> Any:
    """JSON with the places as everybody knows them."""
    if isinstance(value, str):
        return place.told(value)
    if isinstance(value, dict):
        return {str(key): _cleaned(each, place) for key, each in value.items()}
    if isinstance(value, list | tuple):
        return [_cleaned(each, place) for each in value]
    return value
