"""The repository of a course, made of templates: data files in which @@name stands for a value.

In a path, and in the folders below `templates/`, EXERCISE stands for each exercise of the course.
"""

from __future__ import annotations

import string
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

from grader import Exercise
from grader.cli import starters as starter
from grader.exercise import installed
from grader.system import versions as system
from grader.text import number

TEMPLATES = Path(__file__).parent / "templates"
#: What of them every kind has, and what is laid where a kind wants it.
ALL, SCRIPTS = "all", "scripts"
#: Begins names that have a dot there in a course: among ours git would heed, or pip forget, some.
DOT = "dot-"
IGNORE = "dot-gitignore"
#: A README is `README` with the kind's `STEPS`.
README, STEPS = "README.md", "steps.md"
OTHERS = "The commands below are for the first of them; do the same for each."
#: The share of an exercise's points from which on a check is green, if nothing else is said.
PASS_SHARE = 0.6
#: In paths: each exercise.
EXERCISE = "EXERCISE"
GRADE, INSTALL, PUBLISH = "grade.sh", "install.sh", "publish.sh"


@dataclass(frozen=True)
class Kind:
    """A system, and where a repository for it has what all of them have.

    Attributes:
        title: what the system is called.
        scripts: the folder of `grade.sh`, `install.sh` and the rubric.
        unusable: what a submission gets that cannot be used, there.
        failed: what becomes of one where the grader fails.
        log: where the staff reads what the grader said.
        is_copied: whether the starter is a repository of which each student gets a copy.
        slug: what stands for the `_` of an exercise's name.
    """

    title: str
    scripts: str
    unusable: str
    failed: str
    log: str = "the system's log of the run"
    is_copied: bool = False
    slug: str = "_"

    @property
    def starter(self) -> str:
        """The folder of a starter."""
        return f"{'templates' if self.is_copied else 'starters'}/{EXERCISE}"

    @property
    def rubric(self) -> str:
        """The exercise that is graded by, an edited copy."""
        return f"{self.scripts}/rubric.yaml"


KINDS = {
    "gradescope": Kind(
        "Gradescope",
        "autograders/EXERCISE",
        "0, with the message",
        'none; "This is not your fault", and `grader_failed` in `extra_data`',
        "the output that only the staff sees",
    ),
    "classroom50": Kind(
        "Classroom 50",
        "autograders/EXERCISE",
        "0, in a release with the message",
        "none; an error",
        is_copied=True,
        slug="-",
    ),
    "github": Kind(
        "GitHub Actions",
        "templates/EXERCISE/.github/grader",
        '0; the check is red, "0 points: cannot be graded"',
        'none; the job is red, the check "Not graded"',
        "`log.txt` of the artifact",
        is_copied=True,
    ),
    "gitlab": Kind(
        "GitLab CI",
        "templates/EXERCISE/.gitlab/grader",
        '0; the job is red, "Points: 0", a failed test',
        "none; the job is tried again, then red",
        "`log.txt` of the artifacts",
        is_copied=True,
    ),
}
#: Where PASS_POINTS makes a check green.
HAVE_A_CHECK = ("github", "gitlab")


@dataclass(frozen=True)
class Settings:
    """What a teacher may say of a course.

    Attributes:
        source: what pip installs.
        pass_points: from how many points on a check is green; None: `PASS_SHARE` of them.
        ros: the ROS 2 release that starters are for.
    """

    source: str
    pass_points: float | None
    ros: str


class Template(string.Template):
    """A text with @@name for values: no file of the systems has two @."""

    delimiter = "@@"


def write(folder: Path, name: str, exercises: Sequence[Exercise], how: Settings) -> None:
    """Write the repository for the kind of this name into a folder that is not there yet."""
    kind = KINDS[name]
    slugs = [(each, each.name.replace("_", kind.slug)) for each in exercises]
    for exercise, slug in slugs:
        place = folder / kind.starter.replace(EXERCISE, slug)
        starter.write(place, exercise, exercise.name, slug, how.ros)
        rubric = folder / kind.rubric.replace(EXERCISE, slug)
        rubric.parent.mkdir(parents=True, exist_ok=True)
        rubric.write_bytes(installed(exercise.name).description.read_bytes())
    of_course = _of_course(kind, exercises, [slug for _, slug in slugs], how)
    readme = _text(TEMPLATES / ALL / README).replace("@@steps\n", _text(TEMPLATES / name / STEPS))
    _fill(folder / README, readme, of_course)
    for path, template in _templates(name, kind):
        of_each = slugs if EXERCISE in str(path) else [(exercises[0], "")]
        for exercise, slug in of_each:
            target = folder / str(path).replace(EXERCISE, slug)
            passed = PASS_SHARE * exercise.max_score if how.pass_points is None else how.pass_points
            _fill(target, _text(template), of_course | {"pass_points": str(number(passed))})


def _templates(name: str, kind: Kind) -> Iterator[tuple[PurePosixPath, Path]]:
    """Yield where each file of a kind goes, and its template."""
    for part in (ALL, name):
        for path in sorted(path for path in (TEMPLATES / part).rglob("*") if path.is_file()):
            place = PurePosixPath(path.relative_to(TEMPLATES / part))
            if place.name in (README, STEPS) or "__pycache__" in place.parts:
                continue
            yield _with_dots(place), path
    scripts = dict.fromkeys((GRADE, INSTALL), kind.scripts)
    if kind.is_copied:
        scripts[PUBLISH] = ""
        yield _with_dots(PurePosixPath(kind.starter, IGNORE)), TEMPLATES / SCRIPTS / IGNORE
    for file, where in scripts.items():
        yield PurePosixPath(where, file), TEMPLATES / SCRIPTS / file


def _with_dots(path: PurePosixPath) -> PurePosixPath:
    parts = (f".{part[len(DOT) :]}" if part.startswith(DOT) else part for part in path.parts)
    return PurePosixPath(*parts)


def _of_course(
    kind: Kind, exercises: Sequence[Exercise], slugs: Sequence[str], how: Settings
) -> dict[str, str]:
    """Return the values that are the same in all files."""
    first, slug = exercises[0], slugs[0]
    return {
        "system": kind.title,
        "version": system.grader_version(),
        "source": how.source,
        "unusable": kind.unusable,
        "failed": kind.failed,
        "log": kind.log,
        "first": slug,
        "first_name": first.name,
        "first_title": str(first.title),
        "others": f"\n{OTHERS}" if len(slugs) > 1 else "",
        "rubric": kind.rubric.replace(EXERCISE, slug),
        "table": "\n".join(map(_row, exercises, slugs)),
    }


def _row(exercise: Exercise, slug: str) -> str:
    return f"| `{slug}` | {exercise.title!s} | {number(exercise.max_score)} |"


def _text(path: Path) -> str:
    return path.read_text(encoding="utf-8")


def _fill(target: Path, template: str, values: Mapping[str, str]) -> None:
    """Write a file with its values; what begins as a script can be started."""
    content = Template(template).substitute(values)
    target.parent.mkdir(parents=True, exist_ok=True)
    target.write_text(content, encoding="utf-8")
    if content.startswith("#!"):
        target.chmod(0o755)
