"""Runs a program confined as well as can be here: what a submission's process is allowed.

    python confined.py LEVEL FOLDER PROGRAM WORD...

FOLDER is the submission's, PROGRAM a Python file in it. First the level is printed, as the result
has it; then, if that is LEVEL, what the program prints. With `refusing.py` and `as_user.py` before
it: at other levels, as another user.
"""

from __future__ import annotations

import os
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from grader import scratch
from grader.run.processes import isolation, levels
from grader.run.processes.family import Student


def main(wanted: str, folder: str, *words: str) -> None:
    with scratch.make_folder() as stage, isolation.obtain_isolation(stage) as isolated:
        level = levels.best(isolated)
        print(level.name(), flush=True)
        if level.level != wanted:
            return
        (stage / "tmp").mkdir()
        env = {"PATH": os.environ["PATH"], "TMPDIR": str(stage / "tmp"), "GRADER": str(os.getpid())}
        place = levels.prepare(
            level, Path(folder), Path(folder), stage, is_apart=bool(isolated.namespaces)
        )
        command = [sys.executable, "-I", "-S", *words]
        student = Student(
            *(command, {**env, **place.env}, Path(folder), (), isolated.namespaces),
            confinement=place.order,
        )
        student.wait(60.0)
        student.end()
        print(student.output())


if __name__ == "__main__":
    main(*sys.argv[1:])
