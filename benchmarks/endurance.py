"""Does the grader hold out? Many gradings, and kill -9 at random moments; prints what it came to.

    .venv/bin/python benchmarks/endurance.py [--gradings N] [--seed N] [--kills SHARE]

One grader process (`grader.grade`, as a course's service would call it) grades right, wrong and
hostile fixtures in an order that the seed decides. Now and then the grader itself, a simulator or a
zygote is killed in the middle of it. A grading that went down with its grader is done again; any
other must have the verdict that it had in the beginning, when nothing was killed. After each are
counted: memory and descriptors of the grader, its processes, the files below its temporary folder,
shared memory. Exit code 1 if a verdict was another one, if something was left behind, or if a
figure grew.
"""

from __future__ import annotations

import argparse
import json
import os
import random
import signal
import statistics
import subprocess
import sys
import tempfile
import threading
import time
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
SUBMISSIONS = ROOT / "tests" / "submissions"
FIXTURES = [
    ROOT / "turtlesim_challenge" / "turtle_controller.py",
    *(SUBMISSIONS / f"{name}.py" for name in (
        "quick_spiral", "square_controller", "styles/timer", "styles/multi_threaded",
        "services/all_services", "messages/many_calls", "misbehaving/raises_in_callback",
        "misbehaving/exits", "misbehaving/kills_itself", "misbehaving/never_spins",
        "misbehaving/attacks_link", "misbehaving/prints_a_million",
        "hostile_rubric/dead_reckoning", "hostile_rubric/pirouettes", "hostile_rubric/one_command",
        "hostile_rubric/pen_up",
    )),
]  # fmt: skip
VICTIMS = ("grader", "simulator", "zygote")
#: A grading takes about so long [s]: somebody is killed within it.
MOMENTS_S = (0.0, 2.0)
#: So long may it take until nothing is left of a killed grader [s].
GONE_S = 20.0
#: By so much may a figure grow from the first quarter of the gradings to the last: a share, and
#: what chance alone makes.
GROWTH = {
    "memory of the grader [MB]": (0.2, 20.0),
    "its descriptors": (0.0, 3.0),
    "its threads": (0.0, 1.0),
    "its processes": (0.0, 1.0),
    "temporary files": (0.0, 3.0),
    "shared memory": (0.0, 10.0),
}
#: What the grader process runs: a path in, the scores out.
SERVE = """
import json, sys
sys.path.insert(0, sys.argv[1])
import grader
for line in sys.stdin:
    try:
        verdicts = grader.grade(line.rstrip("\\n")).verdicts
        answer = {verdict.check: [verdict.status, verdict.score] for verdict in verdicts}
    except grader.GraderError as error:
        answer = {"error": [type(error).__name__, error.message]}
    print(json.dumps(answer), flush=True)
"""


@dataclass(frozen=True)
class Process:
    """A process as /proc tells of it; pid and start time together are never used twice."""

    pid: int
    parent: int
    started: str
    words: str


def processes() -> dict[int, Process]:
    """All that there are and that are not dead."""
    found = {}
    for folder in Path("/proc").iterdir():
        if not folder.name.isdigit():
            continue
        try:
            stat = (folder / "stat").read_text().rpartition(")")[2].split()
            words = (
                (folder / "cmdline").read_bytes().replace(b"\0", b" ").decode("utf-8", "replace")
            )
        except OSError:
            continue
        if stat[0] not in "ZX":
            pid = int(folder.name)
            found[pid] = Process(pid, int(stat[1]), stat[19], words)
    return found


def below(pid: int) -> list[Process]:
    """The descendants of a process, the nearest first."""
    everyone = processes()
    found: list[Process] = []
    generation = {pid}
    while generation:
        children = [p for p in everyone.values() if p.parent in generation]
        found += children
        generation = {child.pid for child in children}
    return found


