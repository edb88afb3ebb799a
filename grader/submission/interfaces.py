"""The interfaces that a hand-in defines, as far as colcon would generate them; nothing is run."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from itertools import takewhile, zip_longest
from pathlib import Path
from typing import Final

from grader.inspection.examining import cmake
from grader.message import NOTHING, Message, msg
from grader.recording.recording import Interfaces
from grader.submission.folder import SubmissionFolder, near, read_bounded, shown
from grader.submission.manifest import FILE, Manifest, read_manifest

KINDS: Final = ("msg", "srv", "action")
#: So many definitions are read, and so much of them as JSON: an argument of a process holds it.
MOST, LONGEST = 100, 40_000
_GENERATE: Final = "rosidl_generate_interfaces"
_GENERATORS: Final = "rosidl_default_generators"
_GROUP: Final = ("member_of_group", "rosidl_interface_packages")
_OPTIONS: Final = (
    "LIBRARY_NAME",
    "SKIP_INSTALL",
    "SKIP_GROUP_MEMBERSHIP_CHECK",
    "ADD_LINTER_TESTS",
)
#: The packages whose types are used; a constant, which is no field.
_USED: Final = re.compile(r"^[ \t]*([a-z]\w*)/", re.MULTILINE)
_CONSTANT: Final = re.compile(r"\S+ \w+ ?=")
_LACKS: Final = msg("{file} lacks {line}: without it {what} is not generated. Add it.")


@dataclass(frozen=True)
class _Package:
    """A package as its set-up has it.

    Attributes:
        listed: the files of which it generates interfaces.
        needed: the packages that it finds, and names as dependencies of these.
        fault: why nothing of it is generated; NOTHING where something is.
    """

    manifest: Manifest
    called: str = cmake.FILE
    listed: tuple[str, ...] = ()
    needed: frozenset[str] = frozenset()
    fault: Message = NOTHING


def find_interfaces(
    submitted: SubmissionFolder, files: Iterable[Path]
) -> tuple[Interfaces, list[Message]]:
    """Return the interfaces that the packages of a hand-in generate, and remarks on these."""
    packages: dict[Path, _Package] = {}
    texts: dict[str, str] = {}
    faults: dict[str, Message] = {}
    notes: dict[Message, None] = {}
    left = LONGEST
    for file in (each for each in files if each.suffix[1:] in KINDS):
        inside = takewhile(lambda each: each.is_relative_to(submitted.base), file.parents)
        marks = (FILE, cmake.FILE)
        folder = next((each for each in inside if any((each / m).is_file() for m in marks)), None)
        if folder is None:
            continue
        if folder not in packages:
            packages[folder] = _read(submitted, folder)
        package, kind = packages[folder], file.suffix[1:]
        submitted.must_hold(file)
        data = read_bounded(file) or b""
        text = data.decode("utf-8", "replace")
        name = f"{package.manifest.name}/{kind}/{file.stem}"
        left -= len(json.dumps(text))
        fault = package.fault or _fault(package, kind, submitted.called(file), file, folder, text)
        if not fault and (left < 0 or len(texts) >= MOST):
            fault = msg(
                "{file} is one too many: {most} definitions with {n:,} characters are taken.",
                **{"file": submitted.called(file), "most": MOST, "n": LONGEST},
            )
        if fault:
            faults[name] = fault
            continue
        texts[name] = text
        needs = {*_USED.findall(text), "rosidl_default_runtime"} - {package.manifest.name}
        for need in sorted(needs - package.manifest.depends):
            notes[_undeclared(submitted.called(folder / FILE), need)] = None
    return Interfaces(texts, faults), list(notes)


def completed(found: Interfaces, theirs: Mapping[str, str]) -> Interfaces:
    """Add what parsing shows, and an exercise's interfaces, but those of packages handed in."""
    others = {n: text for n, text in theirs.items() if n.partition("/")[0] not in found.packages}
    texts = {**others, **found.texts}
    if not found.texts:
        return replace(found, texts=texts)
    from grader.rosidl.definitions import Definitions  # here: most submissions have none

    own = Definitions(texts)
    faults = {**found.faults, **{name: error.message for name, error in own.errors.items()}}
    both = [name for name in texts if name in theirs and name not in own.errors]
    if all(texts[name] == theirs[name] for name in both):
        return Interfaces(texts, faults)
    known = Definitions(theirs)
    unlike = {
        name: _difference(name, texts[name], theirs[name])
        for name in both
        if own.type_hash(name) != known.type_hash(name)
    }
    return Interfaces(texts, faults, unlike)


def undeclared(file: Path, called: str, imported: set[str]) -> list[Message]:
    """Return remarks on packages of interfaces that a program's package.xml does not name."""
    manifest = read_manifest(file) if file.is_file() else None
    if manifest is None or manifest.fault:
        return []
    return [_undeclared(called, each) for each in sorted(imported - manifest.depends)]


def _undeclared(file: str, package: str) -> Message:
    return msg(
        "{file} does not name {package}: add <depend>{package}</depend>, or colcon may build it "
        "too late, or not find it",
        file=file,
        package=shown(package),
    )


