"""Try an exercise on its right solutions and mutants, as `grader check-exercise` does."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor, as_completed
from dataclasses import replace
from pathlib import Path

from grader.exercise.asking import OF_FILES, Answers, NoFinding, NotReached
from grader.exercise.check import answers, judge_by
from grader.exercise.exercise import Exercise
from grader.exercise.loading import load_exercise
from grader.exercise.result.diagnosis import diagnose
from grader.exercise.verdict import Evidence, Finding, Verdict
from grader.grading import gather, record
from grader.judging import AnyPath
from grader.recording.recording import Recording, Recordings, Run
from grader.recording.subject import CAST_SCENE, Start, Trace
from grader.scenes.subject import load_subject
from grader.system.scratch import make_folder
from grader.testing import parrot
from grader.testing.examination import Examination, Fault, Problem, Trial
from grader.testing.extensions import changed_in_a_bag
from grader.testing.solutions import FILE_NAME, Left, Solution, read_solutions
from grader.text.message import Message, msg

#: Called after each run with the number of finished runs, that of all, and the solution's name.
Progress = Callable[[int, int, str], None]
AGAIN, PARROT = "again", "parrot of "
#: The share of points that a parrot may have where others send or ask something.
MOST_EXCUSED = 0.25
#: The share of a check's points that it may have by chance.
BY_CHANCE = 0.1


def check_exercise(
    exercise: AnyPath | Exercise,
    *,
    mutants: AnyPath | None = None,
    jobs: int | None = None,
    progress: Progress | None = None,
) -> Examination:
    """Try an exercise: its right solutions must get every point, each mutant must lose some.

    Every solution is run in virtual time, the first right one twice; every check judges each
    recording twice, and recordings of odd runs.

    Args:
        exercise: its name, its path, or the loaded one.
        mutants: the file that lists the solutions; None for mutants.yaml in its folder.
        jobs: how many solutions are run at once; None for as many as there are cores.
        progress: called after each run.

    Raises:
        ExerciseError: the exercise or its list of solutions cannot be used.
        SubmissionError: one of the solutions cannot be started.
        GraderFailure: the grader itself failed.
    """
    asked = exercise if isinstance(exercise, Exercise) else load_exercise(exercise)
    solutions = read_solutions(asked, None if mutants is None else Path(mutants))
    recorded = _run(asked, solutions, jobs or os.cpu_count() or 1, progress)
    faults: dict[Fault, list[str]] = {}
    trials = []
    for solution in solutions:
        recordings = recorded[solution.name]
        verdicts, wrong = examine(asked, recordings)
        flags = dict.fromkeys(flag for each in recordings for flag in each.run.flags)
        trial = Trial(solution, tuple(verdicts), tuple(flags))
        wrong += dict.fromkeys(filter(None, (_changed(asked, each) for each in recordings)))
        wrong += [*_unexpected(trial), *_wrong_first_line(trial, recordings, asked)]
        if solution is solutions[0]:
            wrong += _twice(asked, trial, recordings, recorded[AGAIN])
        trials.append(trial)
        for fault in wrong:
            faults.setdefault(fault, []).append(solution.name)
    for what, recordings in odd_recordings(asked).items():
        changed = filter(None, (_changed(asked, each) for each in recordings))
        for fault in dict.fromkeys([*examine(asked, recordings)[1], *changed]):
            faults.setdefault(fault, []).append(what)
    parrots = [
        Trial(solution, tuple(examine(asked, recorded[name])[0]))
        for solution in solutions
        if (name := f"{PARROT}{solution.name}") in recorded
    ]
    for trial in parrots:
        for fault in _parroted(asked, trial):
            faults.setdefault(fault, []).append(trial.solution.name)
    problems = [Problem(fault, tuple(on)) for fault, on in faults.items()]
    checks = tuple(asked.points)
    examination = Examination(asked.name, checks, tuple(trials), (), tuple(parrots))
    problems += [Problem(fault) for fault in _never_failing(examination)]
    return replace(examination, problems=tuple(problems))


def odd_recordings(exercise: Exercise) -> Mapping[str, Recordings]:
    """Return recordings of the odd runs of the exercise's scene, from every start."""
    is_beside = exercise.cases[0].cast is not None and not exercise.subject.has_cast
    cast = load_subject(CAST_SCENE).untouched(None) if is_beside else None

    def recorded(trace: Trace, start: Start | None, case: str) -> Recording:
        run = Run(
            time="virtual",
            ticks=trace.ticks,
            simulated_s=trace.duration_ns / 1e9,
            trace_sha256=trace.sha256(),
            case=case,
        )
        return Recording(trace, run, start=start, scene=exercise.scene, cast=cast)

    starts = [(start, "") for start in (None, *exercise.starts())]
    starts += [(None, each.name) for each in exercise.cases[1:]]
    runs = [exercise.subject.odd_traces(exercise.setting, start) for start, _ in starts]
    return {
        what: gather((n, recorded(r[what], *starts[n])) for n, r in enumerate(runs))
        for what in runs[0]
    }


