"""The input of every format: a result, and its artifacts: picture, recordings, output."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from functools import cached_property
from pathlib import Path
from typing import Self

from grader.errors import RecordingError
from grader.exercise.result.result import Result
from grader.exercise.result.visible import View, student_view
from grader.exercise.verdict import Evidence, Verdict
from grader.recording import reading
from grader.recording.recording import Recording, Recordings
from grader.recording.subject import DEFAULT_SCENE
from grader.reports import readable, wording
from grader.reports.wording import NOTHING_MOVED, SEE_FIRST, points, title_of, where, word
from grader.scenes.subject import Subject, load_subject
from grader.text import strings as text
from grader.text.message import NOTHING, Message
from grader.text.translations import tr, translate


class Artifacts:
    """The artifacts beside a result file; each is read when it is first used.

    Args:
        recordings: those of a new result, which then need not be read back.

    Attributes:
        folder: of the result file; artifacts outside it are ignored.
    """

    def __init__(self, result: Result, folder: Path, recordings: Recordings | None = None) -> None:
        self.folder = folder
        self._paths = text.plain(dict(result.artifacts))
        self._runs = 1 + len(result.varied_runs)
        self._made = recordings

    @cached_property
    def canvas_path(self) -> Path | None:
        """The path of the final window's picture; None where there is none."""
        path = self._artifact("canvas")
        return path if path is not None and path.is_file() else None  # reading a pipe would block

    @property
    def canvas_file(self) -> Path | None:
        """`canvas_path` if the picture has to be read from the file, else None."""
        return None if self._made is not None else self.canvas_path

    @property
    def solid_words(self) -> str:
        """What only a page could draw, in words, where no recording is kept; '' for nothing."""
        return ""

    @cached_property
    def scene(self) -> str:
        """The name of the scene; the default one where there is no recording."""
        if self._made is not None:
            return self._made.nominal.scene
        base = self._artifact("recording")
        return DEFAULT_SCENE if base is None else reading.scene_of(base)

    @cached_property
    def recordings(self) -> Mapping[int, Recording | Message]:
        """Run (0 nominal, 1, 2, ... varied) -> its recording, or why that cannot be read."""
        if self._made is not None:
            return dict(enumerate(self._made))
        base = self._artifact("recording")
        if base is None:
            return {}
        loaded: dict[int, Recording | Message] = {}
        for run in range(self._runs):
            try:
                loaded[run] = reading.load(base / f"varied_{run}" if run else base)
            except RecordingError as error:
                loaded[run] = error.message
        return loaded

    @cached_property
    def output(self) -> str:
        """The output of the node in the nominal run."""
        path = None if self._made is not None else self._artifact("output")
        if path is not None and path.is_file():
            return path.read_bytes().decode(errors="replace")
        nominal = self.recordings.get(0)
        return nominal.output if isinstance(nominal, Recording) else ""

    def _artifact(self, name: str) -> Path | None:
        """Return the path of an artifact; None if it is missing or outside the result's folder."""
        relative = self._paths.get(name)
        if not relative:
            return None
        folder = self.folder.resolve()
        path = (folder / relative).resolve()
        return path if path.is_relative_to(folder) and path.exists() else None


@dataclass(frozen=True)
class Point:
    """A piece of evidence with its number.

    Attributes:
        number: 1, 2, ... over all verdicts; the same in the picture and in the text.
        verdict: the number of its verdict, from 0.
        evidence: what it is.
    """

    number: int
    verdict: int
    evidence: Evidence

    @property
    def where(self) -> str:
        """Time and place: 'at 12.34 s, at (5.54, 7.20)'."""
        return where(self.evidence)

    def __str__(self) -> str:
        return tr("{where}: {note}", where=self.where, note=self.evidence.note)


