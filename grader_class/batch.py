"""Grade a class: plan what is still to be done, do it, and write the gradebook and the pages."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from grader import Exercise, UsageError
from grader.exercise import View
from grader.recording import Clock
from grader.submission import LaunchAsked
from grader.system import content, files
from grader.system import versions as system
from grader.text import NOTHING, Message, joined, listed, msg, tr
from grader_class import export, grade
from grader_class.class_file import ANOTHER_MACHINE, CLASS, MACHINE, ClassFile
from grader_class.entry import Entry, HandIn
from grader_class.gradebook.write import CSV
from grader_class.gradebook.write import write as write_gradebook
from grader_class.page import html
from grader_class.pool import Done, Task
from grader_class.store import STUDENTS, Store, of_hand_in, of_run

#: Does tasks, in any order: `grader_class.pool.work` with a number of jobs, or a cluster.
Work = Callable[[Iterable[Task]], Iterator[Done]]


@dataclass(frozen=True)
class Order:
    """How a class is graded.

    Attributes:
        exercise: the loaded exercise.
        exercise_path: what `--exercise` named.
        time: the clock of the submissions.
        seed: chooses where the varied runs start; None: the exercise's own.
        again: what is graded again: "", "failed", "all" or the id of a hand-in.
        isolation: the level at which all are run; '' until it is chosen.
        secret: gives each hand-in a seed of its own; '' for none.
        hides_seed: whether recordings leave out the seeds.
        pseudonyms: shows which key gave the students their pseudonyms; '' where they have names.
        executable, launch: what is started of each; see `Request`.
    """

    exercise: Exercise
    exercise_path: str
    time: Clock = "virtual"
    seed: int | None = None
    again: str = ""
    isolation: str = ""
    secret: str = ""
    hides_seed: bool = False
    pseudonyms: str = ""
    executable: str | None = None
    launch: LaunchAsked | None = None

    def seed_of(self, hand_in: HandIn) -> int | None:
        """Return the seed of the varied runs of a hand-in; None: the exercise's own."""
        if self.seed is not None:
            return self.seed
        return self.exercise.seed_for(hand_in.id, self.secret)

    @property
    def class_file(self) -> ClassFile:
        """The class.json of what is graded so, on this machine."""
        start = f"--executable {self.executable}" if self.executable else ""
        if self.launch is not None:
            given = (f" {name}:={value}" for name, value in sorted(self.launch.given.items()))
            start = f"--launch {self.launch.file}{''.join(given)}"
        return ClassFile(
            self.exercise.name,
            self.exercise.sha256,
            self.time,
            self.seed,
            grader=system.grader_version(),
            ros=f"rclpy {system.rclpy_version()} {system.ros_distro()}".strip(),
            python=system.python_version(),
            isolation=self.isolation,
            seed_file=content.of_bytes(f"class {self.secret}".encode())[:12] if self.secret else "",
            pseudonyms=self.pseudonyms,
            start=start,
        )


@dataclass(frozen=True)
class Planned:
    """What is to be done.

    Attributes:
        tasks: one for each distinct submission; their `into` is not made yet.
        trivial: hand-ins that need no worker.
        done: hand-ins that are graded already.
        alike: how many hand-ins share the run of another one.
    """

    tasks: tuple[Task, ...]
    trivial: tuple[HandIn, ...]
    done: tuple[HandIn, ...]
    alike: int

    @property
    def hand_ins(self) -> int:
        return sum(len(t.hand_ins) for t in self.tasks) + len(self.trivial) + len(self.done)


def check_same_class(store: Store, wanted: ClassFile, again: str = "") -> None:
    """Refuse to grade into the folder of another class; write class.json into a new one."""
    is_new = not (store.out / CLASS).is_file()
    differences = {} if is_new else wanted.differences(ClassFile.read(store.out))
    if is_new or (again == "all" and differences.keys() <= {*MACHINE, "exercise_sha256"}):
        wanted.put(store.out)
        return
    if not differences:
        return
    advice = msg("Give another --out.")
    if differences.keys() == {"exercise_sha256"}:
        advice = msg(
            "See what the new one would change: grader batch --regrade {out} --exercise ...",
            out=str(store.out),
        )
    elif differences.keys() <= MACHINE:
        advice = ANOTHER_MACHINE
    raise UsageError(
        "{out} was graded by something else ({differences}). Nothing was changed. {advice}",
        out=str(store.out),
        differences=joined(list(differences.values()), "; "),
        advice=advice,
    )


def check_lateness(hand_ins: Iterable[HandIn], exercise: Exercise) -> None:
    """Refuse to grade by a policy for late hand-ins where no times and no marks tell them."""
    there = [each for each in hand_ins if each.problem == NOTHING]
    unknown = [each for each in there if each.at is None]
    is_costly = exercise.late is not None and exercise.late.per_day > 0
    if is_costly and unknown and not any(each.is_marked_late for each in there):
        raise UsageError(
            "{name} takes points from late hand-ins (late:), and when they were handed in is not "
            "known: {who}. Add a roster.csv with the columns id and at, or leave `late` out.",
            name=exercise.name,
            who=listed(each.known_as for each in unknown),
        )


