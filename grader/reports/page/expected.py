"""What checks want of a curve, in the curve's own plot: a band to stay in, lines to go beyond."""

from __future__ import annotations

from dataclasses import dataclass

from grader import text
from grader.language.telling import told
from grader.reports.page.plots import HEIGHT, Plot, Plots
from grader.reports.report import Report

_LONGEST = 160


@dataclass(frozen=True)
class Drawn:
    """What is wanted of one curve.

    Attributes:
        text: in words.
        bands: top and height of where it has to stay, as far as the plot shows it.
        lines: how high the values are that it has to go beyond.
    """

    text: str
    bands: tuple[tuple[float, float], ...]
    lines: tuple[float, ...]


def expected(report: Report, plots: Plots | None) -> dict[str, Drawn]:
    """Of the plots of the nominal run, by their titles."""
    if plots is None:
        return {}
    wanted = {told(each.curve): each for verdict in report.verdicts for each in verdict.expected}
    found = {}
    for plot in plots.curves:
        each = wanted.get(plot.title)
        if each is not None:
            bands, lines = _bands(plot, each.within), _lines(plot, each.beyond)
            found[plot.title] = Drawn(text.clip(text.plain(each.text), _LONGEST), bands, lines)
    return found


def _bands(plot: Plot, within: tuple[float, float] | None) -> tuple[tuple[float, float], ...]:
    if within is None:
        return ()
    low, high = (min(max(value, plot.bottom), plot.top) for value in within)
    return ((_y(plot, high), _y(plot, low) - _y(plot, high)),) if high > low else ()


def _lines(plot: Plot, beyond: tuple[float, float] | None) -> tuple[float, ...]:
    return tuple(_y(plot, value) for value in beyond or () if plot.bottom <= value <= plot.top)


def _y(plot: Plot, value: float) -> float:
    return HEIGHT * (plot.top - value) / (plot.top - plot.bottom)
