"""The process that looks at a package: finds it, lays it out, evaluates it, leaves what it found.

    python main.py {"root": ..., "package": ..., "folder": ..., "leaves": ...}

It is a submission's process, confined as such: what is in it may be anything. It leaves a trace as
JSON in the open file `leaves`. Each step that runs a stranger's code is a copy of it, and cannot
reach that file.
"""

from __future__ import annotations

import json
import sys
import tempfile
from collections.abc import Sequence
from contextlib import suppress
from difflib import get_close_matches
from functools import partial
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[4]
if __name__ == "__main__":
    sys.path[0] = str(ROOT)

from grader.scenes.package import strict, trace  # noqa: E402
from grader.scenes.package.examining import (  # noqa: E402
    descriptions,
    launches,
    layout,
    leftovers,
    packages,
    surfaces,
)
from grader.scenes.package.examining.layout import Installed  # noqa: E402
from grader.scenes.package.examining.place import Place  # noqa: E402
from grader.scenes.package.examining.steps import NONSENSE, Ended, problem_of, step  # noqa: E402
from grader.scenes.package.trace import (  # noqa: E402
    Description,
    Launch,
    Mesh,
    PackageTrace,
    Problem,
    Varied,
)

_MOST_LAUNCHES, _MOST_TEXTS = 40, 20


def main() -> None:
    """Look, and leave what was found."""
    from ctypes import CDLL

    order = json.loads(sys.argv[1])
    CDLL(None).prctl(4, 0)  # PR_SET_DUMPABLE: no copy opens our descriptors by /proc
    leftovers.adopt()
    with tempfile.TemporaryDirectory(prefix="package-") as scratch:
        folder = Path(order["folder"]) if "folder" in order else None
        found = look(Path(order["root"]), order["package"], Path(scratch).resolve(), folder)
        data = trace.encode(found)
    with open(order["leaves"], "wb") as left:
        left.write(data)


def look(root: Path, asked: str, scratch: Path, folder: Path | None = None) -> PackageTrace:
    """What there is to be found in a folder with packages.

    Args:
        asked, folder: which of them counts, by its name or by where it lies; '' and None for the
            one that describes a robot.
    """
    found = packages.find(root.resolve())
    one = packages.judged(found, asked, folder and folder.resolve())
    if one is None:
        return PackageTrace()
    prefix = scratch / "prefix"
    laid = {id(each): layout.lay_out(each, root.resolve(), prefix) for each in found}
    judged, everything = laid[id(one)], tuple(laid.values())
    stubs = scratch / "stubs"
    declared = {name for each in everything for name in each.setup.depends}
    layout.make_stubs(stubs, declared, {each.name for each in everything})
    (scratch / "empty" / "home").mkdir(parents=True)
    place = Place(prefix, stubs, scratch / "empty", scratch / "asked", judged, everything)
    return Looking(place, scratch).trace()


