"""Grade a submission: run it, judge the recordings, build the result.

`grade` does all of it, `record` one half, `grader.judging.judge` the other. They change nothing in
the calling process (no signal handler, no current folder, no environment variable), and may be
called from any thread, several at once.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor, as_completed
from contextlib import contextmanager
from dataclasses import replace
from fnmatch import fnmatchcase
from functools import partial
from itertools import product
from pathlib import Path

from grader.errors import ExerciseError, GraderFailure, UsageError
from grader.exercise import places
from grader.exercise.exercise import Exercise
from grader.exercise.loading import load_exercise
from grader.exercise.result.result import Result
from grader.judging import AnyPath, judge, loaded
from grader.recording.recording import Clock, Provenance, Recording, Recordings, now
from grader.recording.subject import PACKAGE_SCENE, Role, Trace
from grader.run import inspecting, real_time, virtual_time
from grader.run.finish import SimulatorLost, not_run, recording_of_nothing
from grader.run.handover import Plan
from grader.run.limits import CpuBudget
from grader.run.opening import marks_of, open_submission
from grader.run.processes import cores
from grader.run.simulator_process import Audience
from grader.scenes.scene import Scene
from grader.scenes.subject import load_subject
from grader.submission.private_copy import missing_neighbours
from grader.submission.program_source import is_among
from grader.submission.reader import Marks
from grader.submission.start import Submission
from grader.system import content
from grader.system import versions as system
from grader.system.extensions import DEFAULT_EXERCISE
from grader.text.message import NOTHING, Message, msg
from grader.text.strings import listed, shown

Progress = Callable[[float], None]
REPEATED = msg("repeated, because the first try failed in the grader")
#: The least number of runs at once, even on less than two cores: each waits now and then.
LEAST_AT_ONCE = 2
#: A run's number, 0 nominal, 1, 2, ... varied, and its recording.
Finished = tuple[int, Recording]


#: Runs a submission once; see `grader.run.virtual_time` and `grader.run.real_time`.
Runner = Callable[[Submission, Plan, Progress | None], Recording]


#: Each takes an `audience` besides.
RUNNERS: Mapping[Clock, Callable[..., Recording]] = {
    "real": real_time.run,
    "virtual": virtual_time.run,
}


def runner(exercise: Exercise, time: Clock, audience: Audience | None = None) -> Runner:
    """Return the runner for an exercise; without a clock where nothing is started.

    Args:
        audience: receives the runs live, of which there must be one at once.
    """
    if not exercise.is_started:
        return inspecting.run
    return RUNNERS[time] if audience is None else partial(RUNNERS[time], audience=audience)


def exercise_for(path: Path, marks: Marks) -> tuple[str, Message]:
    """Return the exercise that a submission names, else the default one; and what to say of it.

    Raises:
        UsageError: the one that it names is not installed; or it names none, and fits several.
    """
    if len(marks.exercises) > 1:
        names = listed(marks.exercises)
        several = msg(
            "It names several exercises ({names}), so that none counts: choose one with --exercise",
            names=names,
        )
        return DEFAULT_EXERCISE, several
    for name, file in marks.exercises.items():
        if not places.is_installed(name):
            raise UsageError(
                "{path} names the exercise {name!r} (in {file}), which is not installed here; give "
                "its folder: --exercise FOLDER",
                path=shown(path),
                name=name,
                file=file,
            )
        said = msg("Exercise: {name} (named in {file})", name=name, file=file)
        return name, NOTHING if name == DEFAULT_EXERCISE else said
    fitting = fitting_exercises(marks)
    if len(fitting) == 1:
        said = msg("Exercise: {name}, by what the source has; another one: --exercise NAME")
        return fitting[0], said.given(name=fitting[0])
    if fitting:
        raise UsageError(
            "{path} fits several exercises ({names}): choose one with --exercise NAME",
            path=shown(path),
            names=listed(fitting),
        )
    return DEFAULT_EXERCISE, NOTHING


def fitting_exercises(marks: Marks) -> list[str]:
    """Return the installed exercises that a submission fits best, none where the default one does.

    It fits where it has all that an exercise names: on the graph, or, without a program, files.
    """
    if _worth(DEFAULT_EXERCISE, marks):
        return []
    worth = {name: _worth(name, marks) for name in places.names()}
    best = max(worth.values())
    return [name for name, each in worth.items() if each == best > 0]


def _worth(name: str, marks: Marks) -> int:
    """Return how much of what an exercise names a submission has; 0 where it lacks some."""
    try:
        exercise = load_exercise(name)
    except ExerciseError:
        return 0
    if not marks.programs:
        files = product(marks.files, exercise.fits)
        return any(fnmatchcase(file.lower(), pattern) for file, pattern in files)
    wanted, subject = exercise.roles, exercise.subject
    if not wanted and isinstance(subject, Scene):  # what drives the scene
        wanted = {Role("publisher", each) for each in subject.introduction.topics[:1]}
    has_all = all(is_among(role, marks.roles) for role in wanted)
    return len(wanted) if has_all and marks.programs >= len(exercise.programs) else 0


def grade(
    submission: AnyPath | Submission,
    exercise: AnyPath | Exercise | None = None,
    *,
    time: Clock = "virtual",
    seed: int | None = None,
    executable: str | None = None,
    progress: Progress | None = None,
) -> Result:
    """Run a submission and judge it. Nothing is written, and no process of the run is left behind.

    Two fork servers wait for the next grading, and end with this process; see
    `grader.run.fork_servers`.

    Args:
        submission: the path of a .py file, a folder, a package or a zip; or what `open_submission`
            has returned for one.
        exercise: the name of an installed exercise, the path of one, or one that is loaded; None
            for the one that the path names, else the default one.
        time: the clock of the submission: "virtual" takes seconds, "real" minutes.
        seed: chooses where the varied runs start; None for the exercise's seed.
        executable: which console script or file to start, where there are several.
        progress: called now and then with the simulated time of the nominal run [s], from
            another thread.

    Raises:
        UsageError: there is no such submission, or `time`, `seed` or `executable` is none.
        SubmissionError: there is nothing to start, no way to tell what, or no ROS to run it in.
        ExerciseError: there is no such exercise, or it cannot be used.
        GraderFailure: the grader itself failed, twice; never the submission's fault.
    """
    asked = _asked(submission, exercise)
    with _opened(submission, executable, asked) as opened:
        recordings = record(opened, asked, time=time, seed=seed, progress=progress)
        return judge(recordings, asked, submission=opened.name)


def record(
    submission: AnyPath | Submission,
    exercise: AnyPath | Exercise | None = None,
    *,
    time: Clock = "virtual",
    seed: int | None = None,
    executable: str | None = None,
    progress: Progress | None = None,
    hides_seed: bool = False,
) -> Recordings:
    """Run a submission without judging it; see `grade`.

    Args:
        hides_seed: whether the recordings leave out the seed.
    """
    if time not in RUNNERS:
        raise UsageError(f"time: expected one of {', '.join(RUNNERS)}, found {time!r}")
    if seed is not None and (isinstance(seed, bool) or not isinstance(seed, int)):
        raise UsageError(f"seed: expected a whole number, found {seed!r}")
    asked = _asked(submission, exercise)
    with _opened(submission, executable, asked) as opened:
        plans = plan(opened, asked, seed, hides_seed)
        origin = provenance(opened, asked, seed, hides_seed)
        with start(opened, plans, runner(asked, time), progress, origin) as runs:
            return gather(runs)


def plan(
    submission: Submission, exercise: Exercise, seed: int | None = None, hides_seed: bool = False
) -> list[Plan]:
    """Plan the nominal run of a submission and, where the exercise asks for it, varied ones.

    Args:
        hides_seed: whether the recordings leave out the seed, which is a secret.

    Raises:
        SubmissionError: there is no ROS in which it could run.
    """
    starts = exercise.starts(seed)
    budget = CpuBudget(exercise.cpu_s)
    budget.spend(submission.spent_s)
    used = exercise.varied.seed if seed is None else seed
    imports = submission.imports
    scene = exercise.subject
    interfaces = ""
    if isinstance(scene, Scene):
        interfaces = scene.interfaces_for(imports.surely, imports.perhaps)
    (usual, drawn), *others = exercise.drawn_cases(seed)
    own = {} if usual.cast is None else submission.interfaces.importable
    nominal = Plan(
        exercise.limits,
        scene=exercise.scene,
        seed=used if exercise.has_chance and not hides_seed else None,
        interfaces=interfaces,
        setting=exercise.setting,
        looks_at_package=exercise.looks_at_package and submission.package is not None,
        inspections=exercise.inspections,
        definitions=exercise.interfaces,
        cast=usual.cast,
        hears=usual.hears,
        own_definitions=own,
        arguments=usual.arguments,
        drawn=drawn,
        budget=budget,
    )
    varied = [replace(nominal, start=start, seed=None) for start in starts]
    for each, drawn in others:
        own_part = replace(nominal, cast=each.cast, hears=each.hears, arguments=each.arguments)
        varied.append(replace(own_part, case=each.name, drawn=drawn, seed=None))
    missing = missing_neighbours(
        submission.name, submission.copy, (*imports.surely, *imports.perhaps)
    )
    return [replace(nominal, flags=(*submission.remarks, *missing)), *varied]


def provenance(
    submission: Submission, exercise: Exercise, seed: int | None = None, hides_seed: bool = False
) -> Provenance:
    """Return what is known of runs before they begin, for their record; see `plan`."""
    used = exercise.varied.seed if seed is None else seed
    copy = submission.copy
    return Provenance(
        date=now(),
        grader=system.grader_version(),
        python=system.python_version(),
        rclpy=system.rclpy_version(),
        ros_distro=system.ros_distro(),
        submission=submission.name,
        submission_sha256="" if copy is None else content.of_folder(copy.folder, copy.installed),
        exercise=exercise.name,
        exercise_sha256=exercise.sha256,
        seed=used if exercise.has_chance and not hides_seed else None,
        conditions=exercise.conditions,
    )


@contextmanager
def start(
    submission: Submission,
    plans: Sequence[Plan],
    run: Runner,
    progress: Progress | None = None,
    origin: Provenance | None = None,
    at_once: int | None = None,
) -> Iterator[Iterator[Finished]]:
    """Start runs, as many at once as there are cores; yield each as soon as it is over.

    The caller can handle one while the others go on. None goes on after the context.

    Args:
        plans: from `plan`.
        progress: called with the simulated seconds of the nominal run.
        origin: from `provenance`; comes into the nominal recording.
        at_once: so many at once instead; 1 runs them in the order of `plans`.

    Raises:
        GraderFailure: a run could not be made, twice; while iterating.
    """

    def run_twice_at_most(plan: Plan) -> Recording:
        if plan.budget.is_spent:
            return not_run(plan, plan.budget.remark)
        show = progress if plan is plans[0] else None
        again = replace(plan, flags=(REPEATED, *plan.flags))
        try:
            return run(submission, plan, show)
        except SimulatorLost:
            try:
                return run(submission, again, show)
            except SimulatorLost as lost:
                return recording_of_nothing(again, lost)
        except GraderFailure:
            return run(submission, again, show)

    inspects = plans[0].looks_at_package
    if inspects:
        # before threads begin: two that import parts of one library at once may deadlock
        load_subject(PACKAGE_SCENE)
    many = min(len(plans) + inspects, max(LEAST_AT_ONCE, math.ceil(cores.share())))
    pool = ThreadPoolExecutor(max_workers=at_once or many)
    try:
        numbers = {pool.submit(run_twice_at_most, each): n for n, each in enumerate(plans)}
        inspection = pool.submit(_inspect_twice_at_most, submission, plans[0]) if inspects else None
        over = (
            (numbers[future], replace(future.result(), interfaces=submission.defined))
            for future in as_completed(numbers)
        )
        yield ((n, r if n else _nominal(r, origin, inspection)) for n, r in over)
    finally:
        pool.shutdown(cancel_futures=True)


def _inspect_twice_at_most(submission: Submission, plan: Plan) -> tuple[Trace, tuple[Message, ...]]:
    try:
        return inspecting.inspect_beside(submission, plan)
    except GraderFailure:
        return inspecting.inspect_beside(submission, plan)


def _nominal(
    recording: Recording,
    origin: Provenance | None,
    inspection: Future[tuple[Trace, tuple[Message, ...]]] | None,
) -> Recording:
    """Add to the nominal run the inspection beside it and its origin."""
    package, remarks = inspection.result() if inspection else (None, ())
    run = replace(recording.run, flags=(*remarks, *recording.run.flags))
    return replace(recording, run=run, package=package, provenance=origin)


def gather(runs: Iterable[Finished]) -> Recordings:
    """Collect runs, in whatever order they ended, for judging."""
    nominal, *varied = (recording for _, recording in sorted(runs, key=lambda run: run[0]))
    return Recordings(nominal, tuple(varied))


def _asked(submission: AnyPath | Submission, exercise: AnyPath | Exercise | None) -> Exercise:
    if exercise is None and not isinstance(submission, Submission):
        exercise, _ = exercise_for(Path(submission), marks_of(Path(submission)))
    return loaded(DEFAULT_EXERCISE if exercise is None else exercise)


@contextmanager
def _opened(
    submission: AnyPath | Submission, executable: str | None, exercise: Exercise
) -> Iterator[Submission]:
    if isinstance(submission, Submission):
        yield submission
        return
    with open_submission(Path(submission), executable, **exercise.opening) as opened:
        yield opened
