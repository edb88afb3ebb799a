"""Measure a large course: what `grader batch` costs beside the runs, for ever more hand-ins.

    .venv/bin/python benchmarks/large_course.py [--count 200 2000 20000] [--folder DIR] [--quick]

Some dozens of programs are really graded once. Each hand-in has the text of one of them and a last
line of its own. Where it would be run, judged and shown on its page, what came of that program is
used again. All else is real: the pool with two processes, the scheduler with two workers, the
store, the class page, groups, exports and a regrade. Half of the hand-ins behave as the recording
does; the other half have commands and a path of their own, as if each had been written by somebody
else, which is the hardest case for the groups. One in fifty is the same as another.

The pool grades the first half and is killed; the cluster goes on. With --quick each of both grades
`FEW` at most, and those between are graded in one process that does not wait for the disk. Memory
is that of the call itself, without the processes that grade. There are no varied runs, so that a
course of 20,000 needs 10 GB of disk; with three of them it would be 26 GB.
"""

from __future__ import annotations

import argparse
import hashlib
import importlib
import json
import os
import random
import re
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from contextlib import ExitStack, suppress
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Self

import psutil
from measuring import ROOT, Cost, group, head, machine, row

from grader import judging, reports, strict_json
from grader.batch import grade, pool
from grader.batch.entry import SUBMISSIONS, Entry, entries
from grader.batch.gradebook.write import write as write_gradebook
from grader.batch.page import html
from grader.batch.page.html import PAGE
from grader.batch.pool import Task
from grader.batch.regrade.judging import CHANGES_PAGE
from grader.batch.similar import features, page, sources
from grader.batch.similar.features import Features, HashedFile, TimedCommand
from grader.batch.store import RUN, Store
from grader.cli import regrading
from grader.exercise.exercise import Exercise
from grader.exercise.loading import load_exercise
from grader.message import Message
from grader.recording.recording import Recordings
from grader.reports import Report
from grader.result.result import Result

NAME = "turtle_controller.py"
RUBRIC = "exercise: turtlesim_challenge\nvaried_runs: {count: 0}\n"
CHANGED = "points: {moves: 11}\n"
#: The last line of a hand-in: its number, and the run in the store that stands for its own.
MARK = re.compile(r"# hand-in (\d+), run (\w+)\n\Z")
#: Where these runs are, for the processes that this one starts.
PLACE = "LARGE_COURSE_RUNS"
#: One hand-in in so many is that of another one.
COPIED = 50
#: How many the pool grades, and the cluster, with --quick.
FEW = 200
PYTHON = (sys.executable, "-P")
ME = (*PYTHON, __file__)
MIB = 2**20

# In the place of runs ---------------------------------------------------------------------------


def as_if_run(task: Task, exercise: Exercise) -> Recordings | Message:
    """Fill a task's folder with another run; in the place of `grader.batch.grade._run`."""
    assert task.path is not None
    text = next(task.path.glob("*.py")) if task.path.is_dir() else task.path
    data = text.read_bytes()
    found = MARK.search(data.decode())
    assert found is not None
    place = task.into / RUN
    shutil.copytree(_original(found[2]), place)
    if (known := Features.read(place)) is not None:
        (place / sources.SOURCE / NAME).write_bytes(data)
        behaviour = known if int(found[1]) % 2 else _varied(known, int(found[1]))
        own = replace(behaviour, files=(HashedFile(NAME, hashlib.sha256(data).hexdigest()),))
        (place / features.NAME).write_bytes(strict_json.line(own))
    return _known(found[2])


def as_if_loaded(task: Task) -> Recordings | Message | None:
    """Return the recordings of a stored run; in the place of `grader.batch.grade._loaded`."""
    if task.run is None:
        return None
    source = task.run / sources.SOURCE / NAME
    found = MARK.search(source.read_text(encoding="utf-8")) if source.is_file() else None
    assert found is not None
    return _known(found[2])


def _original(key: str) -> Path:
    return Store(Path(os.environ[PLACE])).run(key)


_loaded = grade._loaded


@cache
def _known(key: str) -> Recordings | Message:
    run = _original(key)
    found = _loaded(Task(key, (), None, "", "", "virtual", None, run, run))
    assert found is not None
    return found


