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
import traceback
from contextlib import suppress
from pathlib import Path

ROOT = Path(__file__).resolve().parents[4]
if __name__ == "__main__":
    sys.path[0] = str(ROOT)

from grader.scenes.package import trace  # noqa: E402
from grader.scenes.package.examining import layout, leftovers, packages  # noqa: E402
from grader.scenes.package.examining.looking import Looking  # noqa: E402
from grader.scenes.package.examining.place import Place  # noqa: E402
from grader.scenes.package.examining.steps import Ended, attempt, open_account  # noqa: E402
from grader.scenes.package.trace import FAILED, PackageTrace  # noqa: E402


def main() -> None:
    """Look, and leave what was found; that it cannot do so is no fault of a package."""
    try:
        _main()
    except Exception:
        traceback.print_exc()
        sys.exit(FAILED)


def _main() -> None:
    from ctypes import CDLL

    order = json.loads(sys.argv[1])
    CDLL(None).prctl(4, 0)  # PR_SET_DUMPABLE: no copy opens our descriptors by /proc
    leftovers.adopt()
    with tempfile.TemporaryDirectory(prefix="package-", ignore_cleanup_errors=True) as scratch:
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
    try:
        return attempt(lambda: _look(root, asked, scratch, folder))
    except Ended as ended:  # nothing that a step was made of: so much can be said
        return PackageTrace(setup=layout.nothing("", ended.problem))


def _look(root: Path, asked: str, scratch: Path, folder: Path | None) -> PackageTrace:
    open_account()
    found = packages.find(root.resolve())
    one = packages.judged(found, asked, folder and folder.resolve())
    if one is None:
        return PackageTrace()
    with suppress(ImportError):  # once, and not by each copy that runs it
        import xacro  # noqa: F401
    prefix = scratch / "prefix"
    stubs, empty = scratch / "stubs", scratch / "empty"
    declared = {name for each in found for name in each.depends}
    layout.make_stubs(stubs, declared, {each.name for each in found})
    (empty / "home").mkdir(parents=True)
    laid = {id(each): layout.lay_out(each, root.resolve(), prefix) for each in found}
    judged, everything = laid[id(one)], tuple(laid.values())
    place = Place(prefix, stubs, empty, scratch / "asked", judged, everything, root.resolve())
    return Looking(place, scratch).trace()


if __name__ == "__main__":
    main()
