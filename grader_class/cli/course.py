"""Write the repository of a course that is graded on GitHub, Gradescope or another system."""

from __future__ import annotations

import argparse
import os
import re
from collections.abc import Sequence
from pathlib import Path

from grader import Exercise, UsageError, load_exercise
from grader.exercise import installed, names
from grader.system import files
from grader.system import versions as system
from grader.text import msg, number, tr
from grader_class.course import repository
from grader_class.course.repository import HAVE_A_CHECK, KINDS

#: The releases of ROS 2 that PyPI has, as extras of ours.
RELEASES = ("jazzy", "kilted")
#: What pip installs: in shells, YAML and Python, quoted, the same text.
SOURCE = re.compile(r"[\w.+:/@\[\]=~<>!,;#&%][\w.+:/@\[\]=~<>!,;#&% -]*", re.ASCII)
#: An address, perhaps behind a name: of a git repository at a tag, or of an archive.
ADDRESS = re.compile(
    r"([\w.-]+(?:\[[\w,-]+\])? *@ *)?"
    r"(?:git\+\w+://[^/]*/[^#]*[^#/]@[^#/@]+|\w+://[^#]*\.(?:whl|zip|tar\.gz))(?:#.*)?",
    re.ASCII,
)
RELEASE = re.compile(r"([\w.-]+)(\[[\w,-]+\])?( *[=~<>!].+)", re.ASCII)
#: What stands before a host: over https a token may pose as the user.
SECRET = re.compile(r"https?://[^/@]*@|\w+://[^/@]*:[^/@]*@")
EXPLAINED = msg(
    "Exercises: {names}. The README.md that is written has the first week's steps; it, and the "
    "comments in the files, are in English. Nothing is put under git."
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the verb's arguments."""
    parser.epilog = tr(EXPLAINED.key, names=", ".join(names()))
    parser.add_argument("what", choices=("new",), help=tr("what to do"))
    parser.add_argument("folder", type=Path, metavar="DIR", help=tr("a new or empty folder"))
    parser.add_argument(
        "--for", dest="kind", required=True, choices=tuple(KINDS), help=tr("the system")
    )
    parser.add_argument(
        "--exercises",
        nargs="+",
        default=(),
        metavar="NAME",
        help=tr("which ones, in their order (the challenge); the list is below"),
    )
    parser.add_argument(
        "--source",
        metavar="WHAT",
        help=tr(
            "what pip installs there: a git address with a tag, or the path of an unpacked "
            "release; default: this release, by its name"
        ),
    )
    parser.add_argument(
        "--ros",
        choices=RELEASES,
        default=RELEASES[0],
        help=tr(
            "the ROS 2 release of starters and of the grader there ({first})", first=RELEASES[0]
        ),
    )
    parser.add_argument(
        "--pass-points",
        type=float,
        metavar="POINTS",
        help=tr(
            "from how many points on the check is green ({kinds}; three fifths of all)",
            kinds=", ".join(HAVE_A_CHECK),
        ),
    )


def main(args: argparse.Namespace) -> int:
    """Write it, into a new or empty folder alone."""
    if any("," in name for name in args.exercises):
        raise UsageError(
            "--exercises {names}: separate them by blanks, not commas",
            names=" ".join(args.exercises),
        )
    exercises = [load_exercise(installed(name).name) for name in dict.fromkeys(args.exercises)]
    exercises = exercises or [load_exercise()]
    _check_points(args.kind, args.pass_points, exercises)
    source = _source(args.source, args.ros)
    how = repository.Settings(source, args.pass_points, args.ros)
    with files.filling(args.folder) as copy:
        repository.write(copy, args.kind, exercises, how)
    print(tr("The course is in {folder}.", folder=args.folder))
    print(tr("There, {source} is installed.", source=source))
    if source.startswith(os.sep):
        print(tr("That is a path: it has to be the same where it is installed."))
    print(
        tr(
            "Nothing is under git yet: {readme} says what to do, step by step.",
            readme=repository.README,
        )
    )
    return 0


def _check_points(kind: str, points: float | None, exercises: Sequence[Exercise]) -> None:
    if points is None:
        return
    if kind not in HAVE_A_CHECK:
        raise UsageError(
            "--pass-points is for {kinds}; {kind} has no check that is green or red",
            kinds=", ".join(HAVE_A_CHECK),
            kind=kind,
        )
    least = min(exercises, key=lambda exercise: exercise.max_score)
    if not 0 <= points <= least.max_score:
        raise UsageError(
            "--pass-points {points}: expected 0 to {most}, which {exercise} is worth",
            points=number(points),
            most=number(least.max_score),
            exercise=least.name,
        )


def _source(source: str | None, ros: str) -> str:
    """Return what pip is to install, with ROS; a path is made whole."""
    if source is None:
        version = system.grader_version().partition("+")[0]
        if version == system.UNKNOWN:
            raise UsageError(
                "the version of this grader is not known; say with --source what to install"
            )
        return f"turtlesim_py[{ros}]=={version}"
    if SECRET.search(source):
        raise UsageError(
            "a password or token in --source would be in files that students may read: leave it "
            "out. The whole address goes into the CI's secret GRADER_SOURCE ({kinds}), elsewhere "
            'where {readme} says under "Secrets"',
            kinds=", ".join(HAVE_A_CHECK),
            readme=repository.README,
        )
    extra = f"[{ros}]"  # ROS comes by it
    whole = None
    if "://" in source:
        if address := ADDRESS.fullmatch(source):
            whole = source if address[1] else f"turtlesim_py{extra} @ {source}"
    elif source.startswith(".") or os.sep in source:  # a path, as pip sees it
        path = str(Path(source).resolve())
        whole = path if "[" in path else f"{path}{extra}"
    elif release := RELEASE.fullmatch(source):
        name, given, version = release.groups()
        whole = f"{name}{given or extra}{version}"
    if whole is None or not SOURCE.fullmatch(whole):
        raise UsageError(
            "--source {source}: expected what pip installs, without quotes, $, ? and \\: "
            "git+https://HOST/PATH.git@TAG, the address of an archive (.whl, .zip, .tar.gz), a "
            "folder as a path, or a name with its version (turtlesim_py==1.0)",
            source=repr(source),
        )
    return whole