def _varied(behaviour: Features, number: int) -> Features:
    """Return what somebody else does: commands at other times, a longer or shorter path."""
    chance = random.Random(number)
    size = chance.uniform(0.5, 1.5)
    commands = (
        TimedCommand(each.time_ns + chance.randrange(1000), each.hash)
        for each in behaviour.commands
    )
    path = tuple(round(size * value) for value in behaviour.path)
    return replace(behaviour, commands=tuple(commands), path=path)


_judge, _render = judging.judge, reports.render
_judged: dict[tuple[int, str], Result] = {}
_rendered: dict[tuple[str, str], str] = {}


def _judge_once(recordings: Recordings, exercise: Exercise, *, submission: str) -> Result:
    key = id(recordings), exercise.sha256
    if key not in _judged:
        _judged[key] = _judge(recordings, exercise)
    return replace(_judged[key], submission=submission)


def _render_once(name: str, shown: Sequence[Report]) -> str:
    key = repr(shown[0].run), repr(shown[0].verdicts)
    if key not in _rendered:
        _rendered[key] = _render(name, shown)
    return _rendered[key]


# The processes ----------------------------------------------------------------------------------


def act(verb: str, words: list[str]) -> int:
    """Be one of the processes: as it is, but for the runs."""
    pool._COMMAND = ("-P", __file__, "serve")
    if verb == "serve":
        grade._run, grade._loaded = as_if_run, as_if_loaded
        judging.judge, grade.render = _judge_once, _render_once
        grade.serve(*words)
    elif verb == "worker":
        from distributed.cli.dask_worker import main as worker

        worker(words)
    elif verb == "quick":
        grade._run, grade._loaded = as_if_run, as_if_loaded
        judging.judge, grade.render = _judge_once, _render_once
        os.fsync = lambda _: None
        pool.work = lambda tasks, jobs: ((task, grade.done(task)) for task in tasks)
        return act("batch", words)
    elif verb == "outputs":
        outputs(*map(Path, words))
    else:
        from grader.cli import main as grader

        return grader([verb, *words])
    return 0


def outputs(out: Path, rubric: Path) -> None:
    """Print the cost of each part of what is made of all results together [s], as JSON."""
    exercise = load_exercise(str(rubric))
    found: list[Entry] = []
    costs: dict[str, float] = {}

    def timed(name: str, work: Callable[[], object]) -> None:
        begun = time.process_time()
        work()
        costs[name] = time.process_time() - begun

    timed("reading all results", lambda: found.extend(entries(out)))
    timed("groups", lambda: page.write(found, exercise, out))
    timed("class page", lambda: html.render_all(found, exercise))
    timed("gradebook and feedback", lambda: write_gradebook(out, found, exercise.title))
    timed("JPlag and Dolos", lambda: sources.write_exports(found, exercise, out))
    print(json.dumps(costs))


# Measuring --------------------------------------------------------------------------------------


def make_runs(folder: Path) -> None:
    """Grade some programs really, into the folder that `PLACE` names."""
    programs = importlib.import_module("class").programs()
    handed_in = folder / "programs"
    handed_in.mkdir()
    texts = sorted({text for each in programs.values() for text in each})
    for number, text in enumerate(texts[::2]):
        (handed_in / f"{number}.py").write_text(text, encoding="utf-8")
    rubric = folder / "rubric.yaml"
    rubric.write_text(RUBRIC, encoding="utf-8")
    words = ("batch", str(handed_in), "--out", os.environ[PLACE], "--exercise", str(rubric))
    subprocess.run([*PYTHON, "-m", "grader", *words], env=_env(), check=True)


def make_course(folder: Path, count: int, runs: Path) -> None:
    """Write a course as Moodle exports it; the same number makes the same course."""
    names = importlib.import_module("class")
    chance = random.Random(1)
    known = [each for each in entries(runs) if each.state == "judged"]
    texts: list[str] = []
    for number in range(count):
        name = f"{chance.choice(names.FIRST)} {chance.choice(names.LAST)}"
        at = folder / f"{name}_{100000 + number}_assignsubmission_file_" / NAME
        at.parent.mkdir(parents=True)
        if number % COPIED == COPIED - 1:
            texts.append(chance.choice(texts))
        else:
            entry = chance.choice(known)
            (source,) = (entry.folder / sources.SOURCE).glob("*.py")
            text = source.read_text(encoding="utf-8")
            texts.append(f"{text}\n# hand-in {number}, run {entry.key}\n")
        at.write_text(texts[-1], encoding="utf-8")


