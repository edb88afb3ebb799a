"""Runs of fixture submissions: each made once for all tests, whichever process asks for it first.

They are saved and read back as `grader run` saves them, so what a test sees of one has survived
that, too. See `tests.once` for how long they serve.
"""

from functools import cache, lru_cache
from pathlib import Path

import grader
from grader import grading
from grader.exercise.exercise import Exercise
from grader.exercise.loading import load_exercise
from grader.exercise.result.result import Result
from grader.recording import reading, saving
from grader.recording.recording import Clock, Recording, Recordings
from grader.run import real_time, virtual_time
from grader.run.handover import Plan
from grader.run.limits import Patience
from grader.run.opening import open_submission
from grader.testing.solutions import read_solutions
from tests import once
from tests.hand_ins import REFERENCE, SUBMISSIONS, find

CHALLENGE = load_exercise("turtlesim_challenge")
#: The reference controller with one thing spoiled at a time, by name.
MUTANTS = {each.name: each for each in read_solutions(CHALLENGE) if not each.is_right}
#: So many of each kind are kept in memory: some megabytes each.
KEPT = 8


@cache
def path_of(name: str | Path) -> Path:
    """Where a submission lies.

    Args:
        name: its path below tests/submissions, as `hand_ins` lays it out, without `.py`;
            `reference`, the challenge's; `mutants/NAME`, one of its mutants; or the path of
            something in the tree or `written`.
    """
    if isinstance(name, Path):
        return name
    if name == "reference":
        return REFERENCE
    kind, _, which = name.partition("/")
    return written(MUTANTS[which].text()) if kind == "mutants" else find(SUBMISSIONS, name)


def written(text: str | bytes, file: str = "turtle_controller.py") -> Path:
    """A submission that is not among the files of the tree, always in the same place."""
    data = text.encode() if isinstance(text, str) else text

    def write(folder: Path) -> None:
        (folder / file).write_bytes(data)

    # made by nothing of the tree: its path is in the keys of its recordings
    return once.folder(write, "source", file, data, made_by=()) / file


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
