"""Is a class that was interrupted the same as one that was not? `grader batch`, and kill -9.

    .venv/bin/python benchmarks/interrupt_class.py [--count N] [--kills N] [--seed N] [--jobs N]

A class made of the fixtures is graded without disturbance; then again into another folder, where
all processes of `grader batch` are killed at random moments and the same call goes on. Prints how
long both took, and compares gradebook and pages byte by byte. Exit code 1 if anything differs.
"""

from __future__ import annotations

import argparse
import hashlib
import random
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

import psutil
from measuring import machine

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from grader.batch.entry import entries  # noqa: E402

#: What differs between two gradings of the same: when, and how long it took.
CHANCE = ("submissions", "store")


def start(submissions: Path, out: Path, jobs: int) -> subprocess.Popen[bytes]:
    """Start `grader batch`."""
    command = [sys.executable, "-m", "grader", "batch", str(submissions), "--out", str(out)]
    return subprocess.Popen(
        [*command, "--jobs", str(jobs)],
        cwd=ROOT,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )


def graded(out: Path) -> int:
    """How many hand-ins are in their place."""
    return sum(1 for _ in (out / "submissions").glob("*/entry.json"))


def digests(out: Path) -> dict[str, str]:
    """What is made of all entries together, by name."""
    paths = (path for path in out.rglob("*") if path.is_file())
    names = {path.relative_to(out): path for path in paths}
    return {
        str(name): hashlib.sha256(path.read_bytes()).hexdigest()
        for name, path in sorted(names.items())
        if name.parts[0] not in CHANCE
    }


def interrupted(submissions: Path, out: Path, jobs: int, at: list[float]) -> None:
    """Grade, and kill when each of these shares of a minute has passed since the last start."""
    for after_s in at:
        process = start(submissions, out, jobs)
        try:
            process.wait(after_s)
        except subprocess.TimeoutExpired:
            victims = (
                [process.pid]
                if random.random() < 0.5
                else [
                    *(child.pid for child in psutil.Process(process.pid).children(recursive=True)),
                    process.pid,
                ]
            )
            for pid in victims:
                try:
                    psutil.Process(pid).kill()
                except psutil.NoSuchProcess:
                    continue
        process.wait()
        print(f"killed after {after_s:.1f} s: {graded(out)} are graded", flush=True)
    start(submissions, out, jobs).wait()


def main() -> int:
    """Grade twice, and compare."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--count", type=int, default=300)
    parser.add_argument("--kills", type=int, default=10)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=2)
    args = parser.parse_args()
    print(machine())
    random.seed(args.seed)
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        make = [sys.executable, str(ROOT / "scripts" / "make_class.py"), str(folder / "class")]
        subprocess.run([*make, "--count", str(args.count), "--seed", str(args.seed)], check=True)
        began = time.monotonic()
        start(folder / "class", folder / "whole", args.jobs).wait()
        whole_s = time.monotonic() - began
        print(f"undisturbed: {whole_s:.0f} s, {args.count / whole_s * 60:.0f} a minute", flush=True)
        at = [random.uniform(0, 2 * whole_s / (args.kills + 1)) for _ in range(args.kills)]
        began = time.monotonic()
        interrupted(folder / "class", folder / "cut", args.jobs, at)
        print(f"with {args.kills} kills: {time.monotonic() - began:.0f} s")
        states = Counter(entry.state for entry in entries(folder / "whole"))
        print(", ".join(f"{number} {state}" for state, number in sorted(states.items())))
        one, other = digests(folder / "whole"), digests(folder / "cut")
        different = [name for name in one.keys() | other.keys() if one.get(name) != other.get(name)]
        print(f"{len(one)} files compared; {len(different)} differ: {' '.join(sorted(different))}")
    return 1 if different or not one or states["failed"] else 0


if __name__ == "__main__":
    sys.exit(main())
