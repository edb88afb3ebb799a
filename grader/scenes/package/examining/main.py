"""The process that looks at a package: finds it, lays it out, evaluates it, leaves what it found.

    python main.py {"root": ..., "package": ..., "folder": ..., "leaves": ...}
    python main.py {"root": ..., "set_ups": ..., "program": ..., "is_whole": ..., "leaves": ...}

It is a submission's process, confined as such: what is in it may be anything. It leaves a trace as
JSON in the open file `leaves`. Each step that runs a stranger's code is a copy of it, and cannot
reach that file.
"""

from __future__ import annotations

import json
import sys
import tempfile
import traceback
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

Seen = tuple["PackageTrace", tuple[str, ...]]
ROOT = Path(__file__).resolve().parents[4]
if __name__ == "__main__":
    sys.path[0] = str(ROOT)

from grader import linux  # noqa: E402
from grader.scenes.package import inspection, trace  # noqa: E402
from grader.scenes.package.examining import layout, leftovers, packages, setup_call  # noqa: E402
from grader.scenes.package.examining.looking import Looking  # noqa: E402
from grader.scenes.package.examining.place import Place  # noqa: E402
from grader.scenes.package.examining.steps import Ended, attempt, open_account  # noqa: E402
from grader.scenes.package.inspection import Inspection, SetUp  # noqa: E402
from grader.scenes.package.trace import FAILED, PackageTrace  # noqa: E402


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
        folder = Path(order["folder"]) if "folder" in order else None
        root, place = Path(order["root"]), Path(scratch).resolve()
        if "set_ups" in order:
            asked = (order["set_ups"], order["program"])
            data = inspection.encode(inspect(root, *asked, place, is_whole=order["is_whole"]))
        else:
            data = trace.encode(look(root, order["package"], place, folder))
    with open(order["leaves"], "wb") as left:
        left.write(data)


def inspect(
    root: Path, folders: list[str], program: str, scratch: Path, *, is_whole: bool
) -> Inspection:
    """What set-ups name to be started, and what there is of the package that has it.

    Args:
        folders: those that hold set-up files, below the root.
        program: the console script that is asked for.
        is_whole: whether more is looked at than launch files.
    """
    root = root.resolve()
    set_ups = tuple(SetUp(each, *setup_call.evaluate(root / each)) for each in folders)
    known = {root / each.folder: (each.told, each.problem) for each in set_ups}

    def worth(set_up: SetUp) -> tuple[bool, bool]:
        names = [line.partition("=")[0].strip() for line in set_up.told.scripts]
        return program in names, bool(names)

    best = max(set_ups, key=worth, default=None)
    if best is None:
        return Inspection()
    folder = root / best.folder
    found, plain = _attempted(lambda: _look(root, "", scratch, folder, known, is_whole=is_whole))
    return Inspection(set_ups, best.folder, found, plain)


def look(root: Path, asked: str, scratch: Path, folder: Path | None = None) -> PackageTrace:
    """What there is to be found in a folder with packages.

    Args:
        asked, folder: which of them counts, by its name or by where it lies; '' and None for the
            one that describes a robot.
    """
    return _attempted(lambda: _look(root, asked, scratch, folder, {}, is_whole=True))[0]


def _attempted(work: Callable[[], Seen]) -> Seen:
    try:
        return attempt(work)
    except Ended as ended:  # nothing that a step was made of: so much can be said
        return PackageTrace(setup=layout.nothing("", ended.problem)), ()


def _look(
    root: Path,
    asked: str,
    scratch: Path,
    folder: Path | None,
    known: layout.Known,
    *,
    is_whole: bool,
) -> Seen:
    """What was found, and launch files in which there is nothing but nodes.

    Args:
        known: set-ups that were evaluated already.
        is_whole: whether more is looked at than launch files.
    """
    open_account()
    found = packages.find(root.resolve())
    one = packages.judged(found, asked, folder and folder.resolve())
    if one is None:
        return PackageTrace(), ()
    with suppress(ImportError):  # once, and not by each copy that runs it
        import xacro  # noqa: F401
    prefix = scratch / "prefix"
    stubs, empty = scratch / "stubs", scratch / "empty"
    declared = {name for each in found for name in each.depends}
    layout.make_stubs(stubs, declared, {each.name for each in found})
    (empty / "home").mkdir(parents=True)
    laid = {id(each): layout.lay_out(each, root.resolve(), prefix, known) for each in found}
    judged, everything = laid[id(one)], tuple(laid.values())
    place = Place(prefix, stubs, empty, scratch / "asked", judged, everything, root.resolve())
    looking = Looking(place, scratch)
    return looking.trace(is_whole=is_whole), tuple(looking.plain)


if __name__ == "__main__":
    main()