class Looking:
    """One package that is laid out, looked at."""

    def __init__(self, place: Place, scratch: Path) -> None:
        self._place = place
        self._scratch = scratch
        self._texts: list[str] = []
        self._triangles: list[str] = []
        self._surfaces: dict[str, int] = {}
        self._descriptions: list[Description] = []
        self._commands: dict[int, list[str]] = {}
        self._files: dict[str, tuple[Installed, str]] = {}

    def trace(self) -> PackageTrace:
        """All of it."""
        place = self._place
        self._files = _launch_files(place)
        found = [self._launch(told) for told in self._files]
        if not any(each.text >= 0 for each in self._descriptions):
            found += self._from_files(found)
        varied = self._varied()
        self._elsewhere(found)
        return PackageTrace(
            setup=strict.from_json(trace.Setup, _cleaned(self._setup(), place)),
            others=tuple(each.name[:200] for each in place.all if each is not place.judged)[:100],
            launches=tuple(found),
            descriptions=tuple(self._descriptions),
            varied=tuple(varied),
            texts=tuple(self._texts),
            surfaces=tuple(self._triangles),
        )

    def _setup(self) -> dict[str, Any]:
        """The judged package's; with the dependencies of those whose launch files count."""
        setups = [of.setup for of, _ in self._files.values()]
        names = [n for each in (self._place.judged.setup, *setups) for n in each.depends]
        return {**strict.to_json(self._place.judged.setup), "depends": list(dict.fromkeys(names))}

    def _launch(self, file: str) -> Launch:
        place, (of, name) = self._place, self._files[file]
        try:
            said = step(lambda: _evaluated(place, of, name), place.own)
        except Ended as ended:
            return _ended(file, _cleaned(vars(ended.problem), place))
        said = _cleaned(said, place)
        try:
            return self._taken(file, said)
        except (ValueError, KeyError, TypeError, IndexError):
            return _ended(file, vars(Problem("limit", NONSENSE)))

    def _taken(self, file: str, said: dict[str, Any]) -> Launch:
        """A launch file as what was taken down of it."""
        numbers = [self._number(text) for text in said["texts"]]
        for node in said["nodes"]:
            for parameter in node["parameters"]:
                if parameter["text"] >= 0:
                    parameter["text"] = numbers[parameter["text"]]
        there, missing = said["asked"]
        there, missing = self._used_and_wrong(there, missing, said["borrowed"])
        lacking = [{**each, "by": each["by"] or file} for each in said["lacking"]]
        lacking += [{"kind": "package", "name": n, "source": "", "by": file} for n in missing]
        lacking = [{**each, "line": self._line(file, each["name"])} for each in lacking]
        launch = strict.from_json(
            Launch,
            {
                "file": file,
                "problem": said["problem"],
                "lacking": lacking,
                "packages": there,
                "moved": "",
                **{key: said[key] for key in ("nodes", "skipped", "processes", "includes")},
                "declared": said["declared"],
                "remarks": [*said["remarks"], *_unwrapped(file, said["nodes"])],
            },
        )
        for node in launch.nodes:
            if "robot_state_publisher" in (node.executable, node.package):
                for each in node.parameters:
                    if each.name == "robot_description":
                        refused = "" if self._texts[each.text].strip() else _first(said["refused"])
                        self._describe(each.text, launch.file, said["source"], refused)
        return launch

    def _line(self, file: str, name: str) -> int:
        """The one line of a launch file that has the last part of a path or name; 0 for none."""
        of, own = self._files[file]
        try:
            text = (of.package.folder / own).read_text(encoding="utf-8", errors="replace")
        except OSError:  # its own code has taken it away
            return 0
        word = name.replace(" ", "/").rstrip("/").rsplit("/", 1)[-1]
        found = [n for n, line in enumerate(text.splitlines(), 1) if word and word in line]
        return found[0] if len(found) == 1 else 0

    def _used_and_wrong(
        self, there: list[str], missing: list[str], borrowed: list[str]
    ) -> tuple[list[str], list[str]]:
        """Packages that are used, and names that are wrong: of a package whose files are ours."""
        ours = [each.name for each in self._place.all]
        wrong = [n for n in missing if n in borrowed or get_close_matches(n, ours, 1, 0.85)]
        return [*there, *(name for name in missing if name not in wrong)], wrong

    def _number(self, text: str) -> int:
        if len(text) > trace.LONGEST_TEXT:
            raise ValueError("a longer text than any description")
        if text in self._texts:
            return self._texts.index(text)
        if len(self._texts) >= _MOST_TEXTS:
            raise ValueError("more texts than any package has")
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
            problem=Problem("error", refused) if refused else None,
            meshes=tuple(strict.from_json(Mesh, each) for each in self._with_surfaces(named)),
            is_xml=named is not None,
        )
        if sources and sources[0].startswith("/prefix/"):
            self._commands[len(self._descriptions)] = [self._real(sources[0])]
        self._descriptions.append(made)

    def _with_surfaces(self, named: list[dict[str, Any]] | None) -> list[dict[str, Any]]:
        """The meshes of a description, each with the number of what it looks like."""
        for each in named or ():
            each["surface"] = self._surface(each.pop("real"))
        return named or []

    def _surface(self, path: str) -> int:
        """The number of a mesh's triangles; -1 where nobody can read it."""
        if path and path not in self._surfaces and len(self._surfaces) < surfaces.MOST_MESHES:
            self._surfaces[path] = -1
            with suppress(Ended, ValueError, TypeError):
                said = str(step(partial(surfaces.surface, path), self._place.own))
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

    def _from_files(self, found: Sequence[Launch]) -> list[Launch]:
        """Descriptions that no launch file hands on; they stand in for one that should."""
        place = self._place
        try:
            said = _cleaned(step(lambda: descriptions.from_files(place), place.own), place)
            for each in said["made"]:
                file = str(each["file"])
                if each["text"]:
                    self._describe(self._number(each["text"]), file, [file], launched=False)
                else:
                    problem = Problem("error", f"xacro: {each['errors']}"[:400], file, 0)
                    self._descriptions.append(
                        Description(-1, file, False, file, problem, (), False)
                    )
        except Ended as ended:
            problem = Problem(**_cleaned(vars(ended.problem), place))
            self._descriptions.append(Description(-1, "", False, "", problem, (), False))
        except (ValueError, KeyError, TypeError):
            pass
        return []

    def _varied(self) -> list[Varied]:
        place, made = self._place, []
        for of, words in list(self._commands.items())[:1]:
            if not words[0].endswith((".xacro", ".xml", ".urdf")):
                continue
            try:
                said = step(partial(descriptions.varied, place, words[0], []), place.own)
                for each in said:
                    text = str(each["text"])
                    if len(text) > trace.LONGEST_TEXT or len(self._texts) > 100:
                        continue
                    if text and text not in self._texts:
                        self._texts.append(text)
                    number = self._texts.index(text) if text else -1
                    made.append(Varied(of, str(each["name"])[:200], number))
            except (Ended, KeyError, TypeError, ValueError):
                continue
        return made

    def _elsewhere(self, found: list[Launch]) -> None:
        """The same at another place: what is found there no more was named by its whole path."""
        before = self._place
        moved = self._scratch / "moved"
        before.prefix.rename(moved)
        place = Place(moved, before.stubs, before.empty, before.asked, before.judged, before.all)
        for number, launch in enumerate(found):
            if launch.problem is not None:
                continue
            try:
                said = _cleaned(
                    step(partial(_evaluated, place, *self._files[launch.file]), place.own), place
                )
                again = [str(each["name"]) for each in said["lacking"] if each["kind"] == "file"]
            except (Ended, KeyError, TypeError):
                again = []
            known = {each.name for each in launch.lacking}
            other = next((name for name in again if name not in known), "")
            if other:
                found[number] = Launch(**{**vars(launch), "moved": other[:1000]})
        moved.rename(before.prefix)


