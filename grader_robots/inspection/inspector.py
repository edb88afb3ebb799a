"""The inspection `robot_description`: the robots that a package describes, and how they look.

`examine` is called in the process of the inspection, so that what only reports need (numpy) is
imported where it is shown.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Final

from grader.submission import Examination, Inspector, package_trace, steps
from grader.text import Message, msg
from grader_robots.inspection import files, meshes

if TYPE_CHECKING:
    from grader.recording import Trace
    from grader.scenes.view import Part


#: So many descriptions are looked at with other numbers.
_MOST_MADE: Final = 3


class RobotInspector(Inspector):
    """Robots by their descriptions: those that launch files hand on, else those of files."""

    def examine(
        self, examination: Examination, trace: package_trace.PackageTrace
    ) -> package_trace.PackageTrace:
        """Return the trace with descriptions, what they are with other numbers, and meshes."""
        robots = _Robots(examination)
        for launch, found in examination.evaluated:
            robots.add_launched(launch, found.sources, found.refused)
        if not any(each.text >= 0 for each in robots.descriptions):
            robots.add_files()
        varied = robots.varied()
        robots.read_meshes()
        return replace(
            trace,
            descriptions=tuple(robots.descriptions),
            varied=tuple(varied),
            surfaces=tuple(robots.surfaces),
        )

    def words(self, trace: package_trace.PackageTrace) -> Sequence[Message]:
        from grader_robots.scene import described

        return (described.words(trace),)

    def parts(self, trace: package_trace.PackageTrace) -> Sequence[Part]:
        """Return the robot as a solid that can be turned, and the tree of its links."""
        from grader_robots.scene import described

        found = described.solid(trace), described.links(trace)
        return [part for part in found if part is not None]

    def odd_traces(self) -> Mapping[str, Trace]:
        """Return the traces of packages that describe odd robots."""
        from grader_robots.inspection.oddities import odd_traces

        return odd_traces()


class _Robots:
    """The robots of one package, as they are found."""

    def __init__(self, examination: Examination) -> None:
        self.descriptions: list[package_trace.Description] = []
        self.surfaces: list[str] = []
        self._examination = examination
        self._workspace = examination.workspace
        self._surface_of: dict[str, int] = {}
        #: descriptions that are made of a file of the package: their numbers, and that file
        self._made: list[tuple[int, str]] = []

    def add_launched(
        self, launch: package_trace.LaunchFile, sources: Sequence[str], refused: Sequence[str]
    ) -> None:
        """Add what a launch file hands to a robot_state_publisher.

        Args:
            sources: the files that were read for it.
            refused: what xacro said where it made nothing.
        """
        for node in launch.nodes:
            if "robot_state_publisher" not in (node.executable, node.package):
                continue
            for each in node.parameters:
                if each.name == "robot_description":
                    is_empty = not self._examination.texts[each.text].strip()
                    why = refused[0][:400] if is_empty and refused else ""
                    self._add(each.text, launch.file, sources, why)

    def add_files(self) -> None:
        """Add descriptions that no launch file hands on; they stand in for one that should."""
        obstacle = self._examination.obstacle
        try:
            if obstacle:
                raise steps.Ended(
                    package_trace.Obstacle(
                        "limit", msg("nobody can look at it: {why}", why=obstacle)
                    )
                )
            answer = self._examination.step(partial(files.expanded, self._workspace))
            steps.attempt(partial(self._add_answered, answer))
        except steps.Ended as ended:
            problem = self._examination.shown(ended.problem)
            self.descriptions.append(
                package_trace.Description(-1, "", False, "", problem, (), False)
            )

    def varied(self) -> list[package_trace.Varied]:
        """Return descriptions with one number doubled, for each number of their xacro."""
        found: list[package_trace.Varied] = []
        for of, source in self._made[:_MOST_MADE]:
            with suppress(steps.Ended):
                answer = steps.step(
                    partial(files.varied, self._workspace, source), self._workspace.own
                )
                found += steps.attempt(partial(self._varied, of, answer))
        return found

    def read_meshes(self) -> None:
        """Read what meshes look like; last, and by an account of its own: it earns nothing."""
        steps.open_account(meshes.CPU_S)
        for number, each in enumerate(self.descriptions):
            read = tuple(replace(mesh, surface=self._surface(mesh)) for mesh in each.meshes)
            self.descriptions[number] = replace(each, meshes=read)

    def _add(
        self, number: int, by: str, sources: Sequence[str], refused: str = "", launched: bool = True
    ) -> None:
        """Add a description, once; `refused`: why xacro has made none."""
        if any(each.text == number for each in self.descriptions):
            return
        text = self._examination.texts[number] if number >= 0 else ""
        named = files.named_meshes(self._examination.real(text), self._workspace)
        description = package_trace.Description(
            text=number,
            by=by,
            is_launched=launched,
            source=next((each for each in map(self._examination.own, sources) if each), ""),
            problem=package_trace.Obstacle("error", Message.of(refused)) if refused else None,
            meshes=named or (),
            is_xml=named is not None,
        )
        is_ours = bool(sources) and sources[0].startswith((f"{package_trace.PREFIX}/", "/source/"))
        if is_ours and sources[0].endswith((".xacro", ".xml", ".urdf")):
            self._made.append((len(self.descriptions), self._examination.real(sources[0])))
        self.descriptions.append(description)

    def _add_answered(self, answer: list[dict[str, str]]) -> None:
        for each in answer:
            self._add_file(str(each["file"]), str(each["text"]), str(each["errors"]))

    def _add_file(self, file: str, text: str, errors: str) -> None:
        """Add what xacro makes of a file, or says of it."""
        problem = package_trace.Obstacle("error", Message.of(f"xacro: {errors}"[:1000]), file, 0)
        if text:
            try:
                number = self._examination.number(text, is_file=True)
                self._add(number, file, [file], launched=False)
                return
            except steps.Ended as ended:
                problem = replace(ended.problem, file=file)
        self.descriptions.append(
            package_trace.Description(-1, file, False, file, problem, (), False)
        )

    def _varied(self, of: int, answer: list[dict[str, str]]) -> list[package_trace.Varied]:
        made, texts = [], self._examination.texts
        for each in answer:
            name, text = str(each["name"])[:200], str(each["text"])
            if len(text) > package_trace.LONGEST_TEXT or len(texts) > 100:
                continue
            if text and text not in texts:
                texts.append(text)
            made.append(package_trace.Varied(of, name, texts.index(text) if text else -1))
        return made

    def _surface(self, mesh: package_trace.NamedMesh) -> int:
        """The number of a mesh's triangles; -1 where nobody can read it."""
        path = mesh.path if mesh.is_mesh and mesh.state == "found" else ""
        if path and path not in self._surface_of and len(self._surface_of) < meshes.MOST_MESHES:
            self._surface_of[path] = -1
            with suppress(steps.Ended):
                work = partial(meshes.surface, self._examination.real(path))
                answer = str(steps.step(work, self._workspace.own))
                if answer and len(answer) <= package_trace.LONGEST_SURFACE:
                    self._surface_of[path] = len(self.surfaces)
                    self.surfaces.append(answer)
        return self._surface_of.get(path, -1)


INSPECTOR = RobotInspector()
