"""The command line `grader`, one file a verb.

Exit codes: 0 judged, whatever the score (1 below --fail-under); 2 the call or the submission
cannot be used; 3 the grader itself failed; 130 interrupted, which was the caller's wish.
"""

from __future__ import annotations

import os
import sys
import traceback
from argparse import Namespace
from collections.abc import Sequence
from typing import Any

# numpy's worker threads would spin a while after its import, and have nothing to do here
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

try:  # this takes half a second, in which somebody may think better of it
    from rich.console import Console
    from rich.markup import escape

    from grader.cli import check, check_exercise, error_file, new, report, run
    from grader.errors import CheckFailed, GraderError, GraderFailure, UsageError
    from grader.run.processes import watched
except KeyboardInterrupt:
    print("grader: interrupted", file=sys.stderr)
    sys.exit(130)

VERBS: dict[str, Any] = {
    **{"run": run, "check": check, "report": report, "new": new},
    "check-exercise": check_exercise,
}
JUDGED, BELOW, UNUSABLE, GRADER_FAILED, INTERRUPTED = 0, 1, 2, 3, 130


def main(argv: Sequence[str] | None = None) -> int:
    """Run one verb; the exit code is the return value."""
    words = sys.argv[1:] if argv is None else argv
    try:
        args = _parser().parse_args(words)
    except error_file.Misuse as error:
        print(f"{error.usage}{error.prog}: error: {error}", file=sys.stderr)
        return _misused(error, error_file.look_for(words))
    watched.adopt_orphans()
    watched.end_on_signals()
    say = Console(stderr=True, soft_wrap=True, highlight=False).print
    try:
        error_file.prepare(args)
    except UsageError as error:
        say(f"[red]grader {args.verb}:[/] {escape(error.message)}")
        return error.exit_code
    try:
        return int(VERBS[args.verb].main(args))
    except KeyboardInterrupt:
        say(f"grader {args.verb}: interrupted")
        return _ended(UsageError("interrupted"), args, INTERRUPTED)
    except (GraderFailure, CheckFailed) as error:
        who = "exercise" if isinstance(error, CheckFailed) else "grader"
        say(
            f"[red]The {who} failed; this is not the submission's fault:[/] {escape(error.message)}"
        )
        return _ended(error, args)
    except GraderError as error:
        say(f"[red]grader {args.verb}:[/] {escape(error.message)}")
        return _ended(error, args)
    except Exception as error:
        say("[red]The grader failed; this is not the submission's fault. Please report:[/]")
        traceback.print_exc()
        what = "".join(traceback.format_exception_only(error)).strip()
        return _ended(GraderFailure(f"unexpected: {what}"), args)


def _parser() -> error_file.Parser:
    parser = error_file.Parser(prog="grader", description="Grade the turtlesim challenge.")
    verbs = parser.add_subparsers(dest="verb", required=True, metavar="VERB")
    for name, module in VERBS.items():
        summary = (module.__doc__ or "").splitlines()[0]
        verb = verbs.add_parser(name, help=summary, description=summary)
        module.add_arguments(verb)
        error_file.add_argument(verb)
    return parser


def _misused(error: error_file.Misuse, args: Namespace) -> int:
    try:
        error_file.prepare(args)
    except UsageError as unwritable:
        print(f"grader: {unwritable}", file=sys.stderr)
        return error.exit_code
    return _ended(error, args)


def _ended(error: GraderError, args: Namespace, exit_code: int | None = None) -> int:
    """Write the error as data, if that was asked for; the exit code."""
    try:
        error_file.write(error, args)
    except UsageError as unwritten:
        print(f"grader: {unwritten}", file=sys.stderr)
    return error.exit_code if exit_code is None else exit_code