def plan(hand_ins: Sequence[HandIn], order: Order, store: Store) -> Planned:
    """Plan what is to be done for these hand-ins, and record their number in class.json."""
    if order.again not in ("", "all", "failed", *(each.id for each in hand_ins)):
        raise UsageError("--again {again}: there is no hand-in of this name", again=order.again)
    by_key: dict[str, list[HandIn]] = {}
    trivial, done = [], []
    for hand_in, run in _with_keys(hand_ins, order):
        if _is_done(store.student(hand_in.id), hand_in, run, order):
            done.append(hand_in)
        elif run:
            by_key.setdefault(run, []).append(hand_in)
        else:
            trivial.append(hand_in)
    tasks = tuple(_task(run, everybody, order, store) for run, everybody in by_key.items())
    alike = sum(len(task.hand_ins) - (task.run is None) for task in tasks)
    planned = Planned(tasks, tuple(trivial), tuple(done), alike)
    replace(order.class_file, hand_ins=planned.hand_ins).put(store.out)
    return planned


def carry_out(planned: Planned, order: Order, store: Store, work: Work) -> Iterator[HandIn]:
    """Do what is planned; yield each hand-in as soon as its folder is in its place."""
    for hand_in in planned.trivial:
        place = store.new_place()
        grade.nothing(hand_in, order.exercise, place / STUDENTS / hand_in.id)
        store.put("", place)
        yield hand_in
    level = order.isolation
    tasks = (replace(each, into=store.new_place(), isolation=level) for each in planned.tasks)
    for task, answer in work(tasks):
        place = task.into
        why = _unusable(task, order) if answer.state == "done" else answer.why
        if why or answer.state != "done":
            place = store.new_place()
            for hand_in in task.hand_ins:
                folder = place / STUDENTS / hand_in.id
                grade.failed(hand_in, order.exercise, folder, why)
        store.put(task.key, place)
        yield from task.hand_ins


def _unusable(task: Task, order: Order) -> Message:
    """Return why the files of a finished task cannot be used; '' where they can."""
    for hand_in in task.hand_ins:
        try:
            entry = Entry.read(task.into / STUDENTS / hand_in.id)
        except UsageError as error:
            return msg("what a worker sent back cannot be used: {why}", why=error.message)
        if entry.exercise_sha256 != order.exercise.sha256:
            raise UsageError(
                "the exercise {name} was changed while a class was graded by it, or a worker "
                "of the cluster has another edition of it. What was graded before is kept; see "
                "to it that there is one edition, and call again",
                name=order.exercise.name,
            )
    return NOTHING


def _with_keys(hand_ins: Iterable[HandIn], order: Order) -> Iterator[tuple[HandIn, str]]:
    """Yield each hand-in with the key of its run; '' where there is nothing to run."""
    for hand_in in hand_ins:
        if hand_in.path is None:
            yield hand_in, ""
            continue
        try:
            content = of_hand_in(hand_in.path, hand_in.filename)
        except OSError as error:
            why = msg("It cannot be read: {why}", why=error.strerror or str(error))
            yield replace(hand_in, problem=why, path=None), ""
            continue
        seed = order.seed_of(hand_in)
        yield hand_in, of_run(content, order.exercise, order.time, seed)


def _is_done(folder: Path, hand_in: HandIn, run: str, order: Order) -> bool:
    """Whether a folder holds what grading would make; a grader's failure has no run to compare."""
    if order.again in ("all", hand_in.id):
        return False
    try:
        entry = Entry.read(folder)
    except UsageError:
        return False  # not there, not finished, or gone bad
    if order.again == "failed" and entry.state == "failed":
        return False
    is_same = entry.hand_in == replace(hand_in, path=None)
    is_run = entry.state == "failed" or (entry.key == run and (entry.state != "nothing" or not run))
    is_exercise = entry.exercise_sha256 == order.exercise.sha256
    return is_same and is_run and is_exercise and entry.max_score == order.exercise.max_score


def _task(run: str, everybody: Sequence[HandIn], order: Order, store: Store) -> Task:
    first = everybody[0]
    assert first.path is not None
    is_again = order.again in ("all", *(each.id for each in everybody))
    return Task(
        run,
        tuple(everybody),
        order.exercise_path,
        order.time,
        order.seed_of(first),
        run=store.run(run) if store.has(run) and not is_again else None,
        path=first.path.absolute(),
        filename=first.filename,
        hides_seed=order.hides_seed,
        executable=order.executable,
        launch=order.launch,
    )


def write_outputs(
    out: Path,
    entries: Sequence[Entry],
    exercise: Exercise,
    view: View = "student",
    assignment: str = "",
) -> list[Message]:
    """Write the gradebook and the pages of a class.

    Args:
        view: who reads the feedback: a student before, or after the exercise is due.
        assignment: what Canvas calls the exercise.

    Returns:
        Notes for the teacher, as sentences.
    """
    links = {tr("Gradebook"): CSV}
    for older in out.glob(html.FURTHER.format("*")):
        files.clear(older)
    for name, text in html.render_all(entries, exercise, links).items():
        files.put(out / name, text.encode("utf-8"))
    notes = write_gradebook(out, entries, exercise.title, view, assignment)
    export.write_exports(entries, exercise, out)
    return notes
