"""The submission's process: run what was handed in, and nothing of ours.

    python student_main.py ROOT module:function
    python student_main.py ROOT path/to/script.py [function]

Started by path, not with -m, and it imports nothing of the grader, so that the submission finds
the interpreter as it would at a student's desk. ROOT comes first on the import path; our packages
of the same names as the submission's are out of reach, whatever is installed.
"""

import ctypes
import importlib
import importlib.machinery
import importlib.util
import runpy
import signal
import sys
import traceback
from pathlib import Path

#: Installed packages that a submission must never pick up in place of its own.
OURS = ("turtlesim_challenge", "turtlesim_py", "grader")
PR_SET_PDEATHSIG = 1


class OnlyFromSubmission:
    """An import hook: modules of these names come from the submission or not at all."""

    def __init__(self, root: str) -> None:
        self._root = root

    def find_spec(self, name, path=None, target=None):  # type: ignore[no-untyped-def]
        """Find a top-level module of ours below the submission's root only."""
        if name not in OURS:
            return None
        spec = importlib.machinery.PathFinder.find_spec(name, [self._root])
        if spec is None:
            raise ModuleNotFoundError(f"No module named {name!r} in the submission", name=name)
        return spec


def run(root: str, target: str, function: str | None) -> object:
    """Start what was handed in; returns what its function returned."""
    if target.endswith(".py"):
        if function is None:
            runpy.run_path(target, run_name="__main__")
            return None
        name = Path(target).stem
        spec = importlib.util.spec_from_file_location(name, target)
        assert spec is not None and spec.loader is not None
        module = importlib.util.module_from_spec(spec)
        sys.modules[name] = module
        spec.loader.exec_module(module)
    else:
        name, _, function = target.partition(":")
        module = importlib.import_module(name)
    return getattr(module, str(function))()


def main() -> None:
    """Prepare the interpreter, run, and print a traceback without our own lines."""
    _, root, target, *more = sys.argv
    # If the grader is killed, the submission goes too.
    ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
    sys.argv = [target]
    sys.path[0] = root
    sys.meta_path.insert(0, OnlyFromSubmission(root))
    try:
        code = run(root, target, more[0] if more else None)
    except KeyboardInterrupt:
        sys.exit(130)
    except Exception as error:
        traceback.print_exception(_without_our_frames(error))
        sys.exit(1)
    sys.exit(code if isinstance(code, int) else 0)


def _without_our_frames(error: BaseException) -> BaseException:
    trace = error.__traceback__
    hidden = (__file__, runpy.__file__, importlib.__file__, "<frozen runpy>")
    while trace is not None and (
        trace.tb_frame.f_code.co_filename in hidden
        or trace.tb_frame.f_code.co_filename.startswith("<frozen importlib")
    ):
        trace = trace.tb_next
    return error.with_traceback(trace)


if __name__ == "__main__":
    main()
