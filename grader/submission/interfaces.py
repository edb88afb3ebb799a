"""The interfaces that a hand-in defines, as far as colcon would generate them; nothing is run."""

from __future__ import annotations

import json
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import takewhile, zip_longest
from pathlib import Path, PurePath
from typing import Any, Final, NamedTuple

from grader.recording.recording import OwnInterfaces
from grader.ros.bag_types import description
from grader.ros.fields import field_lines, readable
from grader.submission.examining import cmake
from grader.submission.folder import SubmissionFolder, is_passed_by, read_bounded
from grader.submission.manifest import FILE, Manifest, read_manifest
from grader.text.message import NOTHING, Message, msg
from grader.text.strings import nearest, shown
from ros_doubles.known import DESKTOP

KINDS: Final = ("msg", "srv", "action")
#: So many definitions are read, and so much of them as JSON: an argument of a process holds it.
MOST, LONGEST = 100, 40_000
#: Packages that are ROS's, even where a copy of them is handed in.
_OF_ROS: Final = DESKTOP | {"turtlesim_msgs", "unique_identifier_msgs", "service_msgs"}
_GENERATE: Final = "rosidl_generate_interfaces"
_MAKERS, _RUNTIME = "rosidl_default_generators", "rosidl_default_runtime"
_GROUP: Final = ("member_of_group", "rosidl_interface_packages")
_OPTIONS: Final = (
    "LIBRARY_NAME",
    "SKIP_INSTALL",
    "SKIP_GROUP_MEMBERSHIP_CHECK",
    "ADD_LINTER_TESTS",
)
#: In a word of CMake's with a variable that nobody knows here: it may be any.
_UNKNOWN: Final = "${"
TWICE: Final = msg(
    "two packages are called {name}: {places}, and colcon builds neither. Remove one of them."
)
_LACKS: Final = msg("{file} lacks {line}: without it {what} is not generated. Add it.")


def find_interfaces(
    submitted: SubmissionFolder, files: Iterable[Path]
) -> tuple[OwnInterfaces, list[Message]]:
    """Return the interfaces that the packages of a hand-in generate, and remarks on these."""
    places: dict[Path, Path] = {}
    for file in (each for each in files if each.suffix[1:] in KINDS):
        inside = takewhile(lambda each: each.is_relative_to(submitted.base), file.parents)
        marks = (FILE, cmake.FILE)
        folder = next((each for each in inside if any((each / m).is_file() for m in marks)), None)
        if folder is not None:
            places[file] = folder
    packages = {folder: _read(submitted, folder) for folder in dict.fromkeys(places.values())}
    twice = {each.name: _twice(submitted, packages, each.name) for each in packages.values()}
    texts, faults = dict[str, str](), dict[str, Message]()
    notes, left = list[Message](), LONGEST
    words = {"most": MOST, "n": LONGEST}
    many = msg("of its interfaces {most} with {n:,} characters in all are used.", **words)
    for file, folder in places.items():
        package = packages[folder]
        if package.name in _OF_ROS:
            continue
        submitted.must_hold(file)
        called, data = submitted.called(file), read_bounded(file)
        text = (data or b"").decode("utf-8", "replace")
        left -= len(json.dumps(text))
        name = f"{package.name}/{file.suffix[1:]}/{file.stem}"
        path = file.relative_to(folder)
        if data is None or left < 0 or len(texts) + len(faults) >= MOST:
            faults[name] = many
        elif fault := package.fault or twice[package.name] or _lack(package, path, called, text):
            faults[name] = fault
        elif text.encode() != data:
            faults[name] = msg("{file} is not UTF-8: save it as UTF-8.", file=called)
        else:
            texts[name] = text
            notes += undeclared(folder / FILE, {*_used_packages(text), _RUNTIME})
    return OwnInterfaces(texts, faults), list(dict.fromkeys(notes))


def completed(found: OwnInterfaces, theirs: Mapping[str, str]) -> OwnInterfaces:
    """Add what parsing shows, and an exercise's interfaces, but those of packages handed in."""
    others = {n: text for n, text in theirs.items() if n.partition("/")[0] not in found.packages}
    texts = {**others, **found.texts}
    if not found.texts:
        return replace(found, texts=texts)
    from grader.ros.definitions import Definitions  # here: most submissions have none

    own = Definitions(texts)
    faults = {**found.faults, **{name: error.message for name, error in own.errors.items()}}
    both = [name for name in texts if name in theirs and name not in own.errors]
    described = {name: description(name, texts[name]) for name in both}
    changed = {n for n in both if described[n] != description(n, theirs[n])}
    while more := {n for n in both if changed & _used_types(described[n])} - changed:
        changed |= more
    unlike = {n: _difference(n, texts[n], theirs[n]) for n in both if n in changed}
    return OwnInterfaces(texts, faults, unlike)


