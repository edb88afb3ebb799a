"""Grade under load, and compare every hash with those of quiet gradings: load decides nothing.

    python scripts/same_hashes.py [--gradings 200] [--at-once 4] [--busy 16] [--seed N]
    python scripts/same_hashes.py --only reference --gradings 200 --at-once 1 --busy 1
    python scripts/same_hashes.py --write-baseline FILE    and later, or elsewhere: --baseline FILE

Fixture submissions are drawn by chance, and each is graded with all its runs by the command line,
while as many processes as `--busy` says do nothing but use a processor. Compared are the hash of
every run's trace, how and by which clock it went, and the score; the first gradings, without load
and one after the other, tell what they should be. What ran in real time there is not drawn. Ends
with 1 where anything differs.
"""

from __future__ import annotations

import argparse
import json
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from snapshot import ROOT, lay_out

#: What is compared: of the result, and of each of its runs.
Facts = dict[str, Any]
OF_A_RUN = ("time", "outcome", "exit_code", "ticks", "flags", "trace_sha256")
#: Ends by itself where whoever started it has gone, however that ended.
BUSY = "import os, sys\nwhile os.getppid() == int(sys.argv[1]):\n    for _ in range(100_000): pass"


def facts_of(grader: str, path: Path, exercise: str) -> Facts:
    """Grade once; what must be the same each time."""
    with tempfile.TemporaryDirectory(prefix="same-hashes-") as folder:
        command = [grader, "run", str(path), "--exercise", exercise, "--out", folder]
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
        if done.returncode:
            return {"failed": done.returncode, "says": done.stderr[-300:]}
        result = json.loads((Path(folder) / "result.json").read_text(encoding="utf-8"))
    runs = [result["run"], *result.get("varied_runs", [])]
    return {
        "score": result["score"],
        "runs": [{key: run.get(key) for key in OF_A_RUN} for run in runs],
    }


def is_comparable(facts: Facts) -> bool:
    """Whether it was graded, and every run went in virtual time."""
    return "runs" in facts and all(run["time"] == "virtual" for run in facts["runs"])


def differences(expected: Facts, found: Facts) -> list[str]:
    """What differs, in words."""
    if "runs" not in found:
        return [f"exit {found['failed']}: {found['says'].strip()}"]
    faults = []
    if found["score"] != expected["score"]:
        faults.append(f"score {expected['score']} -> {found['score']}")
    if len(found["runs"]) != len(expected["runs"]):
        faults.append(f"{len(expected['runs'])} runs -> {len(found['runs'])}")
    for number, (one, other) in enumerate(zip(expected["runs"], found["runs"], strict=False)):
        faults += [
            f"run {number}: {key} {one[key]!r} -> {other[key]!r}"
            for key in OF_A_RUN
            if one[key] != other[key]
        ]
    return faults


@contextmanager
def busy(count: int) -> Iterator[None]:
    """So many processes that use all the processor they get."""
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


def baseline_of(grader: str, cases: dict[str, tuple[Path, str]]) -> dict[str, Facts]:
    """Grade each once, one after the other."""
    found = {}
    for name, case in cases.items():
        found[name] = facts_of(grader, *case)
        print(f"quiet: {name}{'' if is_comparable(found[name]) else ' (not compared)'}", flush=True)
    return found


def compare(
    grader: str,
    drawn: Sequence[str],
    cases: dict[str, tuple[Path, str]],
    baseline: dict[str, Facts],
    at_once: int,
) -> int:
    """Grade what was drawn, and print what differs; the number of gradings that do."""
    different = runs = 0
    load = 0.0
    pool = ThreadPoolExecutor(at_once)
    try:
        jobs = {pool.submit(facts_of, grader, *cases[name]): name for name in drawn}
        for done, job in enumerate(as_completed(jobs), 1):
            name, found = jobs[job], job.result()
            faults = differences(baseline[name], found)
            different += bool(faults)
            runs += len(found.get("runs", ()))
            load = max(load, os.getloadavg()[0])
            for fault in faults:
                print(f"{name}: {fault}", flush=True)
            if done % 10 == 0:
                print(f"{done} of {len(drawn)} gradings, {different} differ", flush=True)
    finally:
        pool.shutdown(cancel_futures=True)
    print(
        f"{len(drawn)} gradings ({runs} runs) of {len(set(drawn))} submissions, {at_once} at once, "
        f"at a load of up to {load:.1f}: {different} differ"
    )
    return different


def main() -> int:
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--gradings", type=int, default=200, help="under load: %(default)s")
    parser.add_argument("--at-once", type=int, default=4, help="%(default)s")
    parser.add_argument("--busy", type=int, default=16, help="busy processes: %(default)s")
    parser.add_argument("--seed", type=int, help="of what is drawn; printed")
    parser.add_argument("--only", nargs="+", metavar="NAME", help="draw from these fixtures")
    parser.add_argument("--baseline", type=Path, metavar="FILE", help="quiet gradings, as written")
    parser.add_argument("--write-baseline", type=Path, metavar="FILE", help="... and nothing else")
    parser.add_argument("--grader", default=str(ROOT / ".venv" / "bin" / "grader"))
    args = parser.parse_args()
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))  # no busy process is left behind

    cases = lay_out()
    names = {"reference": "mutant-reference"}
    asked = [names.get(name, name) for name in args.only] if args.only else sorted(cases)
    if unknown := [name for name in asked if name not in cases]:
        parser.error(f"no fixture is named {', '.join(unknown)}")
    if args.baseline:
        baseline = json.loads(args.baseline.read_text(encoding="utf-8"))
    else:
        baseline = baseline_of(args.grader, {name: cases[name] for name in asked})
    if args.write_baseline:
        text = json.dumps(baseline, indent=1, ensure_ascii=False)
        args.write_baseline.write_text(text + "\n", encoding="utf-8")
        return 0
    possible = [name for name in asked if is_comparable(baseline.get(name, {}))]
    if not possible:
        parser.error("nothing of that was graded in virtual time")
    seed = time.time_ns() % 2**32 if args.seed is None else args.seed
    print(f"seed {seed}; drawn from {len(possible)} submissions", flush=True)
    drawn = random.Random(seed).choices(possible, k=args.gradings)
    with busy(args.busy):
        return int(compare(args.grader, drawn, cases, baseline, args.at_once) > 0)


if __name__ == "__main__":
    sys.exit(main())
