"""An exercise, as it is loaded."""

from __future__ import annotations

import ast
import errno
import hashlib
import math
import random
import re
import sys
import unicodedata
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Annotated, Any, Literal

from grader.errors import ExerciseError
from grader.exercise.allowed import Allowed
from grader.exercise.cases import RunCase
from grader.exercise.check import Checks
from grader.exercise.draws import Draw, draw
from grader.exercise.policies import LatePolicy
from grader.exercise.verdict import Visible
from grader.recording.recording import Drawn
from grader.recording.subject import Endpoint, Role, Start
from grader.scenes.scene import Limits, Scene
from grader.scenes.subject import Subject, load_subject
from grader.system.strict_json import not_negative
from grader.text.message import NOTHING, Message

#: Keys of an exercise.yaml: whether setup.py and launch files are evaluated beside the run ...
INSPECTS = "looks_at_package"
#: ... what examines packages besides ...
INSPECTIONS = "inspections"
#: ... how much processor time a whole grading may take [s] ...
CPU = "cpu_s"
#: ... and, of `varied_runs`, whether they start elsewhere for each student.
PER_STUDENT = "per_student"


#: A turtle that drives so many times as fast crosses the window in a tick or two.
MOST_FACTOR = 100


def _a_range(ends: tuple[float, float]) -> tuple[float, float]:
    if not 0 < ends[0] <= ends[1] <= MOST_FACTOR:
        raise ValueError(f"expected two numbers above 0, the lower first, found {list(ends)}")
    return ends


Range = Annotated[tuple[float, float], _a_range]

#: The package around a starter that is a program, and what stands in its files for names.
_AROUND = Path(__file__).with_name("starter")
_PACKAGE, _PROGRAM, _EXERCISE = "my_solution", "my_node", "my_exercise"
_RCLPY = "  <exec_depend>rclpy</exec_depend>\n"
_NAME = re.compile(r"<name>\s*([\w-]+)\s*</name>")


@dataclass(frozen=True)
class Variation:
    """How a varied run differs from the nominal one besides its place; drawn by the seed.

    Attributes:
        start: whether it begins elsewhere, or in the same place as the nominal run.
        speed, turn: the ranges of the factors of `Start`.
    """

    start: Literal["elsewhere", "same"] = "elsewhere"
    speed: Range = (1.0, 1.0)
    turn: Range = (1.0, 1.0)


@dataclass(frozen=True)
class VariedRuns:
    """Further runs that start elsewhere: how many, and how far from the centre [m].

    Attributes:
        per_student: whether they start elsewhere for each student of a class.
        runs: how each differs besides, in order; further runs are driven as commanded, and what is
            said of runs beyond `count` is not used.
    """

    count: Annotated[int, not_negative] = 0
    seed: Annotated[int, not_negative] = 0
    nearest_m: Annotated[float, not_negative] = 0.0
    farthest_m: Annotated[float, not_negative] = 0.0
    per_student: bool = False
    runs: tuple[Variation, ...] = ()