def _read(submitted: SubmissionFolder, folder: Path) -> _Package:
    """Read the package.xml and the CMakeLists.txt of a package with interfaces."""
    no_manifest = Manifest("", "", msg("is not there"))
    is_there = (folder / FILE).is_file()
    manifest = (read_manifest(folder / FILE) if is_there else None) or no_manifest
    name = manifest.name or folder.name
    package = _Package(replace(manifest, name=name))
    setup, called = submitted.called(folder / FILE), submitted.called(folder / cmake.FILE)
    if not (folder / cmake.FILE).is_file() or manifest.build_type == "ament_python":
        why = msg(
            "The package {name} is built by setup.py, which generates no interfaces. Put them "
            "into a package of their own: ros2 pkg create --build-type ament_cmake my_interfaces.",
            name=shown(name),
        )
        return replace(package, fault=why)
    if manifest.fault:
        why = msg("{file} {fault}. Correct it.", file=setup, fault=manifest.fault)
        return replace(package, fault=why)
    submitted.must_hold(folder / cmake.FILE)
    read = cmake.read(folder)
    found = {words[1] for words in read.calls if words[0] == "find_package" and words[1:]}
    listed, needed = list[str](), list[str]()
    calls = [words[2:] for words in read.calls if words[0] == _GENERATE]
    for words in calls:
        into = listed
        for word in words:
            if word == "DEPENDENCIES" or word in _OPTIONS:
                into = needed if word == "DEPENDENCIES" else []
            else:
                into.append(word)
    lacks = [
        (called, f'{_GENERATE}(${{PROJECT_NAME}} "msg/Num.msg")', bool(calls)),
        *((called, f"find_package({each} REQUIRED)", each in found) for each in needed),
        (called, f"find_package({_GENERATORS} REQUIRED)", _GENERATORS in found),
        (setup, "<{0}>{1}</{0}>".format(*_GROUP), _GROUP in manifest.elements),
    ]
    why = next(
        (
            _LACKS.given(file=f, line=line, what=shown(name))
            for f, line, is_in in lacks
            if not is_in
        ),
        NOTHING,
    )
    absent = [each for each in listed if not (folder / each).is_file()]
    if read.project != name:
        why = msg(
            "{file} calls the project {project}, and {setup} the package {name}: colcon refuses "
            "that. Give both the same name.",
            **{"file": called, "project": shown(read.project), "setup": setup, "name": shown(name)},
        )
    elif ["ament_python_install_package", name] in [words[:2] for words in read.calls]:
        why = msg(
            "{file} makes a package of Python's and one of interfaces, both called {name}, which "
            "colcon refuses. Put the interfaces into a package of their own.",
            **{"file": called, "name": shown(name)},
        )
    elif absent and not why:
        there = [
            f"{kind}/{each.name}" for kind in KINDS for each in folder.glob(f"{kind}/*.{kind}")
        ]
        meant = near(absent[0], there)
        why = msg(
            "{file} lists {path}, and there is no such file{near}. Correct its name.",
            **{"file": called, "path": shown(absent[0])},
            near=msg("; there is {near}", near=shown(meant[0])) if meant else NOTHING,
        )
    return replace(
        package, called=called, listed=tuple(listed), needed=frozenset(needed), fault=why
    )


def _fault(
    package: _Package, kind: str, called: str, file: Path, folder: Path, text: str
) -> Message:
    """Return why a definition of a package is not generated; NOTHING where it is."""
    path = file.relative_to(folder).as_posix()
    if path != f"{kind}/{file.name}":
        return msg("{file} lies in the wrong place. Move it to {to}.", file=called, to=f"{kind}/")
    if path not in package.listed:
        return msg(
            '{file} is not listed in {cmake}, so that it is not generated: add "{path}" to {call}.',
            **{"file": called, "cmake": package.called, "path": path, "call": f"{_GENERATE}()"},
        )
    for used in _USED.findall(text):
        if used not in (*package.needed, package.manifest.name):
            line = f"find_package({used} REQUIRED), {_GENERATE}(... DEPENDENCIES {used})"
            return _LACKS.given(file=package.called, line=line, what=called)
    return NOTHING


def _difference(name: str, own: str, theirs: str) -> Message:
    """Say how a type is defined otherwise than its exercise has it."""
    package, kind, stem = name.split("/")
    words = {"package": package, "file": f"{stem}.{kind}"}
    for mine, other in zip_longest(_fields(own), _fields(theirs)):
        if mine != other:
            forms = [f"`{each}`" if each else msg("nothing") for each in (mine, other)]
            return msg(
                "{file} of {package} has {own} where the exercise's has {theirs}",
                **{**words, "own": forms[0], "theirs": forms[1]},
            )
    return msg("{file} of {package} contains a type that the exercise has otherwise", **words)


def _fields(text: str) -> list[str]:
    """Return the fields of a definition, and its lines of ---, without values."""
    lines = (line.partition("#")[0].split() for line in text.splitlines())
    return [" ".join(each[:2]) for each in lines if each and not _CONSTANT.match(" ".join(each))]