class Course:
    """A course that is measured.

    Attributes:
        figures: what was measured, by its name.
    """

    def __init__(self, folder: Path, count: int) -> None:
        self.count, self.figures = count, dict[str, float]()
        self._rubric, self._handed_in = folder.parent / "rubric.yaml", folder / "course"
        self.out = folder / "out"
        make_course(self._handed_in, count, Path(os.environ[PLACE]))

    def measure(self, most: int) -> None:
        """Grade, kill, resume, show, regrade; pool and cluster grade at most so many."""
        rubric = ("--exercise", str(self._rubric))
        grading = (str(self._handed_in), "--out", str(self.out), *rubric)
        half = self.count // 2
        self._call("pool", "batch", *grading, "--jobs", "2", kill_at=min(half, most))
        if self.count - half > most:
            self._call("between", "quick", *grading, kill_at=self.count - most)
        self._call("cluster", "batch", *grading, is_cluster=True)
        self.figures["on disk [MiB]"] = _disk_mib(self.out)
        self.figures["files and folders"] = sum(1 for _ in self.out.rglob("*"))
        self.figures["class page [MiB]"] = (self.out / PAGE).stat().st_size / MIB
        words = [*ME, "outputs", str(self.out), str(self._rubric)]
        printed = subprocess.run(words, env=_env(), check=True, stdout=subprocess.PIPE).stdout
        self.figures |= {f"{name}: CPU [s]": cpu_s for name, cpu_s in json.loads(printed).items()}
        self._call("resume, all done", "batch", *grading, "--jobs", "2")
        changed = self._rubric.with_name("changed.yaml")
        changed.write_text(RUBRIC + CHANGED, encoding="utf-8")
        again = ("batch", "--regrade", str(self.out), "--exercise", str(changed), "--apply")
        self._call("regrade", *again, "--jobs", "2")
        pages = self.out / regrading.REGRADE / CHANGES_PAGE
        self.figures["page of the regrade [MiB]"] = pages.stat().st_size / MIB

    def _call(self, name: str, *words: str, kill_at: int = 0, is_cluster: bool = False) -> None:
        """Make a call, to its end or until so many are graded."""
        with group() as measured, tempfile.TemporaryFile() as said, ExitStack() as stack:
            with measured.entered():
                cluster = stack.enter_context(_Cluster()) if is_cluster else None
                words = (*words, "--scheduler", cluster.address) if cluster else words
                process = subprocess.Popen([*ME, *words], env=_env(), stdout=said, stderr=said)
            before, own = self._graded(), Cost(0.0, 0.0, 0.0)
            seen = [(before, measured.now(), own)]
            while process.poll() is None:
                own = _own(process.pid, own)
                graded = self._graded()
                if graded > seen[-1][0]:
                    seen.append((graded, measured.now(), own))
                if kill_at and graded >= kill_at:
                    process.kill()
                time.sleep(0.2)
            whole = measured.since(seen[0][1])
            if process.returncode and not kill_at:
                said.seek(0)
                raise SystemExit(said.read().decode())
        self.figures[f"{name}: memory [MiB]"] = own.peak_mib or 0.0
        if len(seen) < 3:
            self.figures |= {f"{name}: {what} [s]": s for what, s in _both(whole).items()}
            return
        (_, start, _), (first, begun, own_begun), *_, (last, end, own_end) = seen
        costs = _both(_between(begun, end))
        costs["CPU of the call itself"] = _both(_between(own_begun, own_end))["CPU"]
        for what, s in costs.items():
            self.figures[f"{name}, for each [ms]: {what}"] = 1000 * s / (last - first)
        if before:
            self.figures[f"{name}: to the first new one [s]"] = begun.wall_s - start.wall_s
        if not kill_at:
            rest_s = start.wall_s + whole.wall_s - end.wall_s
            self.figures[f"{name}: after the last new one [s]"] = rest_s

    def _graded(self) -> int:
        there = self.out / SUBMISSIONS
        return sum(1 for _ in there.iterdir()) if there.is_dir() else 0


