"""What of a file, a folder, a package or a zip to start, found without running or importing it.

The rules, in order:

1. A `.py` file is itself what to start.
2. In a folder, a console script of a package (setup.py, setup.cfg, pyproject.toml): the one that
   is asked for, else `turtle_controller`, else the only one.
3. Else a Python file that starts itself or has a function `main`: the one that is asked for, else
   `turtle_controller.py`, else `main.py`, else the only one.

What these do not settle is a SubmissionError that lists the candidates.
"""

from __future__ import annotations

import errno
from itertools import islice
from pathlib import Path
from sys import stdlib_module_names
from typing import Final

from grader.errors import SubmissionError, UsageError
from grader.submission.entry_points import (
    USUAL_NAME,
    Packages,
    example,
    find_module,
    find_packages,
    no_such_executable,
)
from grader.submission.folder import (
    HAND_IN,
    MAX_ENTRIES,
    HandedIn,
    copy,
    entries_of,
    files_below,
    is_junk,
    listed,
    near,
    shown,
    top_of,
)
from grader.submission.python_source import Source, read_source
from grader.submission.setup_files import ConsoleScript, Package
from grader.submission.start import EntryPoint, Script, Submission

_UNREADABLE: Final = (
    *(errno.EACCES, errno.EPERM, errno.ENOENT),
    *(errno.ENOTDIR, errno.ELOOP, errno.ENAMETOOLONG),
)
_CPP: Final = {".cpp", ".cc", ".cxx", ".c", ".hpp", ".h"}
_ARCHIVES: Final = {".tar", ".gz", ".tgz", ".bz2", ".xz", ".rar", ".7z"}


def find(path: Path, executable: str | None, scratch: Path) -> Submission:
    """Find what to start.

    Args:
        executable: chooses among the console scripts or Python files of a folder or zip; a single
            .py file leaves no choice.
        scratch: an empty folder, for what has to be unpacked or mended.

    Raises:
        SubmissionError: there is nothing to start, or no way to tell what.
        UsageError: there is no such path; or a choice is asked for where there is none.
        OSError: something is wrong with the machine.
    """
    try:
        return _find(path, executable, scratch)
    except OSError as error:
        if error.errno not in _UNREADABLE:
            raise
        raise _unreadable(path, error) from error


def _find(path: Path, executable: str | None, scratch: Path) -> Submission:
    name = shown(path.name or path.resolve().name)
    if not path.exists():
        raise _missing(path)
    if path.is_dir():
        return _in_folder(HandedIn(name, path.resolve()), executable, scratch)
    is_python = path.suffix == ".py"
    if not is_python and path.suffix.lower() != ".zip":
        raise SubmissionError(
            f"{name} is neither a .py file, nor a folder, nor a .zip. {_advice(path)}"
        )
    if not path.is_file():
        raise SubmissionError(f"{name} is not an ordinary file. {HAND_IN}")
    if is_python:
        if executable is not None and executable not in (path.stem, path.name):
            raise UsageError(
                f"there is no {executable!r} in {name}: a single .py file is itself what is "
                "started, and there is nothing to choose. Leave out --executable."
            )
        folder = path.parent.resolve()
        return _from_file(HandedIn(name, folder), folder / path.name)
    from grader.submission.archive import unpack  # here: most submissions are no zip

    unpacked = scratch / "unpacked"
    unpacked.mkdir()
    unpack(path, unpacked)
    return _in_folder(HandedIn(name, unpacked), executable, scratch)


def _advice(path: Path) -> str:
    kind = path.suffix.lower()
    if kind == ".py":
        return f"Python imports no {path.suffix}: call it {path.stem}.py."
    if kind in _ARCHIVES:
        return "Unpack it, and pack the same as a .zip."
    if kind == ".ipynb":
        return "Save the notebook as a Python file (.py), and hand in that."
    return f"Only Python can be graded. {HAND_IN}" if kind in _CPP else HAND_IN


def _missing(path: Path) -> UsageError:
    folder = path.parent
    if not folder.is_dir():
        return UsageError(f"{shown(path)} does not exist: there is no folder {shown(folder)}.")
    there = islice((entry.name for entry in folder.iterdir()), MAX_ENTRIES)
    meant = near(path.name, sorted(there))
    advice = f"Did you mean {listed(meant)}?" if meant else "Check the name and the folder."
    return UsageError(f"{shown(path)} does not exist. {advice}")


def _unreadable(path: Path, error: OSError) -> SubmissionError:
    base, culprit = path.resolve(), Path(error.filename or path)
    called = culprit.relative_to(base) if base in culprit.parents else path
    is_long = error.errno == errno.ENAMETOOLONG
    return SubmissionError(
        f"{shown(called)} cannot be read: {error.strerror}. "
        f"{'Shorten its name' if is_long else 'Check its permissions'}, and hand it in again."
    )


