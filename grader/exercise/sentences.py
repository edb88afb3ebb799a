"""Sentences for verdicts and reports: how a process ended, and what could not be looked at.

What the grader does not know costs a package nothing: `unless_unknown` is that rule.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from pathlib import PurePath
from typing import Final

from grader.exercise.verdict import Finding
from grader.recording.observations import Raised, last_exception
from grader.recording.recording import Provenance, Recording, Recordings
from grader.scenes.subject import load_subject
from grader.submission.package_trace import Obstacle, PackageTrace
from grader.text.message import NOTHING, Message, joined, msg
from grader.text.strings import shown

#: Conditions that are left out while they are off, with that value.
_OFF: Mapping[str, float] = {"varied_runs.per_student": 0}
#: The kind of an obstacle that is no fault of the package.
UNKNOWN: Final = "unknown"


def how_it_ended(recording: Recording) -> Message:
    """Return a sentence, with a space before it, on an abnormal end; '' for a normal one."""
    sentence = _ending(recording)
    return joined([" ", sentence]) if sentence else NOTHING


def _ending(recording: Recording) -> Message:
    run = recording.run
    if run.outcome == "crashed":
        return msg("The node ended with an error: {error}.", error=_error(recording))
    if run.outcome == "exited":
        return msg("The node ended by itself, without an error.")
    if run.outcome == "killed" and run.exit_code:
        return msg("The node was killed (signal {signal}).", signal=str(-run.exit_code))
    return msg("The node was killed.") if run.outcome == "killed" else NOTHING


def _error(recording: Recording) -> Message:
    """Return the error with the last line of the submission's files, where that is known."""
    printed, raised = last_exception(recording.output), recording.observations.raised
    code = msg("exit code {code}", code=str(recording.run.exit_code))
    if raised is None or raised.place is None:
        return _said(printed) if printed else code
    if printed and printed.type.rpartition(".")[2] != raised.type.rpartition(".")[2]:
        return _said(printed)  # of another thread
    return _said(replace(printed or raised, place=raised.place))


def _said(raised: Raised) -> Message:
    """Return an exception with its place: 'NameError: ... (a.py, line 3)'."""
    error, place = shown(f"{raised.type}: {raised.text}").rstrip(".: "), raised.place
    if place is None:
        return Message.of(error)
    file = shown(PurePath(place.file).name)
    return joined([error, msg(" ({file}, line {line})", file=file, line=str(place.line))])


def error_first(recordings: Recordings, finding: Finding) -> Finding:
    """Let the help of a finding name the error that ended its run.

    That of a varied run counts where the finding's evidence is of that run.
    """
    if finding.share >= 1:
        return finding
    # a varied run may not be there yet, and counts only for a finding that is of it
    run = finding.evidence[0].run if finding.evidence else 0
    crashed = recordings.nominal.run.outcome == "crashed" or (
        run > 0 and recordings.varied[run - 1].run.outcome == "crashed"
    )
    if not crashed:
        return finding
    help_ = msg("See the error first: what would have come after it is not there.")
    return replace(finding, help=help_)


def remarks(recording: Recording, all_passed: bool = False) -> list[Message]:
    """Return what a reader of any exercise's result should know about the run.

    Args:
        all_passed: whether every check of the exercise did.
    """
    found: list[Message] = []
    if recording.run.outcome == "crashed" and all_passed and len(recording.run.programs) < 2:
        found.append(
            msg(
                "After its work was done the node ended with an error: {error}; it costs no "
                "points.",
                error=_error(recording),
            )
        )
    elif recording.run.outcome == "crashed":
        found.append(_ending(recording))
    return found + load_subject(recording.scene).remarks(recording)


def not_followed(origin: Provenance | None, conditions: Mapping[str, float]) -> list[Message]:
    """Return remarks on conditions of the exercise that an older recording was not made with.

    Args:
        origin: the nominal recording's; None where it is not known.
        conditions: see `grader.exercise.exercise.Exercise`.
    """
    recorded = {} if origin is None else origin.conditions
    then = {**_OFF, **recorded} if recorded else {}
    return [
        msg(
            "The recording was made with {key} {then:g}; the exercise now says {value:g}. "
            "Run the submission again for that.",
            key=key,
            then=then[key],
            value=value,
        )
        for key, value in {**_OFF, **conditions}.items()
        if key in then and then[key] != value
    ]


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
    return Finding(0, text.given(file=file, why=problem.described), help, judged=False)
