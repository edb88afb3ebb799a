"""Builds an exercise from the values of an exercise.yaml, each of which is checked.

All functions here raise a `Mistake`, which names the key, where a value cannot be used.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field, fields
from importlib.resources import files
from importlib.util import find_spec
from pathlib import Path
from typing import Annotated, Any

from grader.errors import ExerciseError
from grader.exercise import places, policies
from grader.exercise.allowed import read_allowed
from grader.exercise.asking import CHECKS
from grader.exercise.cases import RunCase, read_cases
from grader.exercise.check import Checks
from grader.exercise.draws import Draw, read_draws
from grader.exercise.exercise import INSPECTIONS, INSPECTS, Exercise, VariedRuns
from grader.exercise.places import DESCRIPTION, Place
from grader.exercise.policies import Amount
from grader.recording.recording import MOST_PROGRAMS
from grader.recording.subject import DEFAULT_SCENE
from grader.scenes.scene import Limits, Scene
from grader.scenes.subject import Subject, load_subject
from grader.system import content, extensions
from grader.system.extensions import SCENES
from grader.system.strict_json import above_zero
from grader.system.yaml_file import Mistake, check_known, decoded, expect
from grader.text.message import authored

#: Where nothing is started, no time passes that could be limited.
NO_LIMITS = Limits(0.0, 0.0, 0.0)
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
#: Of an exercise, a program, a package.
NAME = re.compile(r"[A-Za-z0-9_][\w.-]*")
#: A program's name, or a pattern of it: '*talker*'.
_PROGRAM = re.compile(r"[A-Za-z0-9_*][\w.*-]*")


def _a_program(name: str) -> str:
    if not _PROGRAM.fullmatch(name):
        raise ValueError(f"expected the name of a console script, found {name!r:.80}")
    return name


_Program = Annotated[str, _a_program]
_AboveZero = Annotated[float, above_zero]


@dataclass(frozen=True)
class _Limits:
    """`limits`, as `Limits` has them."""

    first_motion_s: _AboveZero
    rest_s: Amount
    total_s: _AboveZero


@dataclass(frozen=True)
class _Fits:
    """`fits`: see `Exercise`."""

    files: tuple[str, ...] = ()


@dataclass(frozen=True)
class _Plain:
    """Keys of exercise.yaml whose values an exercise has as they are; see `Exercise`.

    Attributes:
        program: the only one of `programs`.
    """

    task: str = ""
    looks_at_package: bool = False
    inspections: tuple[str, ...] = ()
    cpu_s: _AboveZero = math.inf
    program: _Program | None = None
    programs: tuple[_Program, ...] = ()
    fits: _Fits = field(default_factory=_Fits)
    varied_runs: VariedRuns = field(default_factory=VariedRuns)


def build(data: dict[str, Any], place: Place) -> Exercise:
    """Build an exercise from the values of its exercise.yaml and the checks beside it."""
    scene, subject = _subject(data.get("scene", DEFAULT_SCENE))
    setting = _setting(data.get("setting"), subject, place)
    interfaces = _interfaces(data.get(INTERFACES), place)
    named = {key.name for key in fields(_Plain)}
    given = {key: value for key, value in data.items() if key in named and value is not None}
    plain: _Plain = decoded(_Plain, given)
    limits = _limits(data, plain, subject, scene)
    tolerances = decoded(Mapping[str, Any], data.get("tolerances") or {}, "tolerances")
    draws = read_draws(data)
    cases = read_cases(data, interfaces, limits.total_s, draws, has_cast=subject.has_cast)
    checks, heard = _checks(data, place, cases, interfaces, limits.total_s, draws, subject)
    cases = [each.hearing(heard) for each in cases]
    allowed = read_allowed(data, subject, setting)
    if allowed is not None:
        checks = checks.guarded(allowed.check, allowed.within)
    wrong = checks.wrong_tolerance(tolerances)
    if wrong is not None:
        raise Mistake(("tolerances", wrong[0]), wrong[1])
    points = _points(data["points"], checks)
    return Exercise(
        name=data["exercise"],
        limits=limits,
        varied=plain.varied_runs,
        points=points,
        tolerances=tolerances,
        checks=checks,
        scene=scene,
        setting=setting,
        looks_at_package=plain.looks_at_package,
        inspections=_inspections(plain, scene, subject),
        cpu_s=plain.cpu_s,
        programs=_programs(plain),
        folder=place.folder,
        starter=_starter(data.get("starter"), place),
        sha256=_sha256(data, {SETTING: setting, **interfaces}, place.folder),
        visible=policies.visible(data.get("visible"), checks, points),
        late=policies.late(data.get("late"), round(sum(points.values()), 2)),
        fits=plain.fits.files,
        interfaces=interfaces,
        cases=tuple(cases),
        draws=draws,
        allowed=allowed,
        is_to_end=any("exits" in each for each in data.get(EXPECT, {}).values()),
        title=authored(str(data["title"])),
        task=authored(plain.task),
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


def _limits(data: Mapping[str, Any], plain: _Plain, subject: Subject, scene: str) -> Limits:
    """Read when a run ends; check that its scene has such runs."""
    if isinstance(subject, Scene):
        limits = decoded(_Limits, data.get("limits"), "limits")
        _check_varied(plain.varied_runs, subject, scene)
        return Limits(**asdict(limits))
    for key in ("limits", "varied_runs", INSPECTS):
        if data.get(key):
            what = "nothing is started in the scene {scene}: leave it out"
            raise Mistake((key,), what, scene=repr(scene))
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
    setting = ""
    if where is not None:
        try:
            setting = (place.folder / str(where)).read_text(encoding="utf-8")
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
    draws: Mapping[str, Draw],
    subject: Subject,
) -> tuple[Checks, set[str]]:
    """Return the checks of checks.py and those of what is expected, and the topics of these."""
    if EXPECT not in data:
        return places.import_checks(place), set()
    from grader.exercise.expect.checks import add_checks  # here: most exercises have no such part
    from grader.exercise.known_types import KnownTypes

    has_own = (place.folder / CHECKS).is_file()
    checks = places.import_checks(place).copy() if has_own else Checks()
    met = subject.endpoints(subject.untouched(None), "") if isinstance(subject, Scene) else ()
    own = {each.name for each in met if each.kind == "publisher"}
    known = KnownTypes(definitions)
    return checks, add_checks(checks, data[EXPECT], cases, known, end_s, draws, own)


def _programs(plain: _Plain) -> tuple[str, ...]:
    """Return the names of the console scripts that are started together, or of the one."""
    several = plain.programs
    fits = len({*several}) == len(several) <= MOST_PROGRAMS
    what = "expected names of console scripts, each once, at most {n}; found {found}"
    expect(fits, ("programs",), what, several, n=MOST_PROGRAMS)
    if plain.program and several:
        raise Mistake(("programs",), "there is `program` already: leave one of them out")
    return (plain.program,) if plain.program else several


def _inspections(plain: _Plain, scene: str, subject: Subject) -> tuple[str, ...]:
    """The names of the inspectors that examine packages."""
    check_known(plain.inspections, extensions.points(extensions.INSPECTIONS), (INSPECTIONS,))
    if plain.inspections and isinstance(subject, Scene) and not plain.looks_at_package:
        raise Mistake((INSPECTIONS,), "no package is examined here without looks_at_package: true")
    return plain.inspections


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


def _points(points: Any, checks: Checks) -> dict[str, float]:
    if not isinstance(points, dict) or not points:
        raise Mistake(("points",), "expected check names with points")
    check_known(points, [check.name for check in checks], ("points",), are_checks=True)
    worth = {check: decoded(Amount, value, "points", check) for check, value in points.items()}
    if not any(worth.values()):
        raise Mistake(("points",), "all are 0")
    return worth
