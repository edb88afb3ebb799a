"""An exercise: its exercise.yaml read, merged with an edited copy, checked, and its checks beside.

Where it is read from, and its checks.py, is told by `grader.exercise.places`.
"""

from __future__ import annotations

import hashlib
import os
import re
import unicodedata
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, replace
from importlib.resources import files
from importlib.util import find_spec
from pathlib import Path
from typing import Any, TypedDict

from grader import content
from grader.errors import ExerciseError
from grader.exercise import DEFAULT, handing_in, places, translated
from grader.exercise.check import Checks
from grader.exercise.late import LatePolicy
from grader.exercise.places import CHECKS, DESCRIPTION, Place, names
from grader.exercise.verdict import Visible
from grader.exercise.yaml_file import Mistake, YamlFile, did_you_mean, is_amount, read_yaml
from grader.language.phrase import authored, say
from grader.scenes import NAMES as SCENES
from grader.scenes import load_scene
from grader.scenes.scene import Limits, Scene, Start

SUFFIXES = (".yaml", ".yml")
KEYS = (
    *("exercise", "title", "task", "scene", "setting", "limits", "varied_runs", "looks_at_package"),
    *("points", "visible", "late", "tolerances", "starter", "program", translated.PART),
)
#: Where nothing is started, no time passes that could be limited.
NO_LIMITS = Limits(0.0, 0.0, 0.0)
LIMITS = ("first_motion_s", "rest_s", "total_s")
#: Each is a whole run of every submission.
MOST_RUNS = 100
#: Whether setup.py and launch files are evaluated beside the run.
LOOKS = "looks_at_package"
#: What of them is for people and judges nothing.
WORDS = ("title", "task", "starter", translated.PART)
SETTING = "setting"
VARIED = {"count": 0, "seed": 0, "nearest_m": 0.0, "farthest_m": 0.0}
PER_STUDENT = "per_student"
_NAME = re.compile(r"[A-Za-z0-9_][\w.-]*")

__all__ = ["DEFAULT", "Exercise", "Limits", "VariedRuns", "load_exercise", "names"]


class Opening(TypedDict, total=False):
    """Arguments of `grader.submission.opening.open_submission`."""

    is_started: bool
    usual: str


@dataclass(frozen=True)
class VariedRuns:
    """Further runs that start elsewhere: how many, and how far from the centre [m].

    Attributes:
        per_student: whether they start elsewhere for each student of a class.
    """

    count: int = 0
    seed: int = 0
    nearest_m: float = 0.0
    farthest_m: float = 0.0
    per_student: bool = False


@dataclass(frozen=True)
class Exercise:
    """What is asked and how it is weighed.

    Attributes:
        name: as `--exercise` takes it, and as a result names it.
        title: what a student reads; as the task a phrase, which may have words of other languages.
        task: what is to be done, in Markdown; '' where the title says it all.
        limits: when a run ends; `NO_LIMITS` where nothing is started.
        varied: further runs that start elsewhere.
        points: check name -> points, in the order of the report.
        tolerances: what the checks may read; their names are the checks' own business.
        checks: the exercise's check functions.
        visible: check name -> what students see of it; all of those that are not named.
        late: what it costs to hand in late; None where nothing is said of that.
        explained: tolerance -> language -> what it is, for the sheet.
        scene: the name of what runs beside the submission.
        setting: the text of the file that it is set up with; '' for none.
        looks_at_package: whether the package around what is started is looked at as well.
        program: what is started of several that were handed in; '' for the usual one.
        folder: where its files are.
        starter: the folder that `grader new` copies; None where there is none.
        sha256: of all that it judges by: the values of exercise.yaml, as they are in force, the
            setting, and the Python files beside it.
    """

    name: str
    title: str
    limits: Limits
    varied: VariedRuns
    points: Mapping[str, float]
    tolerances: Mapping[str, Any]
    checks: Checks
    scene: str = "turtlesim"
    setting: str = ""
    looks_at_package: bool = False
    program: str = ""
    folder: Path = Path()
    starter: Path | None = None
    sha256: str = ""
    task: str = ""
    visible: Mapping[str, Visible] = field(default_factory=dict)
    late: LatePolicy | None = None
    explained: Mapping[str, Mapping[str, str]] = field(default_factory=dict)

    @property
    def is_started(self) -> bool:
        """Whether something of a submission is started; else it is only looked at."""
        return not load_scene(self.scene).examiner

    @property
    def opening(self) -> Opening:
        """How a submission to it is opened."""
        opening: Opening = {"is_started": self.is_started}
        if self.program:
            opening["usual"] = self.program
        return opening

    @property
    def conditions(self) -> dict[str, float]:
        """What only a run can follow: a recording that was made with other values keeps them."""
        if not self.is_started:
            return {}
        parts = {"limits": asdict(self.limits), "varied_runs": asdict(self.varied)}
        if parts["varied_runs"].pop(PER_STUDENT):
            parts["varied_runs"][PER_STUDENT] = 1
        looks = {LOOKS: 1.0} if self.looks_at_package else {}
        each = {f"{part}.{key}": v for part, values in parts.items() for key, v in values.items()}
        return {**each, **looks}

    @property
    def max_score(self) -> float:
        """The sum of all points."""
        return round(sum(self.points.values()), 2)

    def seed_for(self, student_id: str) -> int | None:
        """What chooses where a student's varied runs start; None: they start as everybody's.

        It is made of the exercise's own seed and the student's id, and of nothing else: the same
        each time, on any machine, however a file system writes the letters of the id.
        """
        if not self.varied.per_student:
            return None
        told = f"{self.varied.seed} {unicodedata.normalize('NFC', student_id)}"
        digest = hashlib.sha256(told.encode("utf-8", "surrogatepass")).digest()
        return int.from_bytes(digest[:4], "big")

    def starts(self, seed: int | None = None) -> list[Start]:
        """Where the varied runs start; None takes the exercise's own seed. See `seed_for`."""
        varied = self.varied
        used = varied.seed if seed is None else seed
        scene = load_scene(self.scene)
        return scene.starts(varied.count, used, varied.nearest_m, varied.farthest_m)