class Grader:
    """The process that grades; started anew when it was killed."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._process: subprocess.Popen[str] | None = None

    @property
    def pid(self) -> int:
        """Its own."""
        if self._process is None:
            env = {**os.environ, "TMPDIR": str(self._folder)}
            self._process = subprocess.Popen(
                [sys.executable, "-c", SERVE, str(ROOT)],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL,
                text=True,
                env=env,
            )
        return self._process.pid

    def grade(self, path: Path) -> Any:
        """What it says of a submission; None if it died of it."""
        assert self.pid and self._process and self._process.stdin and self._process.stdout
        try:
            self._process.stdin.write(f"{path}\n")
            self._process.stdin.flush()
        except BrokenPipeError:
            pass
        answer = self._process.stdout.readline()
        if answer:
            return json.loads(answer)
        self._process.wait()
        self._process.stdin.close()
        self._process.stdout.close()
        self._process = None
        return None

    def figures(self) -> dict[str, float]:
        """What it has at the moment; nothing is being graded."""
        status = Path(f"/proc/{self.pid}/status").read_text()
        words = dict(line.split(":\t", 1) for line in status.splitlines() if ":\t" in line)
        return {
            "memory of the grader [MB]": int(words["VmRSS"].split()[0]) / 1024,
            "its descriptors": len(list(Path(f"/proc/{self.pid}/fd").iterdir())),
            "its threads": int(words["Threads"]),
            "its processes": len(below(self.pid)),
            "temporary files": sum(1 for _ in self._folder.rglob("*")),
            "shared memory": sum(1 for _ in Path("/dev/shm").iterdir()),
        }

    def end(self) -> None:
        """Let it go."""
        if self._process is not None:
            self._process.kill()
            self._process.wait()


class Killer:
    """Kills a process of a grader at a moment to come.

    Attributes:
        seen: the grader's descendants at that moment.
        hit: what was killed; '' if nothing of the kind was there.
    """

    def __init__(self, grader_pid: int, victim: str, delay_s: float, chance: random.Random) -> None:
        self.seen: list[Process] = []
        self.hit = ""
        self._pid, self._victim, self._chance = grader_pid, victim, chance
        self._timer = threading.Timer(delay_s, self._strike)
        self._timer.start()

    def join(self) -> None:
        """Do it now or never."""
        self._timer.cancel()
        self._timer.join()

    def _strike(self) -> None:
        self.seen = below(self._pid)
        pids = [self._pid]
        if self._victim != "grader":
            zygotes = [p.pid for p in self.seen if p.parent == self._pid and _is_zygote(p)]
            simulators = [p.pid for p in self.seen if p.pid not in zygotes and _is_simulator(p)]
            pids = zygotes if self._victim == "zygote" else simulators
        if pids:
            self.hit = self._victim
            try:
                os.kill(self._chance.choice(pids), signal.SIGKILL)
            except ProcessLookupError:
                self.hit = ""


def _is_zygote(process: Process) -> bool:
    # and no submission's supervisor: a run whose supervisor somebody kills was killed
    return "virtual_main" in process.words and " --zygote " in process.words


def _is_simulator(process: Process) -> bool:
    return "simulator.virtual_main" in process.words


def left_of(seen: list[Process]) -> list[Process]:
    """Those that do not go, long after their grader was killed."""
    deadline = time.monotonic() + GONE_S
    while True:
        now = processes()
        left = [p for p in seen if p.pid in now and now[p.pid].started == p.started]
        if not left or time.monotonic() > deadline:
            return left
        time.sleep(0.05)


def endure(gradings: int, seed: int, kills: float, folder: Path) -> list[str]:
    """Grade and kill; what was not as it should be."""
    chance = random.Random(seed)
    grader = Grader(folder)
    expected: dict[Path, Any] = {path: grader.grade(path) for path in FIXTURES}
    samples = [grader.figures()]
    struck: Counter[str] = Counter()
    wrong: list[str] = []
    for number in range(gradings):
        path = chance.choice(FIXTURES)
        killer = None
        if chance.random() < kills:
            delay_s = chance.uniform(*MOMENTS_S)
            killer = Killer(grader.pid, chance.choice(VICTIMS), delay_s, chance)
        found = grader.grade(path)
        if killer:
            killer.join()
            struck[killer.hit or "nobody was there any more"] += 1
        if found is None and killer and killer.hit == "grader":
            left = left_of(killer.seen)
            wrong += [f"{number}: left of a killed grader: {p.pid} {p.words:.80}" for p in left]
            found = grader.grade(path)
        if found != expected[path]:
            by = f", {killer.hit} killed" if killer and killer.hit else ""
            wrong.append(f"{number}: {path.name}{by}: {found}, expected {expected[path]}")
        samples.append(grader.figures())
        if (number + 1) % 50 == 0:
            print(f"{number + 1} of {gradings} gradings, {len(wrong)} deviations", flush=True)
    grader.end()
    print(f"\nKilled: {dict(struck)}\n")
    return wrong + list(grown(samples))


def grown(samples: list[dict[str, float]]) -> list[str]:
    """Print every figure; those that have grown."""
    found = []
    quarter = max(1, len(samples) // 4)
    print("| figure | first | median | last | max |\n|---|--:|--:|--:|--:|")
    for name, (share, chance) in GROWTH.items():
        values = [sample[name] for sample in samples]
        middle = statistics.median(values)
        print(f"| {name} | {values[0]:.0f} | {middle:.0f} | {values[-1]:.0f} | {max(values):.0f} |")
        before, after = (statistics.median(v) for v in (values[:quarter], values[-quarter:]))
        if after > before * (1 + share) + chance:
            found.append(f"{name} has grown from {before:.0f} to {after:.0f}")
    return found


def main() -> int:
    """Do it; 1 if anything was not as it should be."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--gradings", type=int, default=500)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--kills", type=float, default=0.3, help="in so many of the gradings")
    args = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="endurance-") as folder:
        wrong = endure(args.gradings, args.seed, args.kills, Path(folder))
    for line in wrong:
        print(line)
    print("All was as it should be." if not wrong else f"{len(wrong)} deviations.")
    return int(bool(wrong))


if __name__ == "__main__":
    sys.exit(main())