def undeclared(file: Path, packages: set[str]) -> list[Message]:
    """Return remarks on packages that a package.xml does not name."""
    manifest = read_manifest(file) if file.is_file() else None
    if manifest is None or manifest.fault:
        return []
    sentence = msg("{file} does not name {package}, so that colcon may not find it: add {line}")
    where, lacking = shown(f"{file.parent.name}/{FILE}"), packages - manifest.depends
    return [
        sentence.given(file=where, package=each, line=f"<depend>{each}</depend>")
        for each in sorted(lacking - {manifest.name})
    ]


class _Package(NamedTuple):
    """A package with definitions.

    Attributes:
        cmake: its CMakeLists.txt.
        listed: the files of which it generates interfaces.
        needed: what it names as dependencies of these.
        fault: why nothing of it is generated; NOTHING where something is.
    """

    name: str
    cmake: str
    fault: Message = NOTHING
    listed: Sequence[str] = ()
    needed: Sequence[str] = ()


def _twice(submitted: SubmissionFolder, packages: Mapping[Path, _Package], name: str) -> Message:
    """Say that several packages have a name; NOTHING where one has it."""
    same = [submitted.called(folder) for folder in packages if packages[folder].name == name]
    return TWICE.given(name=name, places=", ".join(same)) if len(same) > 1 else NOTHING


def _read(submitted: SubmissionFolder, folder: Path) -> _Package:
    """Read the package.xml and the CMakeLists.txt of a package."""
    manifest = read_manifest(folder / FILE) if (folder / FILE).is_file() else None
    manifest = manifest or Manifest("", "", msg("is not there"))
    setup, file = submitted.called(folder / FILE), submitted.called(folder / cmake.FILE)
    name = (manifest.name or folder.name)[:100]
    words = {"file": file, "setup": setup, "name": name, "call": f"{_GENERATE}()"}
    if not (folder / cmake.FILE).is_file() or manifest.build_type == "ament_python":
        why = msg(
            "The package {name} is built by setup.py, which generates no interfaces. Put them "
            "into one of their own: ros2 pkg create --build-type ament_cmake my_interfaces.",
            name=name,
        )
        return _Package(name, file, why)
    submitted.must_hold(folder / cmake.FILE)
    read = cmake.read(folder)
    parts: dict[str, list[str]] = defaultdict(list)
    part = ""
    asked = [call for call in read.calls if call[0] == _GENERATE]
    for word in (word for call in asked for word in ["", *call[2:]]):
        part = word if word in ("", "DEPENDENCIES", *_OPTIONS) else part
        parts[part] += [word] * (word != part)
    listed, needed = parts[""], parts["DEPENDENCIES"]
    target = next((call[1] for call in asked if call[1:]), "")
    is_named = target == name or "LIBRARY_NAME" in parts

    def faults() -> Iterator[Message]:
        yield _hides(submitted, folder, words)
        if manifest.fault:
            yield msg("{setup} {fault}. Correct it.", **words, fault=manifest.fault)
        yield from _wrong_commands(read, needed, words, is_named=is_named)
        if _GROUP not in manifest.elements:
            yield _LACKS.given(file=setup, line=shown("<{0}>{1}</{0}>".format(*_GROUP)), what=name)
        yield from _wrong_order_or_files(read, folder, listed, words)

    why = next(filter(None, faults()), NOTHING)
    return _Package(name, file, why, listed, needed)


def _hides(submitted: SubmissionFolder, folder: Path, words: Mapping[str, str]) -> Message:
    """Say that colcon does not look for a package in its folder; NOTHING where it does."""
    above = next((each for each in folder.parents if _is_hidden(each, submitted.base)), None)
    if above is None and not is_passed_by(folder, submitted.base):
        return NOTHING
    return msg(
        "colcon does not look into {place}. Move the package {name} beside the others, below src/.",
        **words,
        place=submitted.called(above or folder),
    )


