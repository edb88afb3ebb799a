"""Sentences about how a submission's process ended, for verdicts and reports."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import replace
from pathlib import PurePath

from grader.exercise.verdict import Finding
from grader.message import NOTHING, Message, joined, msg
from grader.recording.recording import Provenance, Recording, Recordings
from grader.recording.subject import load_subject
from grader.text import without_controls

# blanks of one line only: lines of nothing would be gone through again from each of them
_FRAME = re.compile(r'^[^\S\n]*File "(?P<file>[^"\n]+)", line (?P<line>\d+)', re.MULTILINE)
_PLACE = re.compile(r" \([^()]*, line \d+\)$")
#: What conditions do not tell while it is off.
_OFF: Mapping[str, float] = {"varied_runs.per_student": 0}
_ERROR = re.compile(r"^(?P<name>[A-Za-z_][\w.]*)(?:: (?P<text>.*))?$")


def how_it_ended(recording: Recording) -> Message:
    """A sentence (with a space before it) about an end that matters; '' where there is none."""
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
    """The error with the last line of the submission's own, where it is known."""
    error, raised = last_error(recording.output), recording.observations.raised
    if raised is None or raised.place is None:
        return error or msg("exit code {code}", code=str(recording.run.exit_code))
    file, line = PurePath(raised.place.file).name, raised.place.line
    said = _PLACE.sub("", str(error)) or f"{raised.type}: {raised.text}".rstrip(".: ")
    if said.partition(":")[0].rpartition(".")[2] != raised.type.rpartition(".")[2]:
        return error  # of another thread
    return _with_place(said, file, str(line))


def last_error(output: str) -> Message:
    """The last line of the last traceback with file and line: 'NameError: ... (a.py, line 3)'."""
    start = output.rfind("Traceback (most recent call last)")
    if start < 0:
        # A SyntaxError in the file that was started has no traceback of its own.
        start = max(output.rfind('  File "'), 0)
    part = output[start:]
    frames = list(_FRAME.finditer(part))
    lines = part[frames[-1].end() :].splitlines() if frames else []
    error = next((line for line in lines if line[:1].strip() and _ERROR.match(line)), "")
    if not error:
        return NOTHING
    where = frames[-1]
    return _with_place(error.rstrip("."), PurePath(where["file"]).name, where["line"])


def _with_place(error: str, file: str, line: str) -> Message:
    place = msg(" ({file}, line {line})", file=without_controls(file, "?"), line=line)
    return joined([without_controls(error, "?"), place])


def error_first(recordings: Recordings, finding: Finding) -> Finding:
    """A finding of a run that an error ended: its facts, and the error as what to mend first.

    That of a varied run counts where the finding's evidence is of that run.
    """
    if finding.share >= 1:
        return finding
    # a varied run may not be there yet, and is looked at by a finding that is of it only
    run = finding.evidence[0].run if finding.evidence else 0
    crashed = recordings.nominal.run.outcome == "crashed" or (
        run > 0 and recordings.varied[run - 1].run.outcome == "crashed"
    )
    if not crashed:
        return finding
    help_ = msg("See the error first: what would have come after it is not there.")
    return replace(finding, help=help_)


def remarks(recording: Recording, all_passed: bool = False) -> list[Message]:
    """What a reader of any exercise's result should know about the run.

    Args:
        all_passed: whether every check of the exercise did.
    """
    found: list[Message] = []
    if recording.run.outcome == "crashed" and all_passed:
        found.append(
            msg(
                "After its work was done the node ended with an error: {error}; it costs no "
                "points.",
                error=_error(recording),
            )
        )
    elif recording.run.outcome == "crashed":
        found.append(_ending(recording))
    published = [topic.topic for topic in recording.topics]
    found += load_subject(recording.scene).remarks(
        recording.trace, published, recording.run.interfaces
    )
    return found


def not_followed(origin: Provenance | None, conditions: Mapping[str, float]) -> list[Message]:
    """What of an exercise's conditions a recording that was made before cannot follow.

    Args:
        origin: the nominal recording's; None where it does not tell.
        conditions: see `grader.exercise.exercise.Exercise`.
    """
    told = {} if origin is None else origin.conditions
    then = {**_OFF, **told} if told else {}
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
