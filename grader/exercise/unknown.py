"""What the grader does not know costs a package nothing: the one rule of all exercises."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Final

from grader.exercise.verdict import Finding
from grader.submission.error_texts import described
from grader.submission.trace import Obstacle, PackageTrace
from grader.text.message import NOTHING, Message, msg

#: The kind of an obstacle that is no fault of the package.
UNKNOWN: Final = "unknown"


def unless_unknown(
    trace: PackageTrace,
    finding: Finding,
    what: Message = NOTHING,
    kinds: Iterable[str] = (UNKNOWN,),
) -> Finding:
    """Return a finding; not judged where it takes points that an obstacle may have cost.

    The launch file that could not be evaluated may be the one that does what is asked for, and the
    set-up that could not be followed may install what seems to be missing.

    Args:
        what: what is known without the file that could not be evaluated, as a clause.
        kinds: of the obstacles that count.
    """
    found = ((file, each) for file, each in _obstacles(trace) if each.kind in kinds)
    first = next(found, None)
    return finding if finding.share == 1 or first is None else not_judged(*first, what)


def _obstacles(trace: PackageTrace) -> Iterator[tuple[str, Obstacle]]:
    for each in trace.launches:
        if each.problem is not None:
            yield each.file, each.problem
    if trace.setup is not None and (problem := trace.setup.problem) is not None:
        yield problem.file or "setup.py", problem


def not_judged(file: str, problem: Obstacle, what: Message = NOTHING) -> Finding:
    """Return what a check is worth that hangs on a file which could not be evaluated."""
    text = msg("Not judged: {file} could not be evaluated: {why}.")
    if what:
        text = msg("Not judged: {what}, and {file} could not be evaluated: {why}.", what=what)
    help = msg("This is no fault of the package: tell whoever runs the course.")
    if problem.kind == "argument":
        help = msg(
            "Give the argument a default_value: then `ros2 launch` needs no more than the file."
        )
    return Finding(0, text.given(file=file, why=described(problem)), help, judged=False)