@dataclass(frozen=True)
class Exercise:
    """The task of an exercise, its checks and their points.

    Attributes:
        name: as in `--exercise` and in a result.
        title: for students; like the task a message, which may have other languages.
        task: what is to be done, in Markdown; '' where the title is enough.
        limits: when a run ends; `NO_LIMITS` where nothing is started.
        varied: further runs that start elsewhere.
        cpu_s: limit of the processor time of a whole grading [s]: what it has reached by then is
            judged. Without one there are only the limits of each run and each step.
        points: check name -> points, in the order of the report.
        tolerances: parameters of the checks, which give them their names.
        checks: the exercise's check functions.
        visible: check name -> what students see of it; everything for those that are not named.
        late: what a late submission costs; None for nothing.
        fits: patterns of names of files that a hand-in without a program has where it is plainly
            for this one.
        explained: language -> tolerance -> what it is, for the sheet.
        scene: the name of what runs beside the submission.
        interfaces: a type that it brings along, 'my_interfaces/msg/Num' -> its definition.
        setting: the text of the file that it is set up with; '' for none.
        cases: what plays beside a program in the nominal run, and in further ones.
        draws: the values that are drawn anew for each of these.
        allowed: what of its scene a program may use; None for everything.
        is_to_end: whether a program is to end by itself.
        looks_at_package: whether the package around what is started is inspected as well.
        inspections: the names of the inspectors that examine packages.
        programs: those to start where a submission has them; none for the usual one.
        folder: where its files are.
        starter: the folder that `grader new` copies, or a program around which it makes a package;
            None where there is none.
        sha256: of all that a verdict depends on: the values of exercise.yaml that are in force,
            the setting, and the Python files beside it.
    """

    name: str
    title: Message
    limits: Limits
    varied: VariedRuns
    points: Mapping[str, float]
    tolerances: Mapping[str, Any]
    checks: Checks
    scene: str = "turtlesim"
    setting: str = ""
    looks_at_package: bool = False
    inspections: tuple[str, ...] = ()
    cpu_s: float = math.inf
    programs: tuple[str, ...] = ()
    folder: Path = Path()
    starter: Path | None = None
    sha256: str = ""
    task: Message = NOTHING
    visible: Mapping[str, Visible] = field(default_factory=dict)
    late: LatePolicy | None = None
    explained: Mapping[str, Mapping[str, str]] = field(default_factory=dict)
    fits: tuple[str, ...] = ()
    interfaces: Mapping[str, str] = field(default_factory=dict)
    cases: tuple[RunCase, ...] = (RunCase(),)
    draws: Mapping[str, Draw] = field(default_factory=dict)
    allowed: Allowed | None = None
    is_to_end: bool = False

    @property
    def subject(self) -> Subject:
        """The scene that runs beside a submission, or the subject `package`."""
        return load_subject(self.scene)

    @property
    def peers_have(self) -> Mapping[str, tuple[Endpoint, ...]]:
        """What of the scripted peers a program may meet in each case, by its name."""
        return {case.name: case.endpoints for case in self.cases}

    @property
    def is_started(self) -> bool:
        """Whether a submission is started; else it is only inspected."""
        return isinstance(self.subject, Scene)

    @property
    def roles(self) -> set[Role]:
        """What programs have on the graph for its peers and checks."""
        return set[Role]().union(*(case.roles for case in self.cases))

    @property
    def opening(self) -> dict[str, Any]:
        """The arguments of `grader.run.opening.open_submission` for it."""
        found = {}
        if self.starter is not None and self.starter.suffix == ".py":
            found["name"] = self.starter.stem
        elif self.roles:  # it is about any node, not about the challenge's
            found["name"] = ""
        return {
            **found,
            "roles": tuple(sorted(self.roles)),
            "is_started": self.is_started,
            "programs": self.programs,
            "inspections": self.inspections if self.looks_at_package else None,
            "cpu_s": self.cpu_s,
            "interfaces": self.interfaces,
        }

    @property
    def conditions(self) -> dict[str, float]:
        """The values that decide a run: a recording that was made with others keeps them."""
        if not self.is_started:
            return {}
        varied = asdict(self.varied)
        for number, run in enumerate(varied.pop("runs")[: self.varied.count], 1):
            varied[f"{number}.same"] = float(run["start"] == "same")
            for key in ("speed", "turn"):
                varied[f"{number}.{key}_from"], varied[f"{number}.{key}_to"] = run[key]
        parts = {"limits": asdict(self.limits), "varied_runs": varied}
        if parts["varied_runs"].pop(PER_STUDENT):
            parts["varied_runs"][PER_STUDENT] = 1
        inspects = {INSPECTS: 1.0} if self.looks_at_package else {}
        each = {f"{part}.{key}": v for part, values in parts.items() for key, v in values.items()}
        return {**each, **inspects}

    @property
    def max_score(self) -> float:
        """The sum of all points."""
        return round(sum(self.points.values()), 2)

    def starter_files(self, package: str = "") -> dict[str, bytes]:
        """Return the files of the starter by their paths; of a program with a package around it.

        Args:
            package: the name of the package, in files and their names; '' leaves it.

        Raises:
            OSError: one of them cannot be read.
            ExerciseError: it is a program that does not parse.
        """
        if self.starter is None:
            return {}
        names = {}
        if self.starter.is_dir():
            texts = _texts_below(self.starter)
        else:
            program = self.starter.read_text(encoding="utf-8")
            texts = _texts_below(_AROUND)
            depends = _depends(program, self.starter)
            texts["package.xml"] = texts["package.xml"].replace(_RCLPY, depends)
            texts[f"{_PACKAGE}/{_PROGRAM}.py"] = program
            names = {_PROGRAM: self.starter.stem, _EXERCISE: self.name}
        if package and (found := _NAME.search(texts.get("package.xml", ""))):
            names[found[1]] = package
        for before, name in names.items():
            word = re.compile(rf"\b{re.escape(before)}\b")
            texts = {word.sub(name, path): word.sub(name, text) for path, text in texts.items()}
        return {path: text.encode("utf-8", "surrogateescape") for path, text in texts.items()}

    @property
    def starter_package(self) -> str:
        """The name of the package that the starter is; '' where it is none."""
        found = _NAME.search(self.starter_files().get("package.xml", b"").decode(errors="replace"))
        return found[1] if found else ""

    def seed_for(self, student_id: str, secret: str = "") -> int | None:
        """Return the seed of a student's varied runs; None: that of the exercise.

        It depends on the exercise's seed, or the secret, and the student's id alone: it is the same
        each time, on any machine, however a file system writes the letters of the id.

        Args:
            secret: of a course; then each student has a seed of his own that nobody can guess.
        """
        if not secret and not self.varied.per_student:
            return None
        known = f"{self.name} {secret}" if secret else str(self.varied.seed)
        text = f"{known} {unicodedata.normalize('NFC', student_id)}"
        digest = hashlib.sha256(text.encode("utf-8", "surrogatepass")).digest()
        return int.from_bytes(digest[: 6 if secret else 4], "big")

    @property
    def has_chance(self) -> bool:
        """Whether its runs depend on a seed."""
        return bool(self.varied.count or self.draws)

    def drawn_cases(self, seed: int | None = None) -> list[tuple[RunCase, Drawn]]:
        """Return the case of each run with what was drawn for it; see `starts`."""
        used = self.varied.seed if seed is None else seed
        drawn = [draw(self.draws, used, number) for number in range(len(self.cases))]
        return [(case.with_drawn(d), d) for case, d in zip(self.cases, drawn, strict=True)]

    def starts(self, seed: int | None = None) -> list[Start]:
        """Return how the varied runs start; None uses the exercise's seed. See `seed_for`."""
        varied = self.varied
        used = varied.seed if seed is None else seed
        subject = self.subject
        if not isinstance(subject, Scene):
            return []
        starts = subject.starts(varied.count, used, varied.nearest_m, varied.farthest_m)
        chance = random.Random(f"factors {used}")
        for number, run in enumerate(varied.runs[: varied.count]):
            factors = {
                "speed": round(chance.uniform(*run.speed), 2),
                "turn": round(chance.uniform(*run.turn), 2),
            }
            usual = subject.usual_start if run.start == "same" else None
            starts[number] = replace(usual or starts[number], **factors)
        return starts


def _texts_below(folder: Path) -> dict[str, str]:
    """Return the files in a folder by their paths; what is no text can be written as it was."""
    texts = {}
    for path in sorted(folder.rglob("*")):
        if path.is_dir() or "__pycache__" in path.parts:
            continue
        if not path.is_file():
            raise OSError(errno.EINVAL, "not a regular file", str(path))
        text = path.read_bytes().decode("utf-8", "surrogateescape")
        texts[path.relative_to(folder).as_posix()] = text
    return texts


def _depends(program: str, path: Path) -> str:
    """Return the elements of a package.xml that name what a program imports."""
    found = {"rclpy"}
    try:
        tree = ast.parse(program)
    except (SyntaxError, ValueError) as error:
        raise ExerciseError(
            "{starter} does not parse: {why}", starter=str(path), why=str(error)
        ) from None
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            found.update(alias.name.partition(".")[0] for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module:
            found.add(node.module.partition(".")[0])
    names = sorted(found - sys.stdlib_module_names)
    return "".join(_RCLPY.replace("rclpy", name) for name in names)
