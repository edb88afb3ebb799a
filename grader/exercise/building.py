"""An exercise of the values of an exercise.yaml: each part is looked at, and refused by its key.

All functions here raise a `Mistake` where a value cannot be used.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import replace
from importlib.resources import files
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from grader import content
from grader.errors import ExerciseError
from grader.exercise import handing_in, places, translated
from grader.exercise.check import Checks
from grader.exercise.exercise import CPU, LOOKS, PER_STUDENT, Exercise, VariedRuns
from grader.exercise.places import DESCRIPTION, Place
from grader.exercise.yaml_file import Mistake, did_you_mean, is_amount
from grader.language.phrase import authored, say
from grader.scenes import NAMES as SCENES
from grader.scenes import load_scene
from grader.scenes.scene import Limits, Scene

#: Where nothing is started, no time passes that could be limited.
NO_LIMITS = Limits(0.0, 0.0, 0.0)
LIMITS = ("first_motion_s", "rest_s", "total_s")
#: Each is a whole run of every submission.
MOST_RUNS = 100
#: What of the keys is for people and judges nothing.
WORDS = ("title", "task", "starter", translated.PART)
SETTING = "setting"
VARIED = {"count": 0, "seed": 0, "nearest_m": 0.0, "farthest_m": 0.0}
#: Of an exercise, a program, a package.
NAME = re.compile(r"[A-Za-z0-9_][\w.-]*")


def build(data: dict[str, Any], place: Place) -> Exercise:
    """What the values of an exercise.yaml describe, with the checks beside it."""
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
        cpu_s=_cpu_s(data.get(CPU)),
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
    if not isinstance(given, str) or (given and not NAME.fullmatch(given)):
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


def _cpu_s(given: object) -> float:
    if given is None:
        return math.inf
    if not is_amount(given) or not given:
        raise Mistake((CPU,), say("expected a number above 0, found {given}", given=repr(given)))
    return float(given)  # type: ignore[arg-type]


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
        raise Mistake(("points",), say("all are 0"))
    return {check: float(value) for check, value in points.items()}