def _run(
    exercise: Exercise, solutions: Sequence[Solution], jobs: int, progress: Progress | None
) -> Mapping[str, Recordings]:
    """Run all solutions, and the first once more; and the parrots of the right ones."""
    with make_folder() as folder, ThreadPoolExecutor(jobs) as pool:

        def run(solution: Solution, name: str) -> Recordings:
            path = paths[solution.name]
            recordings = record(path, exercise)
            if solution.is_right and exercise.is_started and name != AGAIN:
                at = folder / "parrots" / name
                parrots[PARROT + name] = parrot.record(path, exercise, recordings, at)
            return recordings

        paths = {solution.name: solution.lay_out(folder) for solution in solutions}
        parrots: dict[str, Recordings] = {}
        tasks: dict[Future[Recordings], str] = {}
        try:
            for name, solution in [(AGAIN, solutions[0]), *((s.name, s) for s in solutions)]:
                tasks[pool.submit(run, solution, name)] = name
            for count, task in enumerate(as_completed(tasks), start=1):
                task.result()
                if progress:
                    shown = solutions[0].name if tasks[task] == AGAIN else tasks[task]
                    progress(count, len(tasks), shown)
        except BaseException:
            pool.shutdown(cancel_futures=True)
            raise
        return parrots | {name: task.result() for task, name in tasks.items()}


def _changed(exercise: Exercise, recording: Recording) -> Fault | None:
    """Return what `grader check` would refuse, the fault of the scene."""
    why = changed_in_a_bag(recording.trace, exercise.subject)
    return Fault("", why) if why else None


def _unexpected(trial: Trial) -> Iterator[Fault]:
    """Yield where a solution is not judged as it should be."""
    solution = trial.solution
    if solution.is_right:
        for verdict in trial.verdicts:
            if verdict.status != "passed":
                yield Fault(
                    verdict.check,
                    msg("a right solution loses points: {rationale}", rationale=verdict.rationale),
                )
        return
    if not trial.caught_by:
        yield Fault("", msg("nobody catches a mutant"))
    if solution.leaves is None:
        return
    for verdict in trial.verdicts:
        expected = solution.leaves.get(verdict.check, 1.0)
        if not _fits(verdict.score, verdict.max_score, expected):
            text = msg(
                "leaves {score:g} of {max_score:g} points; {file} says {said}",
                score=verdict.score,
                max_score=verdict.max_score,
                file=FILE_NAME,
                said="some"
                if expected == "some"
                else msg("{points:g}", points=expected * verdict.max_score),
            )
            yield Fault(verdict.check, text)


def _wrong_first_line(trial: Trial, recordings: Recordings, exercise: Exercise) -> Iterator[Fault]:
    """Yield a fault if the first line of a mutant's report lacks the expected words."""
    expected = trial.solution.first_line
    if not expected:
        return
    found = diagnose(exercise, recordings, trial.verdicts)
    line = "" if found is None else str(found.cause)
    if found is not None and found.place is not None:
        line += f" ({found.place.file}, line {found.place.line})"
    if expected not in line:
        yield Fault(
            "",
            msg(
                "its first line is {told!r}; {file} says {says!r}",
                told=line,
                file=FILE_NAME,
                says=expected,
            ),
        )


def _fits(score: float, max_score: float, expected: Left) -> bool:
    if expected == "some":
        return 0 < score < max_score
    return score == round(max_score * expected, 2)


