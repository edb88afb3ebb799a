"""Grade all fixture submissions with a checkout's grader, and compare such snapshots.

    python scripts/snapshot.py take DIR [--grader PATH/TO/grader] [--jobs N] [--only NAME...]
    python scripts/snapshot.py compare BEFORE AFTER
    python scripts/snapshot.py repeat DIR [--gradings 200] [--at-once 4] [--busy 16] [--seed N]

To check that a change leaves behaviour as it is, take a snapshot before and one after it. `take`
uses only the command line, so it works for any two versions of the grader. `compare` compares,
byte for byte, the result, the recordings and every report format; what differs between equal runs
(wall time, dates and versions) is removed first, and pictures inside reports are compared by their
pixels. Runs in real time are compared by their outcome alone.

`repeat` shows that load has no influence: it grades random submissions of a snapshot again, while
`--busy` processes use all the processor they get. It compares the score, the hash of every run's
trace, its outcome and its clock. Runs in real time are not drawn. Both end with 1 if anything
differs.
"""

from __future__ import annotations

import argparse
import base64
import hashlib
import io
import json
import os
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor, as_completed
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from PIL import Image

ROOT = Path(__file__).resolve().parents[1]
#: Always the same path: tracebacks in a submission's output contain it.
FIXTURES = Path("/tmp/turtlesim-snapshot-fixtures")
FORMATS = (
    *("html", "markdown", "csv", "junit", "gradescope", "prairielearn", "autolab"),
    *("moodle-vpl", "github-autograding", "terminal"),
)
#: Files beside the fixtures that are none.
HELPERS = ("beginners.py", "mutants.py", "packages.py")
#: The file of a recording that differs between equal runs.
CIRCUMSTANCES = "circumstances.json"
#: The fields of a repeated run that are compared.
OF_A_RUN = ("time", "outcome", "exit_code", "ticks", "flags", "trace_sha256")
#: Ends by itself when its parent has ended, however that happened.
BUSY = "import os, sys\nwhile os.getppid() == int(sys.argv[1]):\n    for _ in range(100_000): pass"


def lay_out() -> dict[str, tuple[Path, str]]:
    """Copy the fixtures; name -> path and exercise."""
    sys.path.insert(0, str(ROOT))
    from tests.submissions.beginners import CHANGED, changed
    from tests.submissions.mutants import MUTANTS, REFERENCE

    shutil.rmtree(FIXTURES, ignore_errors=True)
    shutil.copytree(ROOT / "tests" / "submissions", FIXTURES)
    for name in CHANGED:
        (FIXTURES / "first_lines" / f"{name}.py").write_text(changed(name), encoding="utf-8")
    found: dict[str, tuple[Path, str]] = {}
    for path in sorted(FIXTURES.rglob("*.py")):
        if path.relative_to(FIXTURES).as_posix() not in HELPERS:
            is_square = path.stem.startswith("square")
            found[path.stem] = (path, "square" if is_square else "turtlesim_challenge")
    for name, text in {
        "reference": REFERENCE.read_text(encoding="utf-8"),
        **{name: mutant.text() for name, mutant in MUTANTS.items()},
    }.items():
        path = FIXTURES / "mutants" / name / "turtle_controller.py"
        path.parent.mkdir(parents=True)
        path.write_text(text, encoding="utf-8")
        found[f"mutant-{name}"] = (path, "turtlesim_challenge")
    starter = FIXTURES / "starter"
    shutil.copytree(ROOT / "turtlesim_challenge" / "starter", starter)
    return {**found, "starter": (starter, "turtlesim_challenge")}


def record(grader: str, folder: Path, jobs: int, only: list[str]) -> None:
    """Grade everything into a new folder."""
    folder.mkdir(parents=True)
    fixtures = {name: case for name, case in lay_out().items() if not only or name in only}
    with ThreadPoolExecutor(jobs) as pool:
        for line in pool.map(lambda item: _grade(grader, folder, *item), fixtures.items()):
            print(line, flush=True)


def _run(grader: str, case: tuple[Path, str], out: Path) -> subprocess.CompletedProcess[str]:
    path, exercise = case
    command = [grader, "run", str(path), "--exercise", exercise, "--out", out.name]
    env = {**os.environ, "COLUMNS": "100"}
    return subprocess.run(command, cwd=out.parent, env=env, capture_output=True, text=True)