def load_exercise(name_or_path: str | os.PathLike[str]) -> Exercise:
    """Load an exercise.

    Args:
        name_or_path: the name of an installed one; else a folder with exercise.yaml and checks.py;
            or a file *.yaml: an edited copy of the exercise.yaml that it names, which is the one
            of its own folder or an installed one. What an edited copy leaves out of `limits` and
            `tolerances` stays as it is in the original.

    Raises:
        ExerciseError: there is no such exercise, or something in it is wrong; with file and line.
    """
    try:
        return _load(name_or_path)
    except PermissionError as error:
        raise ExerciseError(
            say(
                "cannot read the exercise {name_or_path}: {strerror}: {filename}",
                name_or_path=repr(str(name_or_path)),
                strerror=error.strerror,
                filename=error.filename,
            )
        ) from None


def _load(name_or_path: str | os.PathLike[str]) -> Exercise:
    path = Path(name_or_path)
    if path.suffix in SUFFIXES:
        return _from_file(path)
    if isinstance(name_or_path, str) and places.is_installed(name_or_path):
        return _from_place(places.installed(name_or_path))
    if path.is_dir():
        return _from_place(places.in_folder(path))
    raise ExerciseError(
        say(
            "there is no exercise {name_or_path}; there are: {names}. Another one"
            " is given as the path of its folder, with {description} and {checks}; "
            "an edited copy as the path of its {description}.",
            name_or_path=repr(str(name_or_path)),
            names=", ".join(names()),
            description=DESCRIPTION,
            checks=CHECKS,
        )
    )


def _from_place(place: Place) -> Exercise:
    try:
        file = _read(place.description)
        try:
            return _build(_described(file, place), place)
        except Mistake as mistake:
            raise ExerciseError(file.told(mistake)) from mistake
    except OSError as error:
        raise ExerciseError(
            say(
                "cannot read {description}: {strerror}",
                description=str(place.description),
                strerror=error.strerror,
            )
        ) from None
    except (ExerciseError, ValueError) as error:
        raise ExerciseError(
            say("{path} is not an exercise: {why}", path=str(place.folder), why=_why(error))
        ) from error


def _why(error: Exception) -> str:
    return error.message if isinstance(error, ExerciseError) else str(error)


def _from_file(path: Path) -> Exercise:
    if path.name == DESCRIPTION and (path.parent / CHECKS).is_file() and path.is_file():
        return _from_place(places.in_folder(path.parent))
    try:
        edited = _read(path)
        try:
            _check_keys(edited.data)
            place, original = _original(edited.data.get("exercise"), path.parent)
            return _build(_merged(original, edited.data), place)
        except Mistake as mistake:
            raise ExerciseError(edited.told(mistake)) from mistake
    except OSError as error:
        raise ExerciseError(
            say(
                "cannot read the exercise {path}: {strerror}",
                path=str(path),
                strerror=error.strerror,
            )
        ) from None
    except (ExerciseError, ValueError) as error:
        raise ExerciseError(
            say("{path} is not an exercise: {why}", path=str(path), why=_why(error))
        ) from error