def _twice(
    exercise: Exercise, trial: Trial, first: Recordings, second: Recordings
) -> Iterator[Fault]:
    """Yield what differs between two runs of the same solution."""
    hashes = [[run.run.trace_sha256 for run in recordings] for recordings in (first, second)]
    if hashes[0] != hashes[1]:
        yield Fault("", msg("two runs of a right solution are not the same run"))
        return
    for once, again in zip(trial.verdicts, examine(exercise, second)[0], strict=True):
        if once != again:
            yield Fault(once.check, msg("two equal runs get different findings"))


def _parroted(exercise: Exercise, trial: Trial) -> Iterator[Fault]:
    """Yield the checks that a parrot passes, and that do not say why."""
    excuses = {check.name: check.parrot for check in exercise.checks}
    excused = 0.0
    for verdict in trial.verdicts:
        if verdict.score <= BY_CHANCE * verdict.max_score:
            continue
        if why := excuses[verdict.check]:
            excused += verdict.score if why != OF_FILES else 0.0
            continue
        text = msg(
            "a program that repeats what a right one sent, and hears nothing, gets {score:g} of "
            "{max_score:g} points: draw what it has to hear, or say why with `parrot`",
            score=verdict.score,
            max_score=verdict.max_score,
        )
        yield Fault(verdict.check, text)
    peers = (exercise.cases[0].cast or {}).values()
    is_told = any({*peer} - {"subscriptions"} for peer in peers)
    if is_told and excused > MOST_EXCUSED * exercise.max_score:
        text = msg("`parrot` excuses {n:g} points; at most a quarter may be", n=excused)
        yield Fault("", text)


def _never_failing(examination: Examination) -> Iterator[Fault]:
    if not examination.mutants:
        yield Fault("", msg("there are no mutants in {file}", file=FILE_NAME))
        return
    for check, caught in examination.catches.items():
        if not caught:
            yield Fault(check, msg("never fails on any mutant"))


def examine(exercise: Exercise, recordings: Recordings) -> tuple[list[Verdict], list[Fault]]:
    """Return the verdicts on recordings, and the faults of the checks that made them."""
    faults: list[Fault] = []
    is_whole = True

    def judged(answered: Answers) -> list[Verdict]:
        def watched(name: str) -> Finding:
            nonlocal is_whole
            try:
                finding = answered(name)
            except NoFinding as error:
                faults.append(Fault(name, Message.of(str(error))))
                return Finding(0, Message.of("The check found nothing."))
            except NotReached as hit:
                is_whole = False
                if hit.by == name:
                    faults.append(Fault(name, hit.what))
                return Finding(0, Message.of("The check found nothing."))
            odd = list(_odd_about(finding, exercise, recordings))
            faults.extend(Fault(name, text) for text in odd)
            return finding

        return judge_by(watched, exercise.checks, exercise.points)

    # both times in the same process, which may keep state that it should not
    judging = (exercise.checks, exercise.points, exercise.tolerances)
    first, second = map(judged, answers(recordings, *judging, rounds=2))
    for once, again in zip(first, second, strict=True):
        if is_whole and repr(once) != repr(again):  # repr: NaN is not equal to itself
            text = msg("finds something else when it is asked again about the same recordings")
            faults.append(Fault(once.check, text))
    return first, list(dict.fromkeys(faults))


def _odd_about(finding: Finding, exercise: Exercise, recordings: Recordings) -> Iterator[Message]:
    if not str(finding.rationale).strip():
        yield msg("has an empty rationale: what was seen?")
    if finding.share < 1 and not str(finding.help).strip():
        yield msg("fails without help: what is there to look at?")
    for item in finding.evidence:
        yield from _odd_about_evidence(item, exercise, recordings)


def _odd_about_evidence(
    item: Evidence, exercise: Exercise, recordings: Recordings
) -> Iterator[Message]:
    end_s = list(recordings)[item.run].run.simulated_s
    if item.time_s > end_s + 0.001:
        yield msg("evidence: {time_s} s is outside the recording", time_s=item.time_s)
    if item.place and not exercise.subject.plane.holds(*item.place):
        yield msg("evidence: the place ({x}, {y}) is outside the picture", x=item.x, y=item.y)
    if not item.note:
        yield msg("evidence: has an empty note")
