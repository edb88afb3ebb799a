"""Builds an exercise from the values of an exercise.yaml, each of which is checked.

All functions here raise a `Mistake`, which names the key, where a value cannot be used.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from importlib.resources import files
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from grader.errors import ExerciseError
from grader.exercise import places, policies
from grader.exercise.cases import RunCase, read_cases
from grader.exercise.check import Checks
from grader.exercise.exercise import (
    CPU,
    INSPECTIONS,
    INSPECTS,
    PER_STUDENT,
    Exercise,
    Variation,
    VariedRuns,
)
from grader.exercise.places import DESCRIPTION, Place
from grader.recording.recording import MOST_PROGRAMS
from grader.recording.subject import DEFAULT_SCENE, Subject, load_subject
from grader.scenes.scene import Limits, Scene
from grader.system import content, extensions
from grader.system.extensions import SCENES
from grader.system.yaml_file import Mistake, check_known, expect, is_amount
from grader.text.message import authored, msg

#: Where nothing is started, no time passes that could be limited.
NO_LIMITS = Limits(0.0, 0.0, 0.0)
LIMITS = ("first_motion_s", "rest_s", "total_s")
#: Each is a whole run of every submission.
MOST_RUNS = 100
#: Says which hand-ins that name no exercise are for this one.
FITS = "fits"
#: Keys that are for people and judge nothing.
WORDS = ("title", "task", "starter", FITS)
SETTING = "setting"
#: It is sent from process to process [characters].
LONGEST_SETTING = 50_000
INTERFACES = "interfaces"
#: As JSON, in an argument of each process [characters].
LONGEST_INTERFACES = 40_000
#: What is expected of what is exchanged: each is a check.
EXPECT = "expect"
RUNS = "runs"
#: A turtle that drives so many times as fast crosses the window in a tick or two.
MOST_FACTOR = 100
VARIED = {"count": 0, "seed": 0, "nearest_m": 0.0, "farthest_m": 0.0}
#: Of an exercise, a program, a package.
NAME = re.compile(r"[A-Za-z0-9_][\w.-]*")
#: A program's name, or a pattern of it: '*talker*'.
_PROGRAM = re.compile(r"[A-Za-z0-9_*][\w.*-]*")


def build(data: dict[str, Any], place: Place) -> Exercise:
    """Build an exercise from the values of its exercise.yaml and the checks beside it."""
    scene, subject = _subject(data.get("scene", DEFAULT_SCENE))
    setting = _setting(data.get("setting"), subject, place)
    interfaces = _interfaces(data.get(INTERFACES), place)
    limits = _limits(data) if isinstance(subject, Scene) else _without_clock(data, scene)
    _check_words(data, scene, subject)
    varied = _varied(data)
    if isinstance(subject, Scene):
        _check_varied(varied, subject, scene)
    tolerances = data.get("tolerances") or {}
    is_dict = isinstance(tolerances, dict)
    expect(is_dict, ("tolerances",), "expected names with values, found {found}", tolerances)
    cases = read_cases(data, interfaces, limits.total_s, has_cast=subject.has_cast)
    checks, heard = _checks(data, place, cases, interfaces, limits.total_s)
    cases = [each.hearing(heard) for each in cases]
    wrong = checks.wrong_tolerance(tolerances)
    if wrong is not None:
        raise Mistake(("tolerances", wrong[0]), wrong[1])
    points = _points(data["points"], checks)
    return Exercise(
        name=data["exercise"],
        limits=limits,
        varied=varied,
        points=points,
        tolerances=tolerances,
        checks=checks,
        scene=scene,
        setting=setting,
        looks_at_package=data.get(INSPECTS, False),
        inspections=_inspections(data, scene, subject),
        cpu_s=_cpu_s(data.get(CPU)),
        programs=_programs(data),
        folder=place.folder,
        starter=_starter(data.get("starter"), place),
        sha256=_sha256(data, {SETTING: setting, **interfaces}, place.folder),
        visible=policies.visible(data.get("visible"), checks, points),
        late=policies.late(data.get("late"), round(sum(points.values()), 2)),
        fits=_fits(data.get(FITS) or {}),
        interfaces=interfaces,
        cases=tuple(cases),
        is_to_end=any("exits" in each for each in data.get(EXPECT, {}).values()),
        title=authored(str(data["title"])),
        task=authored(data.get("task", "")),
    )


def _subject(name: object) -> tuple[str, Subject]:
    """Load the scene that an exercise names."""
    names = extensions.points(SCENES)
    if not isinstance(name, str) or name not in names:
        raise Mistake(
            ("scene",),
            "expected one of {scenes}, found {scene}",
            scenes=", ".join(names),
            scene=repr(name),
        )
    return name, load_subject(name)


def _limits(data: Mapping[str, Any]) -> Limits:
    if "limits" not in data:
        raise Mistake((), "it has no 'limits'")
    limits = _numbers(data, "limits", dict.fromkeys(LIMITS, 1.0))
    missing = [key for key in LIMITS if key not in limits]
    if missing:
        raise Mistake(
            ("limits",),
            "{missing} is missing; there must be {limits}",
            missing=missing[0],
            limits=", ".join(LIMITS),
        )
    for key in ("first_motion_s", "total_s"):
        if not limits[key]:
            raise Mistake(("limits", key), "expected a number above 0, found 0")
    return Limits(**{key: float(value) for key, value in limits.items()})


def _without_clock(data: Mapping[str, Any], scene: str) -> Limits:
    for part in ("limits", "varied_runs"):
        if data.get(part):
            raise Mistake(
                (part,), "nothing is started in the scene {scene}: leave it out", scene=repr(scene)
            )
    return NO_LIMITS


def _sha256(data: Mapping[str, Any], texts: Mapping[str, str], folder: Path) -> str:
    """The hash of an exercise: comments do not count, and a copy without edits has the same."""
    judging = {key: value for key, value in data.items() if key not in WORDS}
    values = repr(judging).encode("utf-8", "surrogatepass")  # whatever YAML can hold; in its order
    packages = (folder, *(file.parent for file in folder.glob("*/__init__.py")))
    files = [path for package in packages for path in package.glob("*.py") if path.is_file()]
    code = {path.relative_to(folder).as_posix(): content.of_file(path) for path in files}
    code |= {name: content.of_bytes(text.encode()) for name, text in texts.items() if text}
    return content.of_files({**code, DESCRIPTION: content.of_bytes(values)})


def _setting(where: Any, subject: Subject, place: Place) -> str:
    """Read the file that a scene is set up with; '' for none."""
    is_file = where is None or isinstance(where, str)
    expect(is_file, (SETTING,), "expected a file beside exercise.yaml, found {found}", where)
    setting = ""
    if where is not None:
        try:
            setting = (place.folder / where).read_text(encoding="utf-8")
        except (OSError, ValueError) as error:
            raise Mistake(
                (SETTING,), "cannot read {where}: {error}", where=where, error=str(error)
            ) from None
    if len(setting) > LONGEST_SETTING:
        raise Mistake(
            (SETTING,),
            "expected {most} characters at most, found {count}",
            most=LONGEST_SETTING,
            count=len(setting),
        )
    if why := subject.wrong_setting(setting):
        raise Mistake((SETTING,), why)
    return setting


def _interfaces(where: Any, place: Place) -> dict[str, str]:
    """Read the definitions in a folder of packages, PACKAGE/msg/NAME.msg; {} for none."""
    if where is None:
        return {}
    files = sorted((place.folder / str(where)).glob("*/*/*"))
    texts = {
        f"{each.parts[-3]}/{each.parts[-2]}/{each.stem}": each.read_text("utf-8", "replace")
        for each in files
        if each.suffix == f".{each.parent.name}"
    }
    fits = 0 < len(json.dumps(texts)) - 2 <= LONGEST_INTERFACES
    expect(
        fits,
        (INTERFACES,),
        "expected a folder with PACKAGE/msg/NAME.msg, with {most} characters; found {found}",
        where,
        most=LONGEST_INTERFACES,
    )
    try:
        from grader.ros.definitions import Definitions  # here: most exercises have none
    except ImportError:  # without ROS recordings are judged, whose runs had these
        return texts
    for wrong in Definitions(texts).errors.values():
        raise Mistake((INTERFACES,), wrong.message)
    return texts


def _checks(
    data: Mapping[str, Any],
    place: Place,
    cases: Sequence[RunCase],
    definitions: Mapping[str, str],
    end_s: float,
) -> tuple[Checks, set[str]]:
    """Return the checks of checks.py and those of what is expected, and the topics of these."""
    if EXPECT not in data:
        return places.import_checks(place), set()
    from grader.exercise.expect.checks import add_checks  # here: most exercises have no such part
    from grader.exercise.known_types import KnownTypes

    has_own = (place.folder / places.CHECKS).is_file()
    checks = places.import_checks(place).copy() if has_own else Checks()
    return checks, add_checks(checks, data[EXPECT], cases, KnownTypes(definitions), end_s)


def _check_words(data: Mapping[str, Any], scene: str, subject: Subject) -> None:
    """Refuse a task, a program or a switch of another type."""
    task, inspects = data.get("task", ""), data.get(INSPECTS, False)
    expect(isinstance(task, str), ("task",), "expected a text, found {found}", task)
    expect(
        isinstance(inspects, bool), (INSPECTS,), "expected true or false, found {found}", inspects
    )
    if inspects and not isinstance(subject, Scene):
        raise Mistake(
            (INSPECTS,), "the scene {scene} does nothing else: leave it out", scene=repr(scene)
        )


def _programs(data: Mapping[str, Any]) -> tuple[str, ...]:
    """Read the names of the console scripts that are started together, or of the one."""
    one = data.get("program", "")
    fits = isinstance(one, str) and (not one or _PROGRAM.fullmatch(one))
    expect(fits, ("program",), "expected the name of a console script, found {found}", one)
    several = data.get("programs", [one] if one else [])
    fits = isinstance(several, list) and len({*map(str, several)}) == len(several) <= MOST_PROGRAMS
    fits = fits and all(isinstance(each, str) and _PROGRAM.fullmatch(each) for each in several)
    what = "expected names of console scripts, each once, at most {n}; found {found}"
    expect(fits, ("programs",), what, several, n=MOST_PROGRAMS)
    if one and "programs" in data:
        raise Mistake(("programs",), "there is `program` already: leave one of them out")
    return tuple(several)


def _inspections(data: Mapping[str, Any], scene: str, subject: Subject) -> tuple[str, ...]:
    """The names of the inspectors that examine packages."""
    given = data.get(INSPECTIONS, [])
    known = extensions.points(extensions.INSPECTIONS)
    is_known = isinstance(given, list) and all(isinstance(n, str) and n in known for n in given)
    what = "expected a list of some of {names}, found {found}"
    expect(is_known, (INSPECTIONS,), what, given, names=", ".join(known) or "none")
    if given and isinstance(subject, Scene) and not data.get(INSPECTS, False):
        raise Mistake((INSPECTIONS,), "no package is examined here without looks_at_package: true")
    return tuple(given)


def _cpu_s(given: Any) -> float:
    if given is None:
        return math.inf
    is_above = is_amount(given) and bool(given)
    expect(is_above, (CPU,), "expected a number above 0, found {found}", given)
    return float(given)


def _varied(data: Mapping[str, Any]) -> VariedRuns:
    part = "varied_runs"
    given = data.get(part) or {}
    if not isinstance(given, dict):
        return VariedRuns(**_numbers(data, part, VARIED))
    numbers = {key: value for key, value in given.items() if key not in (PER_STUDENT, RUNS)}
    switch = given.get(PER_STUDENT, False)
    is_one = isinstance(switch, bool)
    expect(is_one, (part, PER_STUDENT), "expected true or false, found {found}", switch)
    runs = given.get(RUNS, [])
    is_list = isinstance(runs, list) and all(isinstance(run, dict) for run in runs)
    expect(is_list, (part, RUNS), "expected a list of ranges, found {found}", runs)
    varied = VariedRuns(**_numbers({part: numbers}, part, VARIED))
    return replace(varied, per_student=switch, runs=tuple(map(_variation, runs)))


def _variation(given: Mapping[str, Any]) -> Variation:
    """Read how a varied run differs: its start, and the ranges of its factors."""
    at = ("varied_runs", RUNS)
    check_known(given, ("start", "speed", "turn"), at)
    start = given.get("start", "elsewhere")
    is_start = start in ("elsewhere", "same")
    expect(is_start, (*at, "start"), "expected elsewhere or same, found {found}", start)
    for key in given.keys() - {"start"}:
        value = given[key]
        is_range = isinstance(value, list) and len(value) == 2 and all(map(is_amount, value))
        fits = is_range and 0 < value[0] <= value[1] <= MOST_FACTOR
        what = "expected two numbers, above 0, the lower first, such as [0.8, 0.9]; found {found}"
        expect(fits, (*at, key), what, value)
    values: dict[str, Any] = {k: tuple(v) if isinstance(v, list) else v for k, v in given.items()}
    return Variation(**values)


def _check_varied(varied: VariedRuns, subject: Scene, scene: str) -> None:
    """Refuse varied runs that are too many, start outside, or vary what the scene cannot."""
    part, farthest_m = "varied_runs", subject.farthest_start_m
    if varied.runs and subject.usual_start is None:
        raise Mistake(
            (part, RUNS), "the scene {scene} cannot vary them: leave it out", scene=repr(scene)
        )
    if varied.count > MOST_RUNS:
        raise Mistake(
            (part, "count"),
            "expected at most {most}, found {count}",
            most=MOST_RUNS,
            count=varied.count,
        )
    if varied.farthest_m > farthest_m:
        raise Mistake(
            (part, "farthest_m"),
            "expected at most {farthest_m:g}, the farthest start in this scene; found {found_m:g}",
            farthest_m=farthest_m,
            found_m=varied.farthest_m,
        )
    if varied.nearest_m > varied.farthest_m:
        raise Mistake(
            (part, "nearest_m"),
            "expected at most farthest_m, {farthest_m:g}; found {nearest_m:g}",
            farthest_m=varied.farthest_m,
            nearest_m=varied.nearest_m,
        )


def _numbers(data: Mapping[str, Any], part: str, examples: Mapping[str, float]) -> dict[str, Any]:
    """A part of an exercise.yaml that holds numbers; whole ones where the example is whole."""
    given = data.get(part) or {}
    is_dict = isinstance(given, dict)
    expect(is_dict, (part,), "expected names with numbers, found {found}", given)
    check_known(given, examples, (part,))
    for key, value in given.items():
        is_whole = isinstance(examples[key], int)
        fits = is_amount(value) and (not is_whole or value == int(value))
        what = msg("a whole number") if is_whole else msg("a number")
        expect(fits, (part, key), "expected {what} from 0, found {found}", value, what=what)
    return {k: int(v) if isinstance(examples[k], int) else v for k, v in given.items()}


def _starter(where: object, place: Place) -> Path | None:
    if where is None:
        return None
    try:
        folder = places.locate(place.folder, str(where))
    except ExerciseError as error:
        raise Mistake(("starter",), error.message) from None
    if not folder.is_dir() and folder.suffix != ".py":
        what = "expected a folder or a Python file, found {folder}"
        raise Mistake(("starter",), what, folder=str(folder))
    real = folder.resolve()
    package = str(where).partition("/")[0]
    roots = [place.folder]
    if package.isidentifier() and find_spec(package) is not None:
        roots.append(Path(str(files(package))))
    if not any(root.resolve() in (real, *real.parents) for root in roots) or real == roots[0]:
        raise Mistake(
            ("starter",),
            "expected a folder inside {folder}, or PACKAGE/FOLDER inside an "
            "installed package, found {where}, which is {real}",
            folder=str(place.folder),
            where=repr(where),
            real=str(real),
        )
    return folder


def _fits(given: Any) -> tuple[str, ...]:
    expect(isinstance(given, dict), (FITS,), "expected names with lists, found {found}", given)
    check_known(given, ("files",), (FITS,))
    value = given.get("files", [])
    is_list = isinstance(value, list) and all(isinstance(each, str) for each in value)
    expect(is_list, (FITS, "files"), "expected a list of texts, found {found}", value)
    return tuple(value)


def _points(points: Any, checks: Checks) -> dict[str, float]:
    if not isinstance(points, dict) or not points:
        raise Mistake(("points",), "expected check names with points")
    check_known(points, [check.name for check in checks], ("points",), are_checks=True)
    for check, value in points.items():
        at = ("points", check)
        expect(is_amount(value), at, "expected a number from 0, found {found}", value)
    if not any(points.values()):
        raise Mistake(("points",), "all are 0")
    return {check: float(value) for check, value in points.items()}