def _original(name: object, folder: Path) -> tuple[Place, dict[str, Any]]:
    """What an edited copy in a folder is a copy of."""
    if all((folder / file).is_file() for file in (DESCRIPTION, CHECKS)):
        beside = places.in_folder(folder)
        file = _read(beside.description)
        try:
            described = _described(file, beside)
        except Mistake as mistake:  # of another file than the one that is being read
            raise ExerciseError(file.told(mistake)) from mistake
        if described["exercise"] == name:
            return beside, described
    if not isinstance(name, str) or name not in names():
        raise Mistake(
            ("exercise",),
            say(
                "expected one of {names}, found {name}. An edited copy of an exercise"
                " that is not installed must lie in that exercise's own folder",
                names=", ".join(names()),
                name=repr(name),
            ),
        )
    place = places.installed(name)
    return place, _described(_read(place.description), place)


def _described(file: YamlFile, place: Place) -> dict[str, Any]:
    """The exercise.yaml of an exercise, which must be whole."""
    data: dict[str, Any] = file.data
    for key in ("exercise", "title", "points"):
        if key not in data:
            raise Mistake((), say("it has no {key}", key=repr(key)))
    _check_keys(data)
    name = data["exercise"]
    if not isinstance(name, str) or not _NAME.fullmatch(name):
        raise Mistake(
            ("exercise",), say("expected a name such as my_exercise, found {name}", name=repr(name))
        )
    if place.name and name != place.name:
        raise Mistake(
            ("exercise",),
            say(
                "it is installed as {name}, and calls itself {own_name}",
                name=repr(place.name),
                own_name=repr(name),
            ),
        )
    if not place.name and name in names():
        raise Mistake(
            ("exercise",),
            say("{name} is the name of an installed exercise; give yours another", name=repr(name)),
        )
    return data


def _check_keys(data: Mapping[Any, Any]) -> None:
    for key in data:
        if key not in KEYS:
            raise Mistake((str(key),), say("unknown; {hint}", hint=did_you_mean(key, KEYS)))


def _read(path: Path) -> YamlFile:
    file = read_yaml(path)
    if not isinstance(file.data, dict):
        raise ExerciseError(
            say("{name}: expected keys such as exercise, limits, points", name=file.name)
        )
    return file


def _merged(original: dict[str, Any], edited: dict[str, Any]) -> dict[str, Any]:
    """The original with what was edited; every key must exist there, with a like value."""
    merged = {**original, **edited}
    for part in ("limits", "tolerances", "varied_runs"):
        known, given = original.get(part) or {}, edited.get(part, {})
        if not isinstance(given, dict):
            raise Mistake(
                (part,), say("expected names with numbers, found {given}", given=repr(given))
            )
        for key, value in given.items():
            if part == "varied_runs" and key == PER_STUDENT:
                continue  # a switch, which no original has to have
            if key not in known:
                raise Mistake(
                    (part,),
                    say(
                        "unknown {key}; {hint}",
                        key=repr(key),
                        hint=did_you_mean(key, known),
                    ),
                )
            if not _alike(value, known[key]):
                raise Mistake(
                    (part, key),
                    say(
                        "expected e.g. {known}, found {value}",
                        known=repr(known[key]),
                        value=repr(value),
                    ),
                )
        merged[part] = {**known, **given}
    if translated.PART in original and translated.PART not in edited:
        anew = [key for key in ("title", "task") if merged.get(key) != original.get(key)]
        merged[translated.PART] = translated.without(original[translated.PART], anew)
    return merged


def _alike(value: object, example: object) -> bool:
    if isinstance(example, list):
        return isinstance(value, list) and all(_alike(v, example[0]) for v in value)
    if isinstance(example, bool) or not isinstance(example, int | float):
        return type(value) is type(example)
    return is_amount(value)


