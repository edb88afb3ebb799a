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
#: Conditions that are left out while they are off, with that value.
_OFF: Mapping[str, float] = {"varied_runs.per_student": 0}
_ERROR = re.compile(r"^(?P<name>[A-Za-z_][\w.]*)(?:: (?P<text>.*))?$")


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
    error, raised = last_error(recording.output), recording.observations.raised
    if raised is None or raised.place is None:
        return error or msg("exit code {code}", code=str(recording.run.exit_code))
    file, line = PurePath(raised.place.file).name, raised.place.line
    text = _PLACE.sub("", str(error)) or f"{raised.type}: {raised.text}".rstrip(".: ")
    if text.partition(":")[0].rpartition(".")[2] != raised.type.rpartition(".")[2]:
        return error  # of another thread
    return _with_place(text, file, str(line))


def last_error(output: str) -> Message:
    """Return the error of the last traceback with its place: 'NameError: ... (a.py, line 3)'."""
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
    published = [topic.topic for topic in recording.topics]
    found += load_subject(recording.scene).remarks(
        recording.trace, published, recording.run.interfaces
    )
    return found


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
