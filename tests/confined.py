"""Runs a program confined as well as can be here: what a submission's process is allowed.

    python confined.py LEVEL FOLDER PROGRAM WORD...

FOLDER is the submission's, PROGRAM a Python file in it. First the level is printed, as the result
has it; then, if that is LEVEL, what the program prints. With `refusing.py` and `as_user.py` before
it: at other levels, as another user.
"""

import os
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from grader.run.processes import levels, network
from grader.run.processes.fork_server_main import ProcessCommand
from grader.run.processes.started_process import SubmissionProcess
from grader.system import scratch


def main(wanted: str, folder: str, *words: str) -> None:
    with scratch.make_folder() as run, network.obtain_isolation(run) as isolated:
        level = levels.best(isolated)
        print(level.name(), flush=True)
        if level.level != wanted:
            return
        (run / "tmp").mkdir()
        env = {"PATH": os.environ["PATH"], "TMPDIR": str(run / "tmp"), "GRADER": str(os.getpid())}
        is_apart = bool(isolated.namespaces)
        confinement = levels.prepare(level, Path(folder), run, is_apart=is_apart)
        command = ProcessCommand(
            [sys.executable, "-I", "-S", *words],
            {**env, **confinement.env},
            confinement.copy,
            namespaces=isolated.namespaces,
            confinement=confinement.order,
        )
        process = SubmissionProcess(command)
        process.wait(60.0)
        process.end()
        print(process.output())


if __name__ == "__main__":
    main(*sys.argv[1:])
