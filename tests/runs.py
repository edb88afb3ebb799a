"""Runs of fixture submissions: each made once for all tests, whichever process asks for it first.

They are saved and read back as `grader run` saves them, so what a test sees of one has survived
that, too. See `tests.once` for how long they serve.
"""

from __future__ import annotations

import re
import shutil
from functools import cache, lru_cache
from pathlib import Path
from typing import Any

import yaml

import grader
from grader import grading
from grader.exercise.exercise import Exercise
from grader.exercise.loading import load_exercise
from grader.recording import reading, saving
from grader.recording.recording import Clock, Recording, Recordings
from grader.result.result import Result
from grader.run import real_time, virtual_time
from grader.run.handover import Plan
from grader.run.limits import Patience
from grader.run.opening import open_submission
from tests import once
from tests.submissions import beginners
from tests.submissions.mutants import MUTANTS, REFERENCE

SUBMISSIONS = Path(__file__).parent / "submissions"
TUTORIALS = SUBMISSIONS / "tutorials"
CHALLENGE = load_exercise("turtlesim_challenge")
#: So many of each kind are kept in memory: some megabytes each.
KEPT = 8


@cache
def path_of(name: str | Path) -> Path:
    """Where a submission lies.

    Args:
        name: its path below tests/submissions, without `.py`; `reference`, the challenge's;
            `mutants/NAME`, one of its mutants; `tutorials/EXERCISE/mutants/NAME`, one of a
            tutorial's; a row of first_lines.yaml; or the path of something in the tree or
            `written`.
    """
    if isinstance(name, Path):
        return name
    if name == "reference":
        return REFERENCE
    kind, _, which = name.partition("/")
    if kind == "mutants":
        return written(MUTANTS[which].text())
    if of_tutorial := re.fullmatch(r"tutorials/(\w+)/mutants/(\w+)", name):
        return mutant(*of_tutorial.groups())
    if name in beginners.ROWS and (source := beginners.source(name)) is not None:
        return written(source, f"{Path(name).name}.py")
    path = SUBMISSIONS / name
    return path if path.is_dir() else path.with_name(f"{path.name}.py")


@cache
def mutants_of(exercise: str) -> dict[str, dict[str, Any]]:
    """The mutants of a tutorial's official solution, by name."""
    found: dict[str, dict[str, Any]] = yaml.safe_load(
        (TUTORIALS / exercise / "mutants.yaml").read_text(encoding="utf-8")
    )
    return found


def mutant(exercise: str, name: str) -> Path:
    """Where a mutant lies: the official solution, a file or a folder, with passages replaced."""
    changes = mutants_of(exercise)[name]["changes"]
    official = TUTORIALS / exercise / "right" / "official"
    if not official.is_dir():
        official = official.with_suffix(".py")
    hand_in = f"{name}{official.suffix}"

    def make(folder: Path) -> None:
        made = folder / hand_in
        shutil.copytree(official, made) if official.is_dir() else shutil.copy(official, made)
        for *file, old, new in changes:
            path = made.joinpath(*file)
            text = path.read_text(encoding="utf-8")
            assert text.count(old) == 1, (path, old)
            path.write_text(text.replace(old, new), encoding="utf-8")

    return once.folder(make, "tutorial", exercise, name, str(changes)) / hand_in


def written(text: str | bytes, file: str = "turtle_controller.py") -> Path:
    """A submission that is not among the files of the tree, always in the same place."""
    data = text.encode() if isinstance(text, str) else text
    return (
        once.folder(lambda folder: (folder / file).write_bytes(data), "source", file, data) / file
    )


@lru_cache(KEPT)
def recorded(
    name: str | Path,
    plan: Plan,
    patience: Patience | None = None,
    *,
    time: Clock = "virtual",
    number: int = 1,
) -> Recording:
    """One run of a submission.

    Args:
        name: see `path_of`.
        patience: None for the usual one.
        number: 2, 3, ... are further runs of the same, to be compared with the first.
    """

    def run(folder: Path) -> None:
        with open_submission(path_of(name)) as submission:
            if time == "real":
                recording = real_time.run(submission, plan)
            else:
                recording = virtual_time.run(submission, plan, patience=patience or Patience())
        saving.save_all(Recordings(recording), folder)

    key = (name, once.digest(path_of(name)), plan, patience, time, number)
    return reading.load(once.folder(run, "run", *key, made_by=once.RUNS))


def recordings(
    name: str | Path, exercise: Exercise = CHALLENGE, *, number: int = 1, seed: int | None = None
) -> Recordings:
    """All runs of a submission that an exercise asks for, in virtual time; see `recorded`.

    Args:
        seed: chooses where the varied runs start; None for the exercise's seed.
    """

    def run(folder: Path) -> None:
        with open_submission(path_of(name), **exercise.opening) as submission:
            plans = grading.plan(submission, exercise, seed)
            origin = grading.provenance(submission, exercise, seed)
            run = grading.runner(exercise, "virtual")
            # one at a time: another worker has the other core
            with grading.start(submission, plans, run, None, origin, at_once=1) as runs:
                saving.save_all(grading.gather(runs), folder)

    key = (
        *(name, once.digest(path_of(name)), number, seed),
        *(exercise.name, exercise.sha256, sorted(exercise.conditions.items())),
    )
    return _loaded(once.folder(run, "runs", *key, made_by=once.RUNS))


_loaded = lru_cache(KEPT)(reading.load_all)


def graded(
    name: str | Path, exercise: Exercise = CHALLENGE, *, number: int = 1, seed: int | None = None
) -> Result:
    """What a submission gets for these runs."""
    found = recordings(name, exercise, number=number, seed=seed)
    return grader.judge(found, exercise, submission=path_of(name).name)
