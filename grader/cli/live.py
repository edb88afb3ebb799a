"""The page of `grader run --live`: opened before the first run, updated, and kept at the end.

A quick run is over before a page is open, so the first run waits for a viewer, for a while.
"""

from __future__ import annotations

import sys
import threading
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from typing import Any, Final, Self

from rich.console import Console
from rich.text import Text

from grader.errors import UsageError
from grader.exercise.exercise import Exercise
from grader.exercise.result.visible import is_hidden
from grader.recording.recording import Clock
from grader.reports import playback
from grader.reports.report import Report
from grader.run.handover import Plan
from grader.scenes.live import Grading, LivePage
from grader.scenes.playback import JudgedCheck
from grader.scenes.scene import Scene
from grader.text import strings as texts
from grader.text.message import Message, msg
from grader.text.strings import for_terminal
from grader.text.translations import tr, translate
from turtlesim_py import browser

#: A value of --speed -> how many times as fast as in real time, and that in words.
SPEEDS: Final[Mapping[str, tuple[float | None, Message]]] = {
    "1": (1.0, msg("as fast as in real time")),
    "5": (5.0, msg("five times as fast as in real time")),
    "free": (None, msg("as fast as it goes")),
}
#: The port of the page, unless it is in use.
USUAL_PORT: Final = 8080
#: How long the first run waits for a viewer [s].
PATIENCE_S: Final = 30.0


class Live:
    """The `Audience` of runs: a page that is served while the context is open.

    Args:
        speed: a key of `SPEEDS`.
    """

    def __init__(self, speed: str) -> None:
        self.speed, self._pace = SPEEDS[speed]
        self._page: LivePage | None = None
        self._plans: Sequence[Plan] = ()
        self._titles: Sequence[str] = ()  # the titles of the checks
        self._grading = Grading("")
        self._lock = threading.Lock()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        if self._page is not None:
            self._page.close()

    def open(
        self, exercise: Exercise, submission: str, plans: Sequence[Plan], messages: Console
    ) -> None:
        """Serve the page, print its address, wait for a viewer; later only show what is graded."""
        self._plans = plans
        is_first = self._page is None
        if is_first:
            self._page = _serve(exercise)
        name = texts.shown(submission)
        title = tr("{submission}, {exercise}", submission=name, exercise=exercise.title)
        when = tr("Verdicts come after the run.")
        if len(plans) > 1:
            when = tr("Verdicts come after the nominal run, some after the varied runs.")
        self._titles = [
            texts.shown(translate(check.title))
            for check in exercise.checks
            if not is_hidden(exercise.visible.get(check.name, "now"))
        ]
        self._change(Grading(title, score=when, judged=self._listed((), tr("after the run"))))
        if is_first:
            self._invite(messages)

    def _invite(self, messages: Console) -> None:
        assert self._page is not None
        address = self._page.address
        line = tr("See the runs at {address}", address=address)
        messages.print(Text(for_terminal(line)), soft_wrap=True)
        if tunnel := browser.tunnel(address):
            line = tr("To see it on your own machine, run there: {command}", command=tunnel)
            messages.print(Text(for_terminal(line)), soft_wrap=True)
        browser.show(address)
        wait = tr("Waiting for the page to be opened, {most_s:g} s at most ...", most_s=PATIENCE_S)
        messages.print(wait)
        if not self._page.await_viewer(PATIENCE_S):
            messages.print(tr("Nobody has opened the page yet; the run begins."))

    # An audience ------------------------------------------------------------------------------

    def begins(self, plan: Plan, time: Clock) -> None:
        """Show an empty window, and the name of the run."""
        kinds = [(each.start, each.case) for each in self._plans]
        number, varied = kinds.index((plan.start, plan.case)), len(kinds) - 1
        pace = msg("in real time") if time == "real" else self._pace
        run = tr("nominal run, {pace}", pace=pace)
        if number:
            run = tr(
                "varied run {number} of {runs} {begins}, {pace}",
                number=number,
                runs=varied,
                begins=msg("case {case}", case=plan.case)
                if plan.start is None
                else plan.start.words,
                pace=pace,
            )
        assert self._page is not None
        self._page.begin()
        self._change(run=run)

    def hear(self, news: Sequence[Mapping[str, Any]]) -> None:
        """Show what happens in the run."""
        assert self._page is not None
        self._page.hear(news)

    def ends(self, is_whole: bool) -> None:
        """Mark a run that could not be shown to its end."""
        if not is_whole:
            run = self._grading.run
            self._change(run=tr("{run} (not all of it could be shown)", run=run))

    # Verdicts ---------------------------------------------------------------------------------

    def know_of_nominal(self, report: Report) -> None:
        """Show the verdicts of the nominal run while the others go on."""
        score = tr("The nominal run is over, the others still go.")
        judged = self._listed(playback.judged(report, 1), tr("after the varied runs"))
        self._change(score=score, judged=judged)

    def know(self, report: Report) -> None:
        self._change(
            score=tr("Score: {score}", score=report.score_text),
            first=report.first_line,
            judged=playback.judged(report, len(self._plans)),
            is_over=True,
        )

    def _listed(self, judged: Sequence[JudgedCheck], when: str) -> tuple[JudgedCheck, ...]:
        """Return all checks, those that are not judged yet with the words for when they will be."""
        known = {check.title: check for check in judged}
        waiting = {title: JudgedCheck(title, "waiting", when, "", "", ()) for title in self._titles}
        return tuple({**waiting, **known}.values())

    def stay(self) -> None:
        """Keep the page until Ctrl-C, if this is a terminal."""
        if self._page is None or not sys.stderr.isatty():
            return
        line = tr("The page stays at {address}; Ctrl-C ends it.", address=self._page.address)
        with suppress(KeyboardInterrupt):  # from here on: Ctrl-C may come at once
            Console(stderr=True, highlight=False).print(Text(for_terminal(line)), soft_wrap=True)
            threading.Event().wait()

    def _change(self, grading: Grading | None = None, **known: Any) -> None:
        assert self._page is not None
        with self._lock:
            self._grading = replace(grading or self._grading, **known)
            self._page.update(self._grading)


def _serve(exercise: Exercise) -> LivePage:
    scene, page = exercise.subject, None
    for port in (USUAL_PORT, 0):
        try:
            page = scene.live_page(port) if isinstance(scene, Scene) else None
            break
        except OSError as error:
            why = error.strerror or str(error)
    else:
        raise UsageError("--live: no page can be served at 127.0.0.1 ({why})", why=why)
    if page is None:
        raise UsageError(
            "--live: runs of the exercise {exercise!r} cannot be shown, for its scene "
            "{scene!r} has no such page; its report.html shows what came of them",
            exercise=exercise.name,
            scene=exercise.scene,
        )
    return page