def _build(data: dict[str, Any], place: Place) -> Exercise:
    scene = data.get("scene", "turtlesim")
    if scene not in SCENES:
        raise Mistake(
            ("scene",),
            say(
                "expected one of {scenes}, found {scene}",
                scenes=", ".join(SCENES),
                scene=repr(scene),
            ),
        )
    setting = _setting(data.get("setting"), load_scene(scene), place)
    limits = _limits(data) if not load_scene(scene).examiner else _without_clock(data, scene)
    varied = _varied(data)
    _check_varied(varied, load_scene(scene).farthest_start_m)
    tolerances = data.get("tolerances") or {}
    if not isinstance(tolerances, dict):
        raise Mistake(
            ("tolerances",),
            say("expected names with values, found {tolerances}", tolerances=repr(tolerances)),
        )
    checks = places.import_checks(place)
    wrong = checks.wrong_tolerance(tolerances)
    if wrong is not None:
        raise Mistake(("tolerances", wrong[0]), wrong[1])
    points = _points(data["points"], checks)
    words = translated.translated(data.get(translated.PART), checks, tolerances)
    checks = checks.said(words.titles, words.rubrics)
    exercise = Exercise(
        name=data["exercise"],
        title=authored(str(data["title"]), words.title),
        limits=limits,
        varied=varied,
        points=points,
        tolerances=tolerances,
        checks=checks,
        scene=scene,
        setting=setting,
        looks_at_package=_looks(data.get(LOOKS, False), scene),
        program=_program(data.get("program", "")),
        folder=place.folder,
        starter=_starter(data.get("starter"), place),
        sha256=_sha256(data, setting, place.folder),
        task=authored(_task(data.get("task", "")), words.task),
        visible=handing_in.visible(data.get("visible"), checks, points),
        explained=words.tolerances,
    )
    return replace(exercise, late=handing_in.late(data.get("late"), exercise.max_score))


def _limits(data: Mapping[str, Any]) -> Limits:
    if "limits" not in data:
        raise Mistake((), say("it has no 'limits'"))
    limits = _numbers(data, "limits", dict.fromkeys(LIMITS, 1.0))
    missing = [key for key in LIMITS if key not in limits]
    if missing:
        raise Mistake(
            ("limits",),
            say(
                "{missing} is missing; there must be {limits}",
                missing=missing[0],
                limits=", ".join(LIMITS),
            ),
        )
    for key in ("first_motion_s", "total_s"):
        if not limits[key]:
            raise Mistake(("limits", key), say("expected a number above 0, found 0"))
    return Limits(**{key: float(value) for key, value in limits.items()})


def _without_clock(data: Mapping[str, Any], scene: str) -> Limits:
    for part in ("limits", "varied_runs"):
        if data.get(part):
            raise Mistake(
                (part,),
                say("nothing is started in the scene {scene}: leave it out", scene=repr(scene)),
            )
    return NO_LIMITS


def _sha256(data: Mapping[str, Any], setting: str, folder: Path) -> str:
    """The hash of an exercise: comments do not count, and a copy without edits has the same."""
    judging = {key: value for key, value in data.items() if key not in WORDS}
    values = repr(judging).encode("utf-8", "surrogatepass")  # whatever YAML can hold; in its order
    packages = (folder, *(file.parent for file in folder.glob("*/__init__.py")))
    files = [path for package in packages for path in package.glob("*.py") if path.is_file()]
    code = {path.relative_to(folder).as_posix(): content.of_file(path) for path in files}
    if setting:
        code[SETTING] = content.of_bytes(setting.encode())
    return content.of_files({**code, DESCRIPTION: content.of_bytes(values)})


def _setting(where: object, scene: Scene, place: Place) -> str:
    """The text of the file that a scene is set up with."""
    if where is not None and not isinstance(where, str):
        raise Mistake(
            (SETTING,),
            say(
                "expected a file beside {description}, found {where}",
                description=DESCRIPTION,
                where=repr(where),
            ),
        )
    setting = ""
    if where is not None:
        try:
            setting = (place.folder / where).read_text(encoding="utf-8")
        except (OSError, ValueError) as error:
            raise Mistake(
                (SETTING,), say("cannot read {where}: {error}", where=where, error=str(error))
            ) from None
    if why := scene.wrong_setting(setting):
        raise Mistake((SETTING,), why)
    return setting


def _program(given: object) -> str:
    if not isinstance(given, str) or (given and not _NAME.fullmatch(given)):
        raise Mistake(
            ("program",),
            say("expected the name of a console script, found {given}", given=repr(given)),
        )
    return given


def _looks(given: object, scene: str) -> bool:
    if not isinstance(given, bool):
        raise Mistake((LOOKS,), say("expected true or false, found {given}", given=repr(given)))
    if given and load_scene(scene).examiner:
        raise Mistake(
            (LOOKS,), say("the scene {scene} does nothing else: leave it out", scene=repr(scene))
        )
    return given