def _grade(grader: str, folder: Path, name: str, case: tuple[Path, str]) -> str:
    done = _run(grader, case, folder / name)
    if done.returncode:
        (folder / name).mkdir(exist_ok=True)
        (folder / name / "failed.txt").write_text(f"{done.returncode}\n{done.stderr}")
        return f"{name}: exit {done.returncode}"
    file = folder / name / "result.json"
    result = json.loads(file.read_text(encoding="utf-8"))
    for run in _runs(result):
        run["wall_s"] = 1.0
    result.pop("provenance", None)
    file.write_text(json.dumps(result, indent=2, ensure_ascii=False) + "\n", encoding="utf-8")
    env = {**os.environ, "COLUMNS": "100"}
    for form in FORMATS:
        command = [grader, "report", f"{name}/result.json", "--format", form]
        report = subprocess.run(command, cwd=folder, env=env, capture_output=True)
        (folder / name / f"report.{form}").write_bytes(report.stdout or report.stderr)
    hashes = " ".join(run["trace_sha256"][:8] for run in _runs(result))
    return f"{name}: {result['score']} {result['run']['time']} {hashes}"


def _runs(result: dict[str, Any]) -> list[dict[str, Any]]:
    return [result["run"], *result.get("varied_runs", [])]


def compare(before: Path, after: Path) -> int:
    """Print what differs; return the number of submissions that do."""
    names = sorted({path.name for folder in (before, after) for path in folder.iterdir()})
    different = traces = files = 0
    for name in names:
        faults, counted = _differences(before / name, after / name)
        files += counted
        if (before / name / "result.json").exists():
            result = json.loads((before / name / "result.json").read_text(encoding="utf-8"))
            traces += len(_runs(result))
        different += bool(faults)
        for fault in faults:
            print(f"{name}: {fault}")
    print(f"{len(names)} submissions, {traces} runs, {files} files compared; {different} differ")
    return different


def _differences(before: Path, after: Path) -> tuple[list[str], int]:
    if not before.is_dir() or not after.is_dir():
        return [f"only in {before.parent if before.is_dir() else after.parent}"], 0
    both = [_result(folder) for folder in (before, after)]
    if any(run["time"] == "real" for result in both if result for run in _runs(result)):
        seen = [
            [(run["time"], run["outcome"], run["flags"]) for run in _runs(result)]
            for result in both
            if result
        ]
        return ([] if seen[0] == seen[-1] and len(seen) == 2 else [f"{seen}"]), 0
    names = sorted(
        {
            path.relative_to(folder)
            for folder in (before, after)
            for path in folder.rglob("*")
            if path.is_file() and path.name != CIRCUMSTANCES
        }
    )
    faults = []
    for name in names:
        ours, theirs = before / name, after / name
        if not ours.exists() or not theirs.exists():
            faults.append(f"{name} is only {'after' if theirs.exists() else 'before'}")
        elif _timeless(ours) != _timeless(theirs):
            faults.append(f"{name} differs")
    return faults, len(names)


def _timeless(path: Path) -> bytes:
    """Return a file's bytes without the times of rclpy's logger, and without rclpy's path.

    A picture inside is replaced by a hash of its pixels: another encoder makes other bytes.
    """
    data = re.sub(rb"\[\d{10}\.\d{9}\]", b"[time]", path.read_bytes())
    data = re.sub(rb"/[^\s\"&]*/site-packages/", b"[site]/", data)
    return re.sub(rb"data:image/png;base64,([A-Za-z0-9+/=]+)", _pixels, data)


def _pixels(found: re.Match[bytes]) -> bytes:
    with Image.open(io.BytesIO(base64.b64decode(found[1]))) as image:
        shown = image.convert("RGBA")
    return f"[{shown.size} {hashlib.sha256(shown.tobytes()).hexdigest()}]".encode()


def _result(folder: Path) -> dict[str, Any] | None:
    file = folder / "result.json"
    return json.loads(file.read_text(encoding="utf-8")) if file.exists() else None


