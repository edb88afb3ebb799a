"""Run a submission and judge it."""

from __future__ import annotations

import argparse
import math
from datetime import date
from pathlib import Path

from grader.cli import options
from grader.errors import UsageError
from grader.exercise import DEFAULT
from grader.system.requirements import require, require_ros
from grader.text.message import msg
from grader.text.translations import tr

#: Those of `grader.run.processes.levels.LEVELS`, which takes long to import.
LEVELS = ("namespaces", "landlock", "limits")
#: The keys of `grader.grading.RUNNERS`, which takes long to import.
CLOCKS = ("real", "virtual")
#: The keys of `grader.cli.live.SPEEDS`.
SPEEDS = ("1", "5", "free")

NEEDS_LINUX = True


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the verb's arguments."""
    parser.add_argument(
        "submission", type=Path, help=tr("a .py file, a folder, a package or a zip")
    )
    add_of_runs(
        parser,
        tr("the clock that the submission lives by; virtual takes seconds and is the default"),
        tr(
            "refuse to run the submission confined less well: {levels} (the best "
            "that this system allows is always taken)",
            levels=", ".join(LEVELS),
        ),
    )
    parser.add_argument("--watch", action="store_true", help=tr("grade again on every save"))
    parser.add_argument(
        "--live",
        action="store_true",
        help=tr("show the runs, one after the other, in a page while they happen"),
    )
    parser.add_argument(
        "--speed",
        choices=SPEEDS,
        help=tr("of --live: as in real time (default), five times as fast, as fast as it goes"),
    )
    parser.add_argument("--out", type=Path, metavar="DIR", help=tr("default: below graded/"))
    parser.add_argument(
        "--json", type=Path, metavar="FILE", help=tr("write the result here as well")
    )
    options.add_of_start(parser)
    parser.add_argument(
        "--fail-under", type=points, metavar="POINTS", help=tr("exit 1 below this score")
    )


def add_of_runs(parser: argparse.ArgumentParser, clock: str, isolation: str) -> None:
    """Declare how submissions are run; the texts are the help on --time and --isolation."""
    parser.add_argument(
        "--exercise",
        metavar="NAME|FOLDER|FILE",
        help=tr(
            "an installed one, the folder of another, or an edited exercise.yaml; default: the one "
            "that the files of a starter name (one for a class), else the challenge"
        ),
    )
    parser.set_defaults(named=DEFAULT)  # by what is handed in, where --exercise is left out
    parser.add_argument("--time", choices=CLOCKS, default="virtual", help=clock)
    seeds = parser.add_mutually_exclusive_group()
    seeds.add_argument(
        "--seed",
        type=int,
        metavar="N",
        help=tr("where the varied runs start (the exercise's own)"),
    )
    seeds.add_argument(
        "--seed-file",
        type=Path,
        metavar="FILE",
        help=tr("a secret, from which each student gets a seed that no result shows"),
    )
    parser.add_argument(
        "--seed-shown-from",
        type=day,
        metavar="DATE",
        help=tr("of --seed-file: from this day on results show the seed (never)"),
    )
    parser.add_argument("--isolation", choices=LEVELS, metavar="LEVEL", help=isolation)


def points(text: str) -> float:
    """Parse a number of points of the command line."""
    value = float(text)
    if not math.isfinite(value):
        raise argparse.ArgumentTypeError(tr("expected a number of points, found {text}", text=text))
    return value


def day(text: str) -> date:
    """Parse a date of the command line."""
    try:
        return date.fromisoformat(text)
    except ValueError:
        found = tr("expected a date, e.g. 2026-12-31, found {text}", text=text)
        raise argparse.ArgumentTypeError(found) from None


def main(args: argparse.Namespace) -> int:
    """Grade one submission; see `grader.cli` for the exit codes."""
    _check_speed(args)
    require_ros(args.time)
    if args.isolation:
        from grader.run.processes import levels

        levels.require(args.isolation)
    # what can begin early belongs before this line: the imports below take long
    if args.time == "virtual":
        from grader.run import fork_servers

        fork_servers.warm()  # they import meanwhile
    from grader.cli import grade_one

    grade = grade_one.grade
    if args.watch:
        from grader.cli import watch

        grade = watch.grade_each_save
    if not args.live:
        return grade(args, None)
    require("websockets")
    from grader.cli.live import Live

    with Live(args.speed or SPEEDS[0]) as live:
        code = grade(args, live)
        live.stay()
    return code


def _check_speed(args: argparse.Namespace) -> None:
    """Refuse a speed that does not fit the other options."""
    if args.speed is None:
        return
    if not args.live:
        raise UsageError(
            msg("--speed is for --live: a run that nobody sees goes as fast as it can")
        )
    if args.time == "real" and args.speed != SPEEDS[0]:
        raise UsageError(
            "--speed {speed} needs virtual time: a run in real time goes as fast as the wall "
            "clock; leave out --speed or --time real",
            speed=args.speed,
        )