class Report:
    """A result to show, by default to its student.

    Every text in it is plain (see `text.plain`), so a format only has to quote by its own rules.

    Args:
        result: the result.
        artifacts: the picture, the recordings and the output.
        view: what its reader may see; all else is left out of the report.

    Attributes:
        exercise, submission, max_score, run, varied_runs: those of the result.
        flags: remarks on the nominal run.
        score: that of the result; after a deduction for lateness, where no check is left out.
        deducted: this deduction, where `score` has it.
        verdicts: those of the result, in its order, with texts of limited length; no two checks
            have the same name.
        origin: sentences on the provenance of the result; empty where that is unknown.
        diagnosis: that of the result, with texts of limited length; None for none.
        not_shown: a sentence on the checks that are left out; '' for none.
        not_shown_name: the name of these as one check, for formats that know only checks.
        made: when this report was made, in UTC.
        notes: sentences on whose attempt it is, the deduction for lateness, and `not_shown`.
        artifacts, view: as above.
    """

    def __init__(self, result: Result, artifacts: Artifacts, view: View = "student") -> None:
        seen = result if view == "whole" else student_view(result, view == "after_due")
        shown: Result = text.plain(readable.few(seen), readable.RAW_LIMIT)
        self._result = result
        self.made = datetime.now(UTC)
        self.artifacts = artifacts
        self.view = view
        self.exercise = readable.line(shown.exercise) or tr("(no name)")
        self.submission = readable.line(shown.submission) or tr("(no name)")
        self.score = float(shown.score if shown.not_shown else shown.final)
        self.deducted = round(float(shown.score) - self.score, 2)
        self.max_score = float(shown.max_score)
        self.run, self.varied_runs = shown.run, shown.varied_runs
        self.flags = readable.flags(shown.run)
        self.origin = wording.provenance(shown.provenance) if shown.provenance else []
        *names, self.not_shown_name = readable.distinct(
            [*(text.one_line(verdict.check) for verdict in shown.verdicts), "not shown"]
        )
        self._left_out = shown.not_shown
        self.not_shown = wording.not_shown(shown.not_shown)
        attempt = map(readable.line, wording.attempt(shown))
        self.notes = list(filter(None, (*attempt, self.not_shown)))
        self.verdicts = tuple(map(readable.of_verdict, shown.verdicts, names))
        self.diagnosis = None if shown.diagnosis is None else readable.of_diagnosis(shown.diagnosis)
        by_check = {verdict.check: verdict for verdict in shown.verdicts}
        waits = (verdict.waited_for(by_check) for verdict in shown.verdicts)
        self._waits = dict(zip(names, waits, strict=True))

    @classmethod
    def of(
        cls, result: Result, folder: Path, recordings: Recordings, view: View = "student"
    ) -> Self:
        """Make the report of a new result, which will be in a folder."""
        return cls(result, Artifacts(result, folder, recordings), view)

    @cached_property
    def whole(self) -> Report:
        return self if self.view == "whole" else Report(self._result, self.artifacts, "whole")

    def seen_by_students(self, verdict: Verdict) -> str:
        """Return, for a teacher, what students see of a verdict; '' for all, and for students."""
        if self.view != "whole":
            return ""
        return translate(wording.SEEN_BY_STUDENTS.get(verdict.visible, NOTHING))

    @property
    def folder(self) -> Path:
        return self.artifacts.folder

    @property
    def score_text(self) -> str:
        """The total: '87.5 of 100'."""
        score, most = points(self.score), points(self.max_score)
        return tr("{score} of {max_score}", score=score, max_score=most)

    @cached_property
    def points(self) -> tuple[Point, ...]:
        """The evidence of all verdicts, by number."""
        listed = [(i, item) for i, verdict in enumerate(self.verdicts) for item in verdict.evidence]
        return tuple(Point(number, *one) for number, one in enumerate(listed, 1))

    def points_of(self, verdict: Verdict) -> tuple[Point, ...]:
        index = self.verdicts.index(verdict)
        return tuple(point for point in self.points if point.verdict == index)

    def waited_for(self, verdict: Verdict) -> tuple[str, ...]:
        """Return the checks that have to pass before it is judged; none if it was judged."""
        return self._waits[verdict.check]

    @property
    def waiting(self) -> dict[tuple[str, ...], tuple[Verdict, ...]]:
        """The verdicts that wait for others, by the titles of these."""
        titles = {verdict.check: title_of(verdict) for verdict in self.verdicts}
        found: dict[tuple[str, ...], tuple[Verdict, ...]] = {}
        for verdict in self.verdicts:
            if waited_for := self.waited_for(verdict):
                key = tuple(titles.get(name, name) for name in waited_for)
                found[key] = (*found.get(key, ()), verdict)
        return found

    def help_for(self, verdict: Verdict) -> str:
        """Return the hint on a verdict, for formats that show the diagnosis above the verdicts.

        A check knows only the effects of the diagnosed cause, so its hint may contradict the
        diagnosis. The first of these verdicts points to the diagnosis, the others have no hint.
        """
        led = [each for each in self.verdicts if each.help and self._is_diagnosed(each)]
        if verdict not in led:
            return translate(verdict.help)
        return translate(SEE_FIRST) if verdict is led[0] else ""

    def _is_diagnosed(self, verdict: Verdict) -> bool:
        """Whether the diagnosis may explain it: not if its evidence is all of other runs."""
        found = self.diagnosis
        if found is None or found.check or verdict.status != "failed":
            return False
        return found.run in ({item.run for item in verdict.evidence} or {found.run})

    @property
    def first_to_mend(self) -> Verdict | None:
        """The verdict that the diagnosis repeats; else the first that failed.

        If none failed, the first that was not judged; None if all passed.
        """
        named = self.diagnosis.check if self.diagnosis is not None else ""
        of_diagnosis = next((v for v in self.verdicts if named and v.check == named), None)
        return of_diagnosis or next(
            (v for status in ("failed", "not_judged") for v in self.verdicts if v.status == status),
            None,
        )

    @property
    def headline(self) -> str:
        """The cause of lost points, in one line."""
        if self.diagnosis is not None:
            return translate(self.diagnosis.cause)
        first = self.first_to_mend
        if first is not None:
            return text.one_line(translate(first.rationale)) or f"{first.check}: {word(first)}"
        return wording.nothing_to_mend(len(self.verdicts), self._left_out)

    @property
    def first_line(self) -> str:
        """The headline, introduced as a fault if it is one."""
        lost = self.diagnosis is not None or self.first_to_mend is not None
        return tr("Fix this first: {headline}", headline=self.headline) if lost else self.headline

    @property
    def advice(self) -> list[str]:
        """The lines of the diagnosis below the headline: where, and what to do."""
        found = self.diagnosis
        if found is None:
            return []
        lines = [tr("Where: {where}", where=self.where_first)] if self.where_first else []
        return [*lines, *([tr("What to do: {help}", help=found.help)] if found.help else [])]

    @property
    def where_first(self) -> str:
        """The place of the diagnosis: 'drive.py, line 39, in on_pose: time.sleep(0.2)'."""
        place = self.diagnosis.place if self.diagnosis is not None else None
        if place is None:
            return ""
        at = {"file": place.file, "line": str(place.line), "function": place.function}
        if place.function:
            where = tr("{file}, line {line}, in {function}", **at)
        else:
            where = tr("{file}, line {line}", **at)
        if place.text:
            where = tr("{where}: {code}", where=where, code=place.text)
        return text.one_line(where)

    def outcome(self, run: int) -> str:
        """Return how a run ended, as a key of `wording.OUTCOMES`."""
        summary = self.varied_runs[run - 1] if run else self.run
        if summary.outcome == "time_limit" and self._never_moved(run):
            return NOTHING_MOVED
        return summary.outcome.replace("_", " ")

    def _never_moved(self, run: int) -> bool:
        """Whether there is a recording, and nothing moved in it."""
        recording = self.recordings.get(run)
        if recording is None:
            return False
        view = load_subject(recording.scene).view(recording.trace)
        ways = [way for track in view.tracks for way in (track.x, track.y, track.theta)]
        ways = ways or [curve.values for curve in view.curves]
        return bool(ways) and all((way == way[:1]).all() for way in ways)

    @cached_property
    def recordings(self) -> dict[int, Recording]:
        """Run (0 nominal, 1, 2, ... varied) -> its recording, where there is one."""
        found = self.artifacts.recordings
        return {run: r for run, r in found.items() if isinstance(r, Recording)}

    @cached_property
    def subject(self) -> Subject:
        """The subject of the runs; the default scene where that is not installed any more."""
        try:
            return load_subject(self.artifacts.scene)
        except KeyError:
            return load_subject(DEFAULT_SCENE)

    def no_recording(self, run: int) -> str:
        reason = self.artifacts.recordings.get(run)
        if not isinstance(reason, Message):
            return tr("no recording lies beside it")
        return text.plain(translate(reason))

    @cached_property
    def output(self) -> str:
        return text.plain(self.artifacts.output)