@contextmanager
def _busy(count: int) -> Iterator[None]:
    """Run so many processes that use all the processor they get."""
    made: list[subprocess.Popen[bytes]] = []
    try:
        for _ in range(count):
            made.append(subprocess.Popen([sys.executable, "-c", BUSY, str(os.getpid())]))
        yield
    finally:
        for process in made:
            process.kill()
        for process in made:
            process.wait()


def _again(grader: str, case: tuple[Path, str], expected: dict[str, Any]) -> list[str]:
    """Grade once more; return what differs from the expected result."""
    with tempfile.TemporaryDirectory(prefix="snapshot-") as folder:
        done = _run(grader, case, Path(folder) / "out")
        found = _result(Path(folder) / "out")
    if done.returncode or found is None:
        return [f"exit {done.returncode}: {done.stderr[-300:].strip()}"]
    if len(_runs(found)) != len(_runs(expected)):
        return [f"{len(_runs(expected))} runs -> {len(_runs(found))}"]
    pairs = [("score", expected["score"], found["score"])]
    for number, (one, other) in enumerate(zip(_runs(expected), _runs(found), strict=True)):
        pairs += [(f"run {number}: {key}", one.get(key), other.get(key)) for key in OF_A_RUN]
    return [f"{what} {one!r} -> {other!r}" for what, one, other in pairs if one != other]


def repeat(grader: str, folder: Path, drawn: int, at_once: int, busy: int, seed: int) -> int:
    """Grade random submissions under load, and print what differs; return how many do."""
    cases, expected = lay_out(), {path.name: _result(path) for path in folder.iterdir()}
    possible = {
        name: result
        for name, result in sorted(expected.items())
        if result and all(run["time"] == "virtual" for run in _runs(result))
    }
    if not possible:
        raise SystemExit(f"{folder} holds nothing that was graded in virtual time")
    print(f"seed {seed}; drawn from {len(possible)} submissions", flush=True)
    names = random.Random(seed).choices(list(possible), k=drawn)
    different, load = 0, 0.0
    with _busy(busy), ThreadPoolExecutor(at_once) as pool:
        jobs = {pool.submit(_again, grader, cases[name], possible[name]): name for name in names}
        for number, job in enumerate(as_completed(jobs), 1):
            different += bool(job.result())
            load = max(load, os.getloadavg()[0])
            for fault in job.result():
                print(f"{jobs[job]}: {fault}", flush=True)
            if number % 10 == 0:
                print(f"{number} of {drawn} gradings, {different} differ", flush=True)
    print(
        f"{drawn} gradings of {len(set(names))} submissions, {at_once} at once, "
        f"at a load of up to {load:.1f}: {different} differ"
    )
    return different


def main() -> int:
    """Run a verb; 1 if something differs."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    verbs = parser.add_subparsers(dest="verb", required=True)
    taking, comparing = verbs.add_parser("take"), verbs.add_parser("compare")
    repeating = verbs.add_parser("repeat")
    taking.add_argument("folder", type=Path)
    taking.add_argument("--jobs", type=int, default=2)
    taking.add_argument("--only", nargs="*", default=[], metavar="NAME")
    comparing.add_argument("before", type=Path)
    comparing.add_argument("after", type=Path)
    repeating.add_argument("folder", type=Path)
    repeating.add_argument("--gradings", type=int, default=200, help="under load: %(default)s")
    repeating.add_argument("--at-once", type=int, default=4, help="%(default)s")
    repeating.add_argument("--busy", type=int, default=16, help="busy processes: %(default)s")
    repeating.add_argument("--seed", type=int, help="of what is drawn; printed")
    for each in (taking, repeating):
        each.add_argument("--grader", default=str(ROOT / ".venv" / "bin" / "grader"))
    args = parser.parse_args()
    if args.verb == "take":
        record(args.grader, args.folder, args.jobs, args.only)
        return 0
    if args.verb == "compare":
        return int(compare(args.before, args.after) > 0)
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))  # no busy process is left behind
    seed = time.time_ns() % 2**32 if args.seed is None else args.seed
    load = (args.gradings, args.at_once, args.busy, seed)
    return int(repeat(args.grader, args.folder, *load) > 0)


if __name__ == "__main__":
    sys.exit(main())