def _launch_files(place: Place) -> dict[str, tuple[Installed, str]]:
    """As it is told of -> a launch file; of the packages beside the judged one if it has none."""
    own = {file: (place.judged, file) for file in place.judged.package.launch_files}
    beside = {
        f"{each.name}/{file}": (each, file)
        for each in place.all
        if each is not place.judged
        for file in each.package.launch_files
    }
    return dict(list((own or beside).items())[:_MOST_LAUNCHES])


def _evaluated(place: Place, of: Installed, file: str) -> dict[str, Any]:
    """In a copy: a launch file evaluated, as JSON."""
    said = launches.evaluate(place, of, file)
    error = said["problem"]
    said["problem"] = None if error is None else vars(problem_of(error, place.own))
    return {**said, "asked": launches.asked(place)}


def _first(texts: Sequence[Any]) -> str:
    return str(texts[0])[:400] if texts else ""


def _ended(file: str, problem: dict[str, Any]) -> Launch:
    return Launch(file, Problem(**problem), (), (), (), (), (), (), (), "")


def _unwrapped(file: str, nodes: Sequence[dict[str, Any]]) -> list[str]:
    given = [each for node in nodes for each in node["parameters"]]
    if all(each["wrapped"] for each in given if each["name"] == "robot_description"):
        return []
    wrapped = "ParameterValue(..., value_type=str)" if file.endswith(".py") else 'type="str"'
    return [
        "robot_description is put through YAML, which takes most descriptions and not all: "
        f"{wrapped} keeps it as it is"
    ]


def _cleaned(value: Any, place: Place) -> Any:
    """JSON with the places as everybody knows them."""
    if isinstance(value, str):
        return place.told(value)
    if isinstance(value, dict):
        return {str(key): _cleaned(each, place) for key, each in value.items()}
    if isinstance(value, list | tuple):
        return [_cleaned(each, place) for each in value]
    return value


if __name__ == "__main__":
    main()