def _wrong_commands(
    read: cmake.Read, needed: Sequence[str], words: Mapping[str, str], *, is_named: bool
) -> Iterator[Message]:
    """Yield what a CMakeLists.txt lacks, or has too many of.

    Args:
        is_named: whether what it generates has the name of the package.
    """
    file, name = words["file"], words["name"]
    if ["ament_python_install_package", name] in [call[:2] for call in read.calls]:
        yield msg(
            "{file} makes a package of Python's and one of interfaces, both called {name}, which "
            "colcon refuses. Put the interfaces into a package of their own.",
            **words,
        )
    commands = [call[0] for call in read.calls]
    found = [call[1] for call in read.calls if call[0] == "find_package" and call[1:]]
    finds_all = _UNKNOWN in " ".join(found) or "ament_auto_find_build_dependencies" in commands
    lines = [
        (f"project({name})", read.project == name),
        (f'{_GENERATE}(${{PROJECT_NAME}} "msg/Num.msg")', _GENERATE in commands),
        (f"${{PROJECT_NAME}} in {_GENERATE}()", is_named),
        *(
            (f"find_package({each} REQUIRED)", finds_all or each in found)
            for each in (*needed, _MAKERS)
        ),
    ]
    for line, is_there in lines:
        if not is_there:
            yield _LACKS.given(file=file, line=shown(line), what=name)


def _wrong_order_or_files(
    read: cmake.Read, folder: Path, listed: Sequence[str], words: Mapping[str, str]
) -> Iterator[Message]:
    """Yield what is wrong with where interfaces are generated, and with their files."""
    commands = [call[0] for call in read.calls]
    if "ament_package" in commands[: commands.index(_GENERATE)]:
        yield msg("{file} calls ament_package() before {call}: it has to be last.", **words)
    known = [each for each in listed if each and _UNKNOWN not in each]
    for each in (each for each in known if each.startswith(("./", "/"))):
        short = each.removeprefix("./")
        yield msg(
            '{file} lists the absolute path of {path}: write "{short}", or, in file(GLOB), '
            "RELATIVE ${{CMAKE_CURRENT_SOURCE_DIR}}.",
            **words,
            path=shown(short),
            short=short,
        )
    whole = folder.resolve()
    for each in known:
        file = (folder / each).resolve()
        is_inside = file.is_relative_to(whole)  # elsewhere nobody is to learn what there is
        if is_inside and file.is_file():
            continue
        names = sorted(other.name for other in file.parent.glob("*")) if is_inside else []
        near = nearest(PurePath(each).name, names)
        only = msg(", only {near}", near=shown(near[0])) if near else NOTHING
        yield msg(
            "{file} lists {path}, and there is no such file{only}. Correct its name.",
            **words,
            path=shown(each),
            only=only,
        )


def _is_hidden(folder: Path, base: Path) -> bool:
    """Whether colcon looks for no package below a folder of a hand-in: it is one itself."""
    is_package = folder.is_relative_to(base) and (folder / FILE).is_file()
    return is_package or is_passed_by(folder, base)


def _lack(package: _Package, path: PurePath, called: str, text: str) -> Message:
    """Return why a definition of a package is not generated; NOTHING where it is."""
    kind = path.suffix[1:]
    if path.parent.as_posix() != kind:
        return msg("{file} is in the wrong folder. Move it to {to}.", file=called, to=f"{kind}/")
    if str(path) not in package.listed and not any(_UNKNOWN in each for each in package.listed):
        return msg(
            "{file} is not listed in {cmake}, so that it is not generated: add {path} to {call}.",
            **{"file": called, "cmake": package.cmake},
            **{"path": f'"{path}"', "call": f"{_GENERATE}()"},
        )
    used = _used_packages(text) - {package.name, *package.needed}
    line = f"DEPENDENCIES {min(used, default='')} in {_GENERATE}()"
    return _LACKS.given(file=package.cmake, line=line, what=called) if used else NOTHING


def _used_packages(text: str) -> set[str]:
    """Return the packages whose types a definition names."""
    return {field.package for field in readable(text)} - {""}


def _used_types(fields: Sequence[Any]) -> set[str]:
    """Return the messages in a message that is described."""
    return {each["type"]["nested_type_name"] for each in fields if isinstance(each, dict)}


def _difference(name: str, own: str, theirs: str) -> Message:
    """Say how a type is defined otherwise than its exercise has it."""
    package, kind, stem = name.split("/")
    words = {"package": package, "file": f"{stem}.{kind}"}
    for mine, other in zip_longest(*map(field_lines, (own, theirs)), fillvalue="---"):
        if mine != other:
            return msg(
                "{file} of {package} has `{own}` where the exercise's has `{theirs}`",
                **{**words, "own": shown(mine), "theirs": shown(other)},
            )
    return msg("{file} of {package} contains a type that the exercise has otherwise", **words)
