"""What every format is made from: a result, and the picture and recordings that lie beside it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Self

from grader import text
from grader.exercise.verdict import Evidence, Verdict
from grader.message import NOTHING, Message
from grader.recording.recording import Recording, Recordings
from grader.recording.subject import DEFAULT_SCENE, Subject, load_subject
from grader.reports import readable, wording
from grader.reports.beside import Beside
from grader.reports.wording import NOTHING_MOVED, SEE_FIRST, points, title_of, where, word
from grader.result.result import Result
from grader.result.visible import View, as_seen
from grader.translations import tr, translate


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
    """A result to be shown, to its student if nothing else is said.

    Every text in it is plain (see `text.plain`), so a format only has to quote by its own rules.

    Args:
        result: the result.
        beside: the picture, the recordings and the output.
        view: who looks; what he is not to see is nowhere in the report.

    Attributes:
        exercise, submission, max_score, run, varied_runs: those of the result.
        flags: remarks on the nominal run.
        score: that of the result; after what lateness costs, where no check is left out of it.
        deducted: what is taken off for that in `score`.
        verdicts: those of the result, in its order, as they are shown: no text is longer than
            anybody reads, and no two checks have the same name.
        origin: sentences about where the result comes from; none where it does not tell.
        diagnosis: that of the result, with no text longer than anybody reads; None for none.
        not_shown: a sentence on the checks that are left out; '' for none.
        not_shown_name: what formats call them that know only checks.
        handed_in: sentences on whose it is, and what lateness costs; none where nobody has said it.
        beside, view: as above.
    """

    def __init__(self, result: Result, beside: Beside, view: View = "student") -> None:
        shown: Result = text.plain_all(readable.few(as_seen(result, view)), readable.LOOKED_AT)
        self._result = result
        self.beside = beside
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
        self.handed_in = list(map(readable.line, wording.handed_in(shown)))
        self.verdicts = tuple(map(readable.of_verdict, shown.verdicts, names))
        self.diagnosis = None if shown.diagnosis is None else readable.of_diagnosis(shown.diagnosis)
        self._waits = dict(zip(names, _waits(shown.verdicts), strict=True))

    @classmethod
    def of(
        cls, result: Result, folder: Path, recordings: Recordings, view: View = "student"
    ) -> Self:
        """The report of a result that has just been made, and goes into a folder."""
        return cls(result, Beside(result, folder, recordings), view)

    @cached_property
    def whole(self) -> Report:
        """The same for a teacher."""
        return self if self.view == "whole" else Report(self._result, self.beside, "whole")

    def seen_by_students(self, verdict: Verdict) -> str:
        """For a teacher, what of a verdict students see; '' for all of it, and for students."""
        return (
            translate(wording.SEEN_BY_STUDENTS.get(verdict.visible, NOTHING))
            if self.view == "whole"
            else ""
        )

    @property
    def folder(self) -> Path:
        """Where the result file lies."""
        return self.beside.folder

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
        """The evidence of one verdict."""
        index = self.verdicts.index(verdict)
        return tuple(point for point in self.points if point.verdict == index)

    def waited_for(self, verdict: Verdict) -> tuple[str, ...]:
        """What has to pass before it can be judged; nothing, if it was judged."""
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
        """What to look at: for formats in which the diagnosis stands above, where there is one.

        A check sees only what came of a cause that the diagnosis knows: its advice may contradict.
        The first of these verdicts points to the diagnosis, the others say nothing.
        """
        led = [each for each in self.verdicts if each.help and self._comes_of_the_first(each)]
        if verdict not in led:
            return translate(verdict.help)
        return translate(SEE_FIRST) if verdict is led[0] else ""

    def _comes_of_the_first(self, verdict: Verdict) -> bool:
        """Whether a run's own diagnosis may be behind it: not if it is all about other runs."""
        found = self.diagnosis
        if found is None or found.check or verdict.status != "failed":
            return False
        return found.run in ({item.run for item in verdict.evidence} or {found.run})

    def lines(self, verdict: Verdict) -> list[str]:
        """What was seen, where, and what to look at: for formats that show plain text."""
        lines = [text.one_line(translate(verdict.rationale))]
        if waited_for := self.waited_for(verdict):
            lines.append(tr("Waits for: {checks}", checks=", ".join(waited_for)))
        lines += [f"- {text.one_line(str(point))}" for point in self.points_of(verdict)]
        if verdict.help:
            lines.append(tr("Look at: {help}", help=text.one_line(translate(verdict.help))))
        return [line for line in lines if line]

    def led_lines(self, verdict: Verdict) -> list[str]:
        """The same, led by the diagnosis: for formats with no place for that but the checks.

        It leads the first that did not pass, unless that one says it itself.
        """
        lines, found = self.lines(verdict), self.diagnosis
        first = next((each for each in self.verdicts if not each.passed), None)
        if found is None or verdict is not first or found.check == verdict.check:
            return lines
        return [self.first_line, *self.advice, "", *lines]

    @property
    def first_to_mend(self) -> Verdict | None:
        """The verdict that the diagnosis repeats; else the first that failed.

        Failing that, the first that could not be given; None without any.
        """
        named = self.diagnosis.check if self.diagnosis is not None else ""
        of_diagnosis = next((v for v in self.verdicts if named and v.check == named), None)
        return of_diagnosis or next(
            (v for status in ("failed", "not_judged") for v in self.verdicts if v.status == status),
            None,
        )

    @property
    def headline(self) -> str:
        """One line: the cause of lost points, or what to mend first."""
        if self.diagnosis is not None:
            return translate(self.diagnosis.cause)
        first = self.first_to_mend
        if first is not None:
            return text.one_line(translate(first.rationale)) or f"{first.check}: {word(first)}"
        return wording.nothing_to_mend(len(self.verdicts), self._left_out)

    @property
    def first_line(self) -> str:
        """The headline, with what it is before it."""
        lost = self.diagnosis is not None or self.first_to_mend is not None
        return tr("Fix this first: {headline}", headline=self.headline) if lost else self.headline

    @property
    def first_key(self) -> str:
        """In a word what the headline is about: a check's name, or the diagnosis's key."""
        if self.diagnosis is not None:
            return self.diagnosis.check or self.diagnosis.key
        return self.first_to_mend.check if self.first_to_mend is not None else ""

    @property
    def advice(self) -> list[str]:
        """What belongs to the diagnosis, below the headline: where, and what to do."""
        found = self.diagnosis
        if found is None:
            return []
        lines = [tr("Where: {where}", where=self.where_first)] if self.where_first else []
        return [*lines, *([tr("What to do: {help}", help=found.help)] if found.help else [])]

    @property
    def where_first(self) -> str:
        """Where the diagnosis points to: 'drive.py, line 39, in on_pose: time.sleep(0.2)'."""
        place = self.diagnosis.place if self.diagnosis is not None else None
        if place is None:
            return ""
        at = {"file": place.file, "line": str(place.line), "function": place.function}
        if place.function:
            where = tr("{file}, line {line}, in {function}", **at)
        else:
            where = tr("{file}, line {line}", **at)
        return text.one_line(
            tr("{where}: {code}", where=where, code=place.text) if place.text else where
        )

    def outcome(self, run: int) -> str:
        """How a run ended, in a word or two: a key of `wording.OUTCOMES`."""
        summary = self.varied_runs[run - 1] if run else self.run
        if summary.outcome == "time_limit" and self._never_moved(run):
            return NOTHING_MOVED
        return summary.outcome.replace("_", " ")

    def _never_moved(self, run: int) -> bool:
        """Whether a recording is there that shows all things where they were at its start."""
        recording = self.recordings.get(run)
        if recording is None:
            return False
        tracks = load_subject(recording.scene).view(recording.trace).tracks
        ways = [way for track in tracks for way in (track.x, track.y, track.theta)]
        return bool(tracks) and all((way == way[:1]).all() for way in ways)

    @cached_property
    def recordings(self) -> dict[int, Recording]:
        """The recordings that there are, by run: 0 nominal, 1, 2, ... varied."""
        found = self.beside.recordings
        return {run: r for run, r in found.items() if isinstance(r, Recording)}

    @cached_property
    def subject(self) -> Subject:
        """What the runs are of; where it is not installed any more, the usual scene."""
        try:
            return load_subject(self.beside.scene)
        except KeyError:
            return load_subject(DEFAULT_SCENE)

    def no_recording(self, run: int) -> str:
        """Why a run has no recording."""
        reason = self.beside.recordings.get(run)
        if not isinstance(reason, Message):
            return tr("no recording lies beside it")
        return text.plain(translate(reason))

    @cached_property
    def output(self) -> str:
        """What the node printed in the nominal run."""
        return text.plain(self.beside.output)


def _waits(verdicts: Sequence[Verdict]) -> list[tuple[str, ...]]:
    """For each verdict, what it waited for."""
    status = {verdict.check: verdict.status for verdict in verdicts}
    return [
        tuple(name for name in verdict.depends_on if status.get(name, "passed") != "passed")
        if verdict.status == "not_judged"
        else ()
        for verdict in verdicts
    ]
