"""Run a submission and judge it."""

from __future__ import annotations

import argparse
from pathlib import Path

from grader.cli import options
from grader.errors import UsageError
from grader.system.requirements import require, require_ros
from grader.text.message import msg
from grader.text.translations import tr

#: The keys of `grader.cli.live.SPEEDS`.
SPEEDS = ("1", "5", "free")

NEEDS_LINUX = True


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the verb's arguments."""
    parser.add_argument(
        "submission", type=Path, help=tr("a .py file, a folder, a package or a zip")
    )
    options.add_of_runs(
        parser,
        tr("the clock that the submission lives by; virtual takes seconds and is the default"),
        tr(
            "refuse to run the submission confined less well: {levels} (the best "
            "that this system allows is always taken)",
            levels=", ".join(options.LEVELS),
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
        "--fail-under", type=options.points, metavar="POINTS", help=tr("exit 1 below this score")
    )


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
