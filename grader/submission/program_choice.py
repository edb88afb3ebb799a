"""Finds what to start of a file, a folder, a package or an archive.

Nothing of it is run here; set-up and launch files are evaluated by an inspection.

An archive is unpacked first; so is the only one in a folder that holds no source beside it. A
`.py` file is itself what to start. For all else the table in docs/for-students.md has the rules, in
their order. In a package whose setup.py names no console script it is a Python file that starts
itself or has a function `main`: the one that is asked for, else the usual one, else `main.py`, else
the only one.

What these do not settle is a SubmissionError that lists the candidates.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from sys import stdlib_module_names
from typing import TYPE_CHECKING

from grader.errors import SubmissionError, UsageError
from grader.submission.building import shortcomings
from grader.submission.entry_points import (
    Packages,
    find_packages,
    no_such_executable,
    not_started,
    several_programs,
)
from grader.submission.examining.packages import is_launch_file
from grader.submission.folder import (
    CMAKE,
    HAND_IN,
    SETUP_FILES,
    SubmissionFolder,
    files_below,
    read_bounded,
    top_of,
)
from grader.submission.interfaces import find_interfaces
from grader.submission.launching import (
    Launched,
    find_launched,
    one_of,
    undeclared,
)
from grader.submission.manifest import FILE as MANIFEST
from grader.submission.manifest import read_manifest
from grader.submission.opened import CPP, ONLY_PYTHON, PACKAGE, opened
from grader.submission.private_copy import copy_folder
from grader.submission.program import EntryPoint, Program, Script
from grader.submission.python_source import read_source
from grader.submission.request import LaunchAsked, Request
from grader.submission.set_ups import (
    MOST,
    PackageFolder,
    Unevaluated,
)
from grader.submission.start import Submission
from grader.text.message import Message, Text, joined, msg
from grader.text.strings import listed, nearest, shown

if TYPE_CHECKING:  # what only a package needs takes time to import
    from grader.submission.answer import Inspection


def find(path: Path, request: Request, scratch: Path) -> Submission | Unevaluated:
    """Find what to start; or what has to be evaluated for that, see `find_evaluated`.

    Args:
        scratch: an empty folder, for what has to be unpacked or mended.

    Raises:
        SubmissionError: there is nothing to start, or no way to tell what.
        UsageError: there is no such path; or a choice is asked for where there is none.
        OSError: a file cannot be read, or something is wrong with the machine.
    """
    if path.suffix == ".py" and path.exists() and not path.is_dir():
        return _alone(path, request)
    submitted, files, inside = opened(path, request, scratch)
    if folders := _set_ups(submitted, files):
        return Unevaluated(submitted.base, tuple(folders), inside)
    if request.launch:
        raise _no_launch_files(submitted, request.launch)
    return _found(submitted, files, inside, scratch)


def _alone(path: Path, request: Request) -> Submission:
    """Start a single file, of which nothing but itself is handed in."""
    submitted = SubmissionFolder(shown(path.name), path.parent.resolve(), request)
    if not path.is_file():
        raise SubmissionError(
            "{name} is not an ordinary file. {hand_in}", name=submitted.name, hand_in=HAND_IN
        )
    executable = request.executable
    if executable is not None and executable not in (path.stem, path.name):
        raise UsageError(
            "there is no {executable!r} in {name}: a single .py file is itself what"
            " is started, and there is nothing to choose. Leave out --executable.",
            executable=executable,
            name=submitted.name,
        )
    if request.launch:
        raise _no_launch_files(submitted, request.launch)
    return _from_file(submitted, submitted.base / path.name)


def find_evaluated(
    package: Unevaluated, inspection: Inspection, name: str, request: Request, scratch: Path
) -> Submission:
    """Find what to start of a submission that was evaluated; see `find`."""
    submitted = SubmissionFolder(shown(name), package.base, request)
    files = files_below(top_of(package.base))
    found = _found(submitted, files, package.inside, scratch, inspection)
    if request.launch is None:
        return found
    return replace(found, notes=(*undeclared(inspection, request.launch), *found.notes))


def find_whole(path: Path, package: str | None, scratch: Path) -> Submission:
    """Find the packages of a submission that is not started.

    Args:
        package: chooses among them, by name.
        scratch: an empty folder, for what has to be unpacked.
    """
    submitted, files, _ = opened(path, Request(package, is_started=False), scratch)
    name = submitted.name
    folders = sorted(
        {file.parent for file in files if file.name in (MANIFEST, CMAKE, *SETUP_FILES)}
    )
    if not folders:
        wanted = msg("ROS 2 package: no package.xml, setup.py or CMakeLists.txt")
        raise _nothing(submitted, files, wanted, PACKAGE)
    manifests = (read_manifest(each / MANIFEST) for each in folders if (each / MANIFEST).is_file())
    names = sorted({shown(each.name) for each in manifests if each is not None and each.name})
    if package is not None and package not in names:
        meant = nearest(package, names) or names
        raise SubmissionError(
            "{name} has no package {package}; there is: {names}.",
            name=name,
            package=shown(package),
            names=listed(meant) or msg("none"),
        )
    found = msg("a package without {file}", file=MANIFEST)
    if names:
        found = msg("the package {names}", "packages {names}", n=len(names), names=listed(names))
    return Submission(name, submitted.base, (), found, asked=package or "")


def _found(
    submitted: SubmissionFolder,
    files: list[Path],
    inside: Sequence[str],
    scratch: Path,
    inspection: Inspection | None = None,
) -> Submission:
    found = _among(submitted, files, scratch, inspection)
    interfaces, notes = find_interfaces(submitted, files)
    where = found.found
    for archive in inside:
        where = msg("{found}, in {file}", found=where, file=archive)
    return replace(found, found=where, interfaces=interfaces, notes=(*found.notes, *notes))


def _among(
    submitted: SubmissionFolder,
    files: list[Path],
    scratch: Path,
    inspection: Inspection | None,
) -> Submission:
    request, executable = submitted.request, submitted.request.executable
    packages = find_packages(submitted, inspection.set_ups if inspection else ())
    together = [] if executable or request.launch else packages.together(request.programs)
    launched = Launched("", (), (), ())
    if inspection and executable is None and len(together) != 1:
        launched = find_launched(submitted, packages, inspection)
        if launched.programs:
            found = _from_programs(submitted, packages, launched.programs, scratch)
            found = replace(found, is_launched=True, found=launched.found)
            return replace(found, notes=(*launched.notes, *found.notes))
    if len(together) > 1:
        started = [packages.program(*each, number) for number, each in enumerate(together, 1)]
        found = _from_programs(submitted, packages, started, scratch)
        return replace(found, notes=(*launched.notes, *found.notes))
    try:
        choice = packages.choose()
    except SubmissionError:
        if launched.several:
            raise one_of(launched, submitted) from None
        raise
    if choice is not None:
        started = [packages.program(*choice)]
        return _from_programs(submitted, packages, started, scratch)
    candidates = [file for file in files if may_be_node(file)]
    if not candidates:
        is_cpp = any(file.suffix.lower() in CPP or file.name == CMAKE for file in files)
        wanted = msg("Python file that could be the node")
        raise _nothing(submitted, files, wanted, ONLY_PYTHON if is_cpp else HAND_IN)
    sources = {file: read_source(file) for file in candidates}
    starting = [f for f, read in sources.items() if read.has_guard or read.has_main] or candidates
    several = executable is None and len(_usual(submitted, starting)) > 1
    if several and (package := packages.holding(starting[0])):
        problem = package.problem or _no_script(submitted, package, starting)
        raise SubmissionError(joined([problem, "."]))
    chosen = _only(submitted, starting)
    submitted.must_hold(chosen)
    if package := packages.holding(chosen):
        return _without_script(submitted, package, chosen)
    others = [submitted.called(file) for file in starting if file != chosen]
    found = _from_file(submitted, chosen)
    more = [*(_unbuilt(submitted, chosen) or found.notes), *not_started(others)]
    return replace(found, notes=tuple(more))


def _nothing(
    submitted: SubmissionFolder, files: list[Path], wanted: Message, hand_in: Message
) -> SubmissionError:
    """The error that there is nothing to start or to look at, with what there is."""
    names = [submitted.called(file) for file in files]
    return SubmissionError(
        "{name} holds no {wanted} (it holds: {names}). {hand_in}",
        name=submitted.name,
        wanted=wanted,
        names=listed(names) or msg("only folders that are not searched"),
        hand_in=hand_in,
    )


def _no_launch_files(submitted: SubmissionFolder, launch: LaunchAsked) -> SubmissionError:
    return SubmissionError(
        "{name} is no package with launch files, and {file} was asked for. Hand in the folder with "
        "package.xml and setup.py.",
        name=submitted.name,
        file=shown(launch.file),
    )


def _set_ups(submitted: SubmissionFolder, files: list[Path]) -> list[str]:
    """Return the folders with set-up files, which an inspection is to evaluate."""
    of_set_ups = (*SETUP_FILES, CMAKE)
    found = dict.fromkeys(file.parent for file in files if file.name in of_set_ups)
    for file in files:
        is_of_package = not found.keys().isdisjoint(file.parents)
        if is_of_package and (file.name in of_set_ups or is_launch_file(file)):
            submitted.must_hold(file)
    if len(found) > MOST:
        raise SubmissionError(
            "{name} has {number} packages; {most} at most are looked at. Hand in yours alone.",
            name=submitted.name,
            number=len(found),
            most=MOST,
        )
    return [str(folder.relative_to(submitted.base)) for folder in found]


def _from_programs(
    submitted: SubmissionFolder, packages: Packages, started: Sequence[Program], scratch: Path
) -> Submission:
    """Start programs of packages, and files by their paths."""
    base, notes, added = submitted.base, list[Message](), dict[Path, None]()
    located = [packages.found(each) for each in started]
    if any(bare for _, bare in located):
        # without its __init__.py, Python prefers any installed package of the same name
        base = scratch / "with_init"
        notes += copy_folder(submitted.base, base)  # all of it: there may be packages beside

    def placed(path: Path) -> Path:
        return base / path.relative_to(submitted.base)

    for program, bare in located:
        added |= {program.root / folder / "__init__.py": None for folder in bare}
    for file in added:
        placed(file).touch()
    programs = tuple(program for program, _ in located)
    roots = {each.root for each in programs}
    root = programs[0].root if len(roots) == 1 else submitted.base
    short = list[Message]()
    within = ((package, each) for each in started if (package := packages.package(each)))
    package, first = next(within, (None, started[0]))
    if package is not None:
        short += shortcomings(submitted, package, first)
    names = listed(packages.called(each.package, each.executable) for each in started)
    found = msg("the programs {names}", names=names)
    if len(started) == 1 and package is not None:
        found = _one_program(submitted, package, first)
    if len(started) == 1 and added:
        missing = listed(str(each.relative_to(root)) for each in added)
        found = msg("{found}, with the missing {missing} added", found=found, missing=missing)
    submission = Submission(
        *(submitted.name, root, programs, found),
        notes=(*short, *not_started(packages.others(started)), *notes),
        added=tuple(each.relative_to(root) for each in added),
        package=None if package is None else package.folder,
        beside=tuple(dict.fromkeys(packages.roots)),
    )
    return submission.with_paths(placed)


def _one_program(submitted: SubmissionFolder, package: PackageFolder, program: Program) -> Message:
    executable = package.executable(program.executable)
    called = submitted.called(executable.file)
    if not executable.module:
        words = {"file": called, "package": shown(package.name)}
        return msg("{file}, a program of {package}", **words)
    return msg("console script {script} in {file}", script=shown(executable.name), file=called)


def _without_script(submitted: SubmissionFolder, package: PackageFolder, file: Path) -> Submission:
    """Start a file of a package that names no console script, as one would that named it."""
    source = read_source(file)
    short = tuple(shortcomings(submitted, package, None))
    if not package.problem:
        short = (*short, _no_script(submitted, package, [file]))
    inside = file.relative_to(package.folder).with_suffix("").parts
    if not source.has_main or source.is_refused or not source.parses or "." in file.stem:
        return replace(_from_file(submitted, file), notes=short, package=package.folder)
    entry = EntryPoint(".".join(inside), "main")
    found = msg("function main of {file}", file=submitted.called(file))
    return _of_file(submitted, file, entry, found, short, package.folder)


def _unbuilt(submitted: SubmissionFolder, file: Path) -> list[Message]:
    """Return the shortcomings of the package around a file that has a package.xml alone."""
    for folder in file.parents:
        if not folder.is_relative_to(submitted.base):
            break
        if (folder / MANIFEST).is_file():
            return list(shortcomings(submitted, PackageFolder(folder), None))
    return []


def _from_file(submitted: SubmissionFolder, file: Path) -> Submission:
    """Start a file that no package describes."""
    source = read_source(file)
    called = submitted.called(file)
    is_imported = source.parses and not source.is_refused and source.has_main
    if not is_imported or source.has_guard or source.calls_main:
        return _of_file(submitted, file, Script(file), msg("file {file}", file=called))
    # one called like a module of Python may find that loaded already, instead of itself
    by_name = "." not in file.stem and file.stem not in stdlib_module_names
    entry = EntryPoint(file.stem, "main") if by_name else Script(file, "main")
    note = msg(
        "Nothing in {file} calls main(): the grader did, as an entry point of a package would. By "
        "itself `python3 {file}` does nothing: end it with if __name__ == '__main__': main()",
        file=called,
    )
    found = msg("function main of {file}", file=called)
    return _of_file(submitted, file, entry, found, (note,))


def _of_file(
    submitted: SubmissionFolder,
    file: Path,
    entry: EntryPoint | Script,
    found: Message,
    notes: tuple[Message, ...] = (),
    package: Path | None = None,
) -> Submission:
    """Start a file that no package installs.

    Args:
        package: the folder of the package that it is in, from which it is imported.
    """
    root = package or file.parent
    program = Program(file.name, "", file.name, entry, root)
    return Submission(submitted.name, root, (program,), found, notes=notes, package=package)


def may_be_node(file: Path) -> bool:
    """Whether a file is Python, and none of those that every package has."""
    is_python = file.suffix == ".py" and file.name not in ("setup.py", "__init__.py")
    return is_python and not is_launch_file(file)


def _only(submitted: SubmissionFolder, candidates: list[Path]) -> Path:
    """Choose the Python file to start."""
    executable = submitted.request.executable
    if executable:
        chosen = [file for file in candidates if executable in (file.stem, file.name)]
        if not chosen:
            names = [submitted.called(file) for file in candidates]
            raise no_such_executable(submitted, executable, names)
    else:
        chosen = _usual(submitted, candidates)
    if len(chosen) > 1:
        raise several_programs(submitted, map(submitted.called, chosen), ".py")
    return chosen[0]


def _usual(submitted: SubmissionFolder, candidates: list[Path]) -> list[Path]:
    """Return the files with the usual name, else those called main, else all of them."""
    usual = [file for file in candidates if submitted.request.is_wanted(file.stem)]
    return usual or [file for file in candidates if file.stem == "main"] or candidates


def _no_script(
    submitted: SubmissionFolder, package: PackageFolder, starting: list[Path]
) -> Message:
    """Say that a setup.py names no console script, and which line it lacks."""
    likely = [file for file in starting if submitted.request.is_wanted(file.stem)] or starting
    module = "my_package.turtle_controller"
    if len(likely) == 1:
        module = ".".join(likely[0].relative_to(package.folder).with_suffix("").parts)
    called = submitted.called(package.folder / "setup.py")
    text = (read_bounded(package.folder / "setup.py") or b"").decode("utf-8", "replace")
    words = {*re.findall(r"['\"](\w*script\w*)['\"]", text)} - {"console_scripts"}
    name = module.rpartition(".")[2]
    expected: Text = f"'console_scripts': ['{name} = {module}:main']"
    if meant := nearest("console_scripts", sorted(words)):
        expected = msg("'console_scripts' instead of '{found}'", found=shown(meant[0]))
    return msg(
        "{file} names no console script, so that `ros2 run` finds nothing to "
        "start. Expected in its entry_points: {expected}",
        file=called,
        expected=expected,
    )
