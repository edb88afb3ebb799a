"""The process that looks at a package: finds it, lays it out, evaluates it, leaves what it found.

    python main.py {"root": ..., "leaves": ..., "added": ..., ARGUMENTS OF inspect}

It is a submission's process, confined as such: what is in it may be anything. It leaves an
`Inspection` as JSON in the open file `leaves`. Each step that runs a stranger's code is a copy of
it, and cannot reach that file. What is `added` to a submission, so that it can be started, is no
part of its package: it goes.
"""

from __future__ import annotations

import json
import sys
import tempfile
import traceback
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from fnmatch import fnmatchcase
from functools import partial
from pathlib import Path
from pkgutil import resolve_name
from types import MappingProxyType
from typing import Any

ROOT = Path(__file__).resolve().parents[3]
if __name__ == "__main__":
    sys.path[0] = str(ROOT)

from grader.submission import package_trace, safe_files  # noqa: E402
from grader.submission.answer import Inspection, SetUp, SetUpFacts  # noqa: E402
from grader.submission.examining import layout, leftovers, packages, setup_call  # noqa: E402
from grader.submission.examining.examination import Examination  # noqa: E402
from grader.submission.examining.layout import Installed, Workspace  # noqa: E402
from grader.submission.examining.steps import Ended, attempt, open_account  # noqa: E402
from grader.submission.folder import SETUP_FILES  # noqa: E402
from grader.submission.package_trace import FAILED, PackageTrace  # noqa: E402
from grader.submission.request import LaunchAsked  # noqa: E402
from grader.system import linux  # noqa: E402


def main() -> None:
    """Look, and leave what was found; that it cannot do so is no fault of a package."""
    try:
        _main()
    except Exception:
        traceback.print_exc()
        sys.exit(FAILED)


def _main() -> None:
    order = json.loads(sys.argv[1])
    linux.control(linux.PR_SET_DUMPABLE, 0)  # no copy opens our descriptors by /proc
    leftovers.adopt()
    with tempfile.TemporaryDirectory(prefix="package-", ignore_cleanup_errors=True) as scratch:
        root, leaves = Path(order.pop("root")), order.pop("leaves")
        for each in order.pop("added", ()):
            (root / each).unlink()
        data = package_trace.encode(inspect(root, Path(scratch).resolve(), **order))
    with open(leaves, "wb") as left:
        left.write(data)


def inspect(
    root: Path,
    scratch: Path,
    *,
    set_ups: Sequence[str] = (),
    program: str = "",
    package: str = "",
    folder: str = "",
    inspectors: Sequence[str] | None = (),
    launch: Mapping[str, Any] = MappingProxyType({"file": ""}),
) -> Inspection:
    """Return what set-ups name to be started, and what there is of one package.

    Args:
        set_ups: folders that hold set-up files, below the root; the package that counts is then
            the one that has the program.
        program: the console script that is asked for, or a pattern of its name.
        package, folder: which package counts otherwise, by its name or by where it lies; '' for
            the one that describes a robot.
        inspectors: where the inspectors are that examine it besides; None where only what launch
            files would start is asked for.
        launch: the attributes of a `LaunchAsked`.
    """
    root = root.resolve()
    evaluated = tuple(_set_up(root, each) for each in set_ups)

    def look() -> Inspection:
        """Lay out all packages, and examine the one that counts."""
        open_account()
        found = packages.find(root)
        with suppress(ImportError):  # once, and not by each copy that runs it
            import xacro  # noqa: F401
        prefix = scratch / "prefix"
        stubs, empty = scratch / "stubs", scratch / "empty"
        declared = {name for each in found for name in each.depends}
        layout.make_stubs(stubs, declared, {each.name for each in found})
        (empty / "home").mkdir(parents=True)
        known = {root / each.folder: (each.told, each.problem) for each in evaluated}
        laid = {each.folder: layout.lay_out(each, root, prefix, known) for each in found}
        set_ups = tuple(_with_installed(each, laid.get(root / each.folder)) for each in evaluated)
        likely = max(set_ups, key=partial(_worth, program)).folder if set_ups else folder
        one = packages.judged(found, package, (root / likely).resolve() if likely else None)
        best = likely if set_ups else ""
        if one is None:
            return Inspection(set_ups, best)
        judged, everything = laid[one.folder], tuple(laid.values())
        place = Workspace(prefix, stubs, empty, scratch / "asked", judged, everything, root)
        examination = Examination(place, scratch, LaunchAsked(**launch))
        examine = [resolve_name(each).examine for each in inspectors or ()]
        is_whole, chooses = inspectors is not None, bool(set_ups)
        of_package = examination.trace(examine, is_whole=is_whole, chooses=chooses)
        return Inspection(set_ups, best, of_package, examination.launches, examination.orders)

    try:
        return attempt(look)
    except Ended as ended:  # nothing that a step was made of: so much can be said
        return Inspection(evaluated, trace=PackageTrace(setup=layout.nothing("", ended.problem)))


def _set_up(root: Path, folder: str) -> SetUp:
    """What the set-up files of a folder say; nothing of one that has CMake's alone."""
    if any(safe_files.is_file(root / folder / each) for each in SETUP_FILES):
        return SetUp(folder, *setup_call.evaluate(root / folder))
    return SetUp(folder)


def _with_installed(set_up: SetUp, laid: Installed | None) -> SetUp:
    """What a set-up says, with what it installs; CMake's own words where no other file has any."""
    if laid is None:
        return set_up
    told = laid.told if set_up.told == SetUpFacts() else set_up.told
    return replace(set_up, told=told, installed=laid.files)


def _worth(program: str, set_up: SetUp) -> tuple[bool, bool, bool]:
    """Whether a package has a program of this name; has console scripts; has any program."""
    scripts = [line.partition("=")[0].strip() for line in set_up.told.scripts]
    files = [path.rpartition("/")[2] for path in set_up.installed if path.startswith("lib/")]
    is_named = any(fnmatchcase(name, program) for name in (*scripts, *files))
    return is_named, bool(scripts), bool(files)


if __name__ == "__main__":
    main()
