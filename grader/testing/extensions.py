"""Check a scene or a report format of one's own, found by its entry point."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from grader.errors import UsageError
from grader.exercise.result.json_file import ErrorResult
from grader.exercise.result.result import Result, RunSummary
from grader.exercise.verdict import Verdict
from grader.recording import bag
from grader.recording.mcap import read_mcap
from grader.recording.subject import Trace
from grader.reports.formats import ErrorReport, load
from grader.reports.report import Artifacts, Report
from grader.scenes.subject import Subject, load_subject
from grader.text.message import NOTHING, Message, msg


def check_scene(name: str, setting: str = "") -> list[Message]:
    """Return what is wrong with an installed scene, without a run: its traces must survive a bag.

    Args:
        setting: as an exercise would set the scene up.

    Raises:
        KeyError, UsageError: it cannot be loaded, or has another name than its entry point.
    """
    scene = load_subject(name)
    lacking = [each for each in ("thing", "the_thing") if not hasattr(scene, each)]
    traces = {"untouched": scene.untouched(None), **scene.odd_traces(setting, None)}
    wrong = {what: changed_in_a_bag(trace, scene) for what, trace in traces.items()}
    return [
        *(msg("{scene} has no {member}", scene=name, member=each) for each in lacking),
        *(msg("{what}: {problem}", what=what, problem=why) for what, why in wrong.items() if why),
    ]


def changed_in_a_bag(trace: Trace, subject: Subject) -> Message:
    """Say what is wrong with a trace that was written as messages and read; NOTHING: is equal."""
    try:
        channels = read_mcap(bag.pack(trace, subject)[0])
        again = bag.parse_channels(channels, subject, trace.duration_ns, trace.sha256())
    except Exception as error:  # whatever another's raises
        why = f"{type(error).__name__}: {error}"
        return msg("from_channels() cannot read to_messages(): {error}", error=why)
    return NOTHING if again.ticks == trace.ticks else msg("from_channels() gives other ticks")


def check_report(name: str) -> list[Message]:
    """Return what is wrong with an installed report format: it writes, twice the same.

    Raises:
        KeyError, UsageError: it cannot be loaded.
    """
    form = load(name)
    problems = []
    for what, report in _reports():
        render = form.render if isinstance(report, Report) else form.render_error
        try:
            first, second = render(report), render(report)  # type: ignore[arg-type]
        except UsageError:  # it says that it cannot show this
            continue
        except Exception as error:  # whatever another package does
            problems.append(msg("{what}: raises {error}", what=what, error=repr(error)))
            continue
        if not str(first or "").strip():
            problems.append(msg("{what}: writes nothing", what=what))
        elif first != second:
            problems.append(msg("{what}: writes something else the second time", what=what))
    return problems


def _reports() -> Iterator[tuple[Message, Report | ErrorReport]]:
    title, seen, nowhere = Message.of("It moves"), Message.of("It was seen."), Path("/nowhere")
    for what, status, score, run in (
        (msg("a finished result"), "passed", 10.0, RunSummary("virtual", "finished")),
        (msg("a failed result"), "failed", 2.5, RunSummary("virtual", "crashed", 1)),
    ):
        help = NOTHING if status == "passed" else seen
        verdict = Verdict("moves", title, status, score, 10.0, seen, help)  # type: ignore[arg-type]
        result = Result("square", "node.py", score, 10.0, (verdict,), run)
        yield what, Report(result, Artifacts(result, nowhere))
    error = ErrorResult("grader", seen, 10.0)
    yield msg("an aborted grading"), ErrorReport(error, nowhere, ("moves",))