def _in_folder(handed_in: HandedIn, executable: str | None, scratch: Path) -> Submission:
    top = top_of(handed_in.base)
    if all(is_junk(entry.name) for entry in entries_of(top, MAX_ENTRIES)):
        raise SubmissionError(f"{handed_in.name} is an empty folder. {HAND_IN}")
    files = files_below(top)
    packages = find_packages(handed_in, files)
    if choice := packages.choose(executable):
        return _from_script(handed_in, *choice, scratch)
    candidates = [file for file in files if _may_be_node(file)]
    _must_need_no_script(packages, candidates)
    if not candidates:
        raise _no_python(handed_in, files)
    chosen = _only(handed_in, candidates, executable)
    handed_in.must_hold(chosen)
    return _from_file(handed_in, chosen)


def _from_script(
    handed_in: HandedIn, package: Package, script: ConsoleScript, scratch: Path
) -> Submission:
    module = find_module(handed_in, package, script)
    start = EntryPoint(script.module, script.function)
    found = f"console script {shown(script.name)} in {handed_in.called(script.file)}"
    if not module.bare:
        return Submission(handed_in.name, module.root, start, found)
    # without its __init__.py, Python prefers any installed package of the same name
    mended = scratch / "with_init"
    copy(module.root, mended)
    for folder in module.bare:
        (mended / folder / "__init__.py").touch()
    missing = listed(str(folder / "__init__.py") for folder in module.bare)
    return Submission(handed_in.name, mended, start, f"{found}, with the missing {missing} added")


def _from_file(handed_in: HandedIn, file: Path) -> Submission:
    """Start a file that no package describes."""
    source = read_source(file)
    called = handed_in.called(file)
    if not source.parses or source.has_guard or source.calls_main or not source.has_main:
        return Submission(handed_in.name, file.parent, Script(file), f"file {called}")
    # one called like a module of Python may find that loaded already, instead of itself
    by_name = "." not in file.stem and file.stem not in stdlib_module_names
    start = EntryPoint(file.stem, "main") if by_name else Script(file, "main")
    return Submission(handed_in.name, file.parent, start, f"function main of {called}")


def _may_be_node(file: Path) -> bool:
    is_launch_file = file.name.endswith((".launch.py", "_launch.py"))
    is_other = is_launch_file or file.name in ("setup.py", "__init__.py")
    return file.suffix == ".py" and not is_other


def _only(handed_in: HandedIn, candidates: list[Path], executable: str | None) -> Path:
    """Choose the Python file to start."""
    starting = [file for file in candidates if _starts(read_source(file))] or candidates
    if executable:
        chosen = [file for file in starting if executable in (file.stem, file.name)]
        if not chosen:
            names = [handed_in.called(file) for file in starting]
            raise no_such_executable(handed_in, "Python file", executable, names)
    else:
        usual = [[file for file in starting if file.stem == s] for s in (USUAL_NAME, "main")]
        chosen = usual[0] or usual[1] or starting
    if len(chosen) > 1:
        raise SubmissionError(
            f"{handed_in.name} has several Python files to start: "
            f"{listed(map(handed_in.called, chosen))}. Expected one, called {USUAL_NAME}.py; "
            "choose another with --executable NAME, or hand in only that file."
        )
    return chosen[0]


def _starts(source: Source) -> bool:
    return source.has_guard or source.has_main


def _must_need_no_script(packages: Packages, candidates: list[Path]) -> None:
    """Refuse a setup.py without console scripts, with the line that it lacks."""
    for package in packages.readable:
        if package.has_setup_py:
            own = [file for file in candidates if file.is_relative_to(package.folder)]
            likely = [file for file in own if file.stem == USUAL_NAME] or own
            module = "my_package.turtle_controller"
            if len(likely) == 1:
                inside = likely[0].relative_to(package.folder).with_suffix("")
                module = ".".join(inside.parts)
            called = packages.handed_in.called(package.folder / "setup.py")
            raise SubmissionError(
                f"{called} names no console script, so that `ros2 run` finds nothing to start. "
                f"Expected in its entry_points: {example(module)}."
            )


def _no_python(handed_in: HandedIn, files: list[Path]) -> SubmissionError:
    names = [handed_in.called(file) for file in files]
    holds = f"it holds: {listed(names) or 'only folders that are not searched'}"
    if any(file.suffix.lower() in _CPP or file.name == "CMakeLists.txt" for file in files):
        return SubmissionError(
            f"{handed_in.name} has no Python node, but C++ ({holds}). Only Python can be graded. "
            f"{HAND_IN}"
        )
    return SubmissionError(
        f"{handed_in.name} has no Python file that could be the node ({holds}). {HAND_IN}"
    )
