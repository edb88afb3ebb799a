"""The command line `grader`, one file a verb.

Exit codes: 0 judged, whatever the score (1 below --fail-under); 2 the call or the submission
cannot be used; 3 the grader itself failed.
"""

from __future__ import annotations

import argparse
import traceback
from typing import Any

from rich.console import Console
from rich.markup import escape

from grader.cli import check, new, report, run
from grader.errors import GraderFailure, RecordingError, UsageError
from grader.run.processes import watched
from grader.submission.opening import SubmissionError

VERBS: dict[str, Any] = {"run": run, "check": check, "report": report, "new": new}
JUDGED, BELOW, UNUSABLE, GRADER_FAILED, INTERRUPTED = 0, 1, 2, 3, 130


def main(argv: list[str] | None = None) -> int:
    """Run one verb; the exit code is the return value."""
    parser = argparse.ArgumentParser(prog="grader", description="Grade the turtlesim challenge.")
    verbs = parser.add_subparsers(dest="verb", required=True, metavar="VERB")
    for name, module in VERBS.items():
        summary = (module.__doc__ or "").splitlines()[0]
        verb = verbs.add_parser(name, help=summary, description=summary)
        module.add_arguments(verb)
    args = parser.parse_args(argv)
    watched.end_on_signals()
    errors = Console(stderr=True, soft_wrap=True, highlight=False)
    try:
        return int(VERBS[args.verb].main(args))
    except (UsageError, SubmissionError, RecordingError) as error:
        errors.print(f"[red]grader {args.verb}:[/] {escape(str(error))}")
        return UNUSABLE
    except KeyboardInterrupt:
        errors.print(f"grader {args.verb}: interrupted")
        return INTERRUPTED
    except GraderFailure as error:
        errors.print(
            f"[red]The grader failed; this is not the submission's fault:[/] {escape(str(error))}"
        )
        return GRADER_FAILED
    except Exception:
        errors.print(
            "[red]The grader failed; this is not the submission's fault. Please report:[/]"
        )
        traceback.print_exc()
        return GRADER_FAILED