def _task(task: object) -> str:
    if not isinstance(task, str):
        raise Mistake(("task",), say("expected a text, found {task}", task=repr(task)))
    return task


def _varied(data: Mapping[str, Any]) -> VariedRuns:
    part = "varied_runs"
    given = data.get(part) or {}
    if not isinstance(given, dict) or PER_STUDENT not in given:
        return VariedRuns(**_numbers(data, part, VARIED))
    numbers = {key: value for key, value in given.items() if key != PER_STUDENT}
    if not isinstance(given[PER_STUDENT], bool):
        text = say("expected true or false, found {given}", given=repr(given[PER_STUDENT]))
        raise Mistake((part, PER_STUDENT), text)
    varied = VariedRuns(**_numbers({part: numbers}, part, VARIED))
    return replace(varied, per_student=given[PER_STUDENT])


def _check_varied(varied: VariedRuns, farthest_m: float) -> None:
    """Refuse what gives runs that nobody can mean.

    Args:
        farthest_m: so far from the centre something can start in the scene.
    """
    part = "varied_runs"
    if varied.count > MOST_RUNS:
        raise Mistake(
            (part, "count"),
            say(
                "expected at most {most}, found {count}",
                most=MOST_RUNS,
                count=varied.count,
            ),
        )
    if varied.farthest_m > farthest_m:
        text = say(
            "expected at most {farthest_m:g}: there are walls; found {found_m:g}",
            farthest_m=farthest_m,
            found_m=varied.farthest_m,
        )
        raise Mistake((part, "farthest_m"), text)
    if varied.nearest_m > varied.farthest_m:
        text = say(
            "expected at most farthest_m, {farthest_m:g}; found {nearest_m:g}",
            farthest_m=varied.farthest_m,
            nearest_m=varied.nearest_m,
        )
        raise Mistake((part, "nearest_m"), text)


def _numbers(data: Mapping[str, Any], part: str, examples: Mapping[str, float]) -> dict[str, Any]:
    """A part of an exercise.yaml that holds numbers; whole ones where the example is whole."""
    given = data.get(part) or {}
    if not isinstance(given, dict):
        raise Mistake((part,), say("expected names with numbers, found {given}", given=repr(given)))
    for key, value in given.items():
        if key not in examples:
            raise Mistake(
                (part,),
                say(
                    "unknown {key}; {hint}",
                    key=repr(key),
                    hint=did_you_mean(key, examples),
                ),
            )
        if not is_amount(value) or (isinstance(examples[key], int) and value != int(value)):
            is_whole = isinstance(examples[key], int)
            what = say("a whole number") if is_whole else say("a number")
            raise Mistake(
                (part, key),
                say("expected {what} from 0, found {value}", what=what, value=repr(value)),
            )
    return {k: int(v) if isinstance(examples[k], int) else v for k, v in given.items()}


def _starter(where: object, place: Place) -> Path | None:
    if where is None:
        return None
    try:
        folder = places.locate(place.folder, str(where))
    except ExerciseError as error:
        raise Mistake(("starter",), error.message) from None
    if not folder.is_dir():
        raise Mistake(("starter",), say("expected a folder, found {folder}", folder=str(folder)))
    real = folder.resolve()
    package = str(where).partition("/")[0]
    roots = [place.folder]
    if package.isidentifier() and find_spec(package) is not None:
        roots.append(Path(str(files(package))))
    if not any(root.resolve() in (real, *real.parents) for root in roots) or real == roots[0]:
        raise Mistake(
            ("starter",),
            say(
                "expected a folder inside {folder}, or PACKAGE/FOLDER inside an "
                "installed package, found {where}, which is {real}",
                folder=str(place.folder),
                where=repr(where),
                real=str(real),
            ),
        )
    return folder


def _points(points: object, checks: Checks) -> dict[str, float]:
    if not isinstance(points, dict) or not points:
        raise Mistake(("points",), say("expected check names with points"))
    known = [check.name for check in checks]
    for check, value in points.items():
        if check not in known:
            text = say(
                "no check is named {check}; {hint}",
                check=repr(check),
                hint=did_you_mean(check, known),
            )
            raise Mistake(("points",), text)
        if not is_amount(value):
            raise Mistake(
                ("points", str(check)),
                say("expected a number from 0, found {value}", value=repr(value)),
            )
    if not any(points.values()):
        raise Mistake(("points",), "all are 0")
    return {check: float(value) for check, value in points.items()}