def _between(begun: Cost, end: Cost) -> Cost:
    return Cost(end.wall_s - begun.wall_s, (end.cpu_s or 0.0) - (begun.cpu_s or 0.0))


def _both(cost: Cost) -> dict[str, float]:
    return {"wall": cost.wall_s, "CPU": cost.cpu_s or 0.0}


class _Cluster:
    """A scheduler and two workers that grade one at a time."""

    def __enter__(self) -> Self:
        self._place = tempfile.TemporaryDirectory()
        file, quiet = Path(self._place.name, "scheduler.json"), "--no-dashboard"
        words = ("--host", "127.0.0.1", "--port", "0", "--scheduler-file", str(file), "--no-show")
        self.processes = [self._start("-m", "distributed.cli.dask_scheduler", *words, quiet)]
        while not file.exists() or not file.read_text(encoding="utf-8").endswith("}"):
            time.sleep(0.1)
        self.address = str(json.loads(file.read_text(encoding="utf-8"))["address"])
        words = ("worker", self.address, "--nthreads", "1", "--no-nanny", quiet)
        where = ("--local-directory", self._place.name)
        self.processes += [self._start(__file__, *words, *where) for _ in range(2)]
        return self

    def __exit__(self, *_: object) -> None:
        for process in reversed(self.processes):
            process.terminate()
            process.wait()
        self._place.cleanup()

    def _start(self, *words: str) -> subprocess.Popen[bytes]:
        quiet = subprocess.DEVNULL
        return subprocess.Popen([*PYTHON, *words], env=_env(), stdout=quiet, stderr=quiet)


def _env() -> dict[str, str]:
    path = os.pathsep.join((str(ROOT), str(Path(__file__).parent)))
    return {**os.environ, "PYTHONPATH": path}


def _own(process: int, before: Cost) -> Cost:
    """Return the processor time of one process, and its peak of memory."""
    with suppress(psutil.Error):
        found = psutil.Process(process)
        cpu, peak_mib = found.cpu_times(), found.memory_info().rss / MIB
        return Cost(0.0, cpu.user + cpu.system, max(peak_mib, before.peak_mib or 0.0))
    return before


def _disk_mib(folder: Path) -> float:
    """Return what a folder takes on the disk; what has several names counts once."""
    return int(subprocess.check_output(["du", "-s", "-k", str(folder)]).split()[0]) / 1024


def show(courses: Sequence[Course]) -> None:
    """Print each figure, and how much faster than the course it grows."""
    smallest, *larger = courses
    titles = ((f"{course.count:,}", "growth / the course's") for course in larger)
    head("", f"{smallest.count:,}", *(title for both in titles for title in both))
    for name in courses[-1].figures:
        first = smallest.figures.get(name, 0.0)
        cells = [f"{first:,.1f}"]
        for course in larger:
            value, grown = course.figures.get(name, 0.0), course.count / smallest.count
            times = value / first / (1.0 if "each" in name else grown) if first else 0.0
            cells += [f"{value:,.1f}", f"{times:.2f}"]
        row(name, *cells)


def main() -> None:
    """Make courses, and measure."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--count", type=int, nargs="+", default=[200, 2_000, 20_000])
    parser.add_argument("--folder", type=Path, help="keep everything there")
    parser.add_argument("--quick", action="store_true", help="grade only some by pool and cluster")
    args = parser.parse_args()
    print(machine())
    with ExitStack() as stack:
        place = args.folder or Path(stack.enter_context(tempfile.TemporaryDirectory()))
        os.environ[PLACE] = str(place / "runs")
        if not (place / "runs").is_dir():
            make_runs(place)
        courses = []
        for count in args.count:
            courses.append(Course(place / str(count), count))
            courses[-1].measure(FEW if args.quick else sys.maxsize)
            show(courses)


if __name__ == "__main__":
    if len(sys.argv) > 1 and not sys.argv[1].startswith("-"):
        sys.exit(act(sys.argv[1], sys.argv[2:]))
    main()
