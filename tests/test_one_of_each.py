"""A mechanism that there is once stays one: who needs it takes that."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
#: What -> the text by which it is known, and the only file below grader/ that may have it.
ONE = {
    "a file that cannot be written is told": (r'"cannot write', "system/files.py"),
    "a trace is serialised between processes": (r"np\.savez|np\.load\(", ""),
    "work is done in a limited copy": (r"setitimer\(signal\.ITIMER_PROF", "system/limited.py"),
    "data of others becomes a dataclass": (r"get_type_hints\(", "system/strict_json.py"),
    "what a process uses is looked up": (r"/proc/[^ ]*/stat\"", "system/linux.py"),
    "a process is controlled": (r"\.prctl|\"prctl\"", "system/linux.py"),
    "an expression is evaluated": (r"operator\.truediv", "system/expressions.py"),
    "a traceback is parsed": (r"Traceback \(most recent", "recording/observations.py"),
    "a resource is limited": (r"\.setrlimit\(", "system/linux.py"),
    "the C library is called": (r"CDLL\(None", "system/linux.py"),
    "a process of a run is begun": (r"os\.execvpe?\(", "run/processes/fork_server_main.py"),
    "a page between processes is sealed": (r"F_ADD_SEALS", "run/observe/account.py"),
    "a simulator and the grader speak": (r"\{\"say\": what", "run/simulator/process.py"),
    "frames of ours are hidden": (r"TracebackType\(", "run/lockstep/faults.py"),
    "endpoints are paired": (r"def compatible\(", "run/lockstep/matching.py"),
    "a page's templates are found": (r"jinja2\.Environment\(", "reports/page/templating.py"),
    "a zip is written": (r"ZipFile\([^)]*\"w\"", ""),
    "a run's limits are set": (r"class (RunLimits|Patience|CpuBudget)\b", "run/limits.py"),
}
#: The same below grader/run/ and in grader/submission/, but for what is confined there.
ONE_IN_RUNS = {
    "a program is started": (r"subprocess\.(Popen|run)\(", "run/processes/fork_server.py"),
    "a folder is copied": (r"shutil\.copy|copytree\(", ""),
}


def found(pattern: str, *globs: str) -> set[str]:
    """The modules of grader/ that have such a text."""
    grader = ROOT / "grader"
    return {
        path.relative_to(grader).as_posix()
        for glob in globs
        for path in grader.glob(glob)
        if re.search(pattern, path.read_text(encoding="utf-8"))
    }


@pytest.mark.parametrize("what", ONE | ONE_IN_RUNS)
def test_there_is_one(what):
    pattern, where = (ONE | ONE_IN_RUNS)[what]
    globs = ("run/**/*.py", "submission/*.py") if what in ONE_IN_RUNS else ("**/*.py",)
    assert found(pattern, *globs) == ({where} if where else set())
