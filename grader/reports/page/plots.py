"""Plots over time as SVG: curves are thinned out to some kB, however long the run.

What checks expect of a curve is drawn in its plot: a band to stay in, lines to go beyond.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from grader.reports.page.animation import svg_path
from grader.reports.report import Report
from grader.scenes.view import Call, Curve, Floats, View
from grader.text import strings as text
from grader.text.translations import tr, translate

#: A curve is drawn in a box of this size, which the page stretches. Two points a column.
WIDTH, HEIGHT = 500, 100
_COLUMNS = 400
#: Marks of one service closer than this share of the time axis are drawn as one.
_MARKS = 400
_SERVICES = 8
#: More calls of one service than this are not listed in words.
_ROWS = 12


@dataclass(frozen=True)
class Tick:
    """A labelled place on an axis, `at` in percent from its start."""

    at: float
    label: str


@dataclass(frozen=True)
class Plot:
    """A curve over time.

    Attributes:
        title, unit: of the curve.
        path: the `d` of an SVG path in a box of WIDTH x HEIGHT.
        ticks: of the value axis.
        summary: the plot in words.
        bottom, top: the values at the box's edges.
    """

    title: str
    unit: str
    path: str
    ticks: tuple[Tick, ...]
    summary: str
    bottom: float
    top: float


@dataclass(frozen=True)
class Mark:
    """Calls at one moment, `at` in percent of the time; `color` where a call names one."""

    at: float
    color: str


@dataclass(frozen=True)
class Calls:
    """The calls of one service.

    Attributes:
        name: the service's.
        count: how many there were.
        marks: all that can be distinguished in the plot.
        rows: the first of them.
    """

    name: str
    count: int
    marks: tuple[Mark, ...]
    rows: tuple[Call, ...]

    @property
    def has_text(self) -> bool:
        return any(row.text for row in self.rows)

    @property
    def has_place(self) -> bool:
        return any(row.where for row in self.rows)


@dataclass(frozen=True)
class Plots:
    """Everything over time that a page shows of a run; all with the same time axis."""

    duration_s: float
    time_ticks: tuple[Tick, ...]
    curves: tuple[Plot, ...]
    calls: tuple[Calls, ...]


def plots(view: View, duration_ns: int) -> Plots | None:
    """Return the plots of a view; None if there is nothing in it.

    Args:
        duration_ns: how long was recorded.
    """
    if not view.curves or not duration_ns:
        return None
    duration_s = duration_ns / 1e9
    curves = tuple(_plot(curve, curve.times_ns / duration_ns * WIDTH) for curve in view.curves)
    time_ticks = tuple(
        Tick(100 * value / duration_s, f"{value:g}")
        for value in _nice(0, duration_s, 6)
        if value <= duration_s
    )
    return Plots(duration_s, time_ticks, curves, _calls(view.calls, duration_ns))


def _plot(curve: Curve, x: Floats) -> Plot:
    values = curve.values
    finite = values[np.isfinite(values)]
    low, high = (float(finite.min()), float(finite.max())) if len(finite) else (0.0, 0.0)
    steps = _nice(min(low, 0.0), max(high, 0.0), 4)
    bottom, top = steps[0], steps[-1]
    y = (top - values) / (top - bottom) * HEIGHT
    labels = tuple(Tick(100 * (v - bottom) / (top - bottom), f"{v:g}") for v in steps)
    title, unit = translate(curve.title), curve.unit
    summary = tr(
        "{title}: from {low:.3g} to {high:.3g} {unit}", title=title, low=low, high=high, unit=unit
    )
    path = svg_path(*_thinned(x, y))
    return Plot(title, unit, path, labels, summary, bottom, top)


def _thinned(x: Floats, y: Floats) -> tuple[Floats, Floats]:
    """Keep at most four points a column: its first, lowest, highest and last; none is smoothed."""
    if len(x) <= 2 * _COLUMNS:
        return x, y
    chosen = set[int]()
    for column in np.array_split(np.arange(len(x)), _COLUMNS):
        chosen |= {int(column[0]), int(column[-1])}
        if len(finite := column[np.isfinite(y[column])]):
            chosen |= {int(finite[np.argmin(y[finite])]), int(finite[np.argmax(y[finite])])}
    rows = np.array(sorted(chosen))  # np.unique would import masked arrays
    # A point in the middle of a level line adds nothing.
    inner = (y[rows[1:-1]] == y[rows[:-2]]) & (y[rows[1:-1]] == y[rows[2:]])
    rows = rows[~np.concatenate(([False], inner, [False]))]
    return x[rows], y[rows]


def _calls(made: Sequence[Call], duration_ns: int) -> tuple[Calls, ...]:
    by_service: dict[str, list[Call]] = defaultdict(list)
    for call in made:
        by_service[call.name].append(call)
    listed = sorted(by_service.items(), key=lambda item: -len(item[1]))[:_SERVICES]
    return tuple(
        Calls(
            name,
            len(calls),
            _sparse([Mark(100 * call.time_ns / duration_ns, call.color) for call in calls]),
            tuple(calls[:_ROWS]),
        )
        for name, calls in listed
    )


def _sparse(marks: list[Mark]) -> tuple[Mark, ...]:
    """Keep one mark of those that are too close to distinguish."""
    last = {round(mark.at * _MARKS / 100): mark for mark in marks}
    return tuple(Mark(round(mark.at, 2), mark.color) for mark in last.values())


def _nice(low: float, high: float, about: int) -> list[float]:
    """Return round numbers in even steps, from at most `low` to at least `high`."""
    span = high - low or 1.0
    raw = span / about
    power = 10.0 ** math.floor(math.log10(raw))
    step = power * next((m for m in (1, 2, 5) if m * power >= raw), 10)
    first, last = math.floor(low / step + 1e-9), math.ceil((low + span) / step - 1e-9)
    return [round(step * k, 12) for k in range(first, last + 1)]


# What checks expect of a curve --------------------------------------------------------------------

_LONGEST = 160


@dataclass(frozen=True)
class Drawn:
    """The expectation on one curve, as drawn.

    Attributes:
        text: in words.
        bands: top and height of the band that it has to stay in, within the plot.
        lines: heights of the values that it has to go beyond.
    """

    text: str
    bands: tuple[tuple[float, float], ...]
    lines: tuple[float, ...]


def expected(report: Report, plots: Plots | None) -> dict[str, Drawn]:
    """Return the expectations on the nominal run's curves, by the titles of their plots."""
    if plots is None:
        return {}
    wanted = {
        translate(each.curve): each for verdict in report.verdicts for each in verdict.expected
    }
    return {
        plot.title: Drawn(
            text.clip(text.plain(translate(each.text)), _LONGEST),
            _bands(plot, each.within),
            _lines(plot, each.beyond),
        )
        for plot in plots.curves
        if (each := wanted.get(plot.title)) is not None
    }


def _bands(plot: Plot, within: tuple[float, float] | None) -> tuple[tuple[float, float], ...]:
    if within is None:
        return ()
    low, high = (min(max(value, plot.bottom), plot.top) for value in within)
    return ((_y(plot, high), _y(plot, low) - _y(plot, high)),) if high > low else ()


def _lines(plot: Plot, beyond: tuple[float, float] | None) -> tuple[float, ...]:
    return tuple(_y(plot, value) for value in beyond or () if plot.bottom <= value <= plot.top)


def _y(plot: Plot, value: float) -> float:
    return HEIGHT * (plot.top - value) / (plot.top - plot.bottom)
