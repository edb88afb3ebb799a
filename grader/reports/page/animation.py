"""What moves in a page: the tracks of a run, sampled and divided by pen, and a solid."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from grader.scenes.view import Floats, PenChange, Placing, Shape, Solid, Times, Track, View

#: A track has no more samples than this, however long the run.
_SAMPLES = 1000
#: More tracks than this are not drawn; a submission can spawn any number.
_TRACKS = 5
Stretch = tuple[int, int, PenChange]


@dataclass(frozen=True)
class SampledTrack:
    """One track at the samples of an animation.

    Attributes:
        x, y: where it was at each sample [px, y down]; NaN where it was not there.
        theta: its heading at each sample [rad].
        stretches: the track in parts: from sample to sample, with the pen there.
    """

    x: Floats
    y: Floats
    theta: Floats
    stretches: tuple[Stretch, ...]

    def path(self) -> str:
        return svg_path(self.x, self.y)

    def lifted(self) -> str:
        """Return the stretches on which the pen was off as the `d` of an SVG path."""
        return "".join(
            svg_path(self.x[first : last + 1], self.y[first : last + 1])
            for first, last, pen in self.stretches
            if not pen.drawn
        )


@dataclass(frozen=True)
class Animation:
    """All tracks of a run at common samples.

    Attributes:
        times: of the samples [s].
        tracks: the one of the exercise first.
        cleared: samples at which everything drawn before vanished.
        view: what they are of.
    """

    times: Floats
    tracks: tuple[SampledTrack, ...]
    cleared: tuple[int, ...]
    view: View


def animation(view: View, duration_ns: int) -> Animation:
    """Sample the tracks of a view.

    Args:
        duration_ns: how long was recorded.
    """
    times_ns = _samples(duration_ns, view.step_ns)
    return Animation(
        times_ns / 1e9,
        tuple(_sampled(track, times_ns) for track in view.tracks[:_TRACKS]),
        tuple(sorted({int(np.searchsorted(times_ns, time_ns)) for time_ns in view.cleared})),
        view,
    )


def svg_path(x: Floats, y: Floats) -> str:
    """Draw a line through points, interrupted where one is not finite."""
    parts: list[str] = []
    pen_down = False
    for a, b in zip(x.round(1).tolist(), y.round(1).tolist(), strict=True):
        if np.isfinite(a) and np.isfinite(b):
            parts.append(f"{'L' if pen_down else 'M'}{a:g} {b:g}")
            pen_down = True
        else:
            pen_down = False
    return "".join(parts)


def _samples(duration_ns: int, step_ns: int) -> Times:
    """Return the times of the samples [ns]: evenly spaced, and the last step."""
    steps = duration_ns // step_ns
    each = max(1, -(-steps // _SAMPLES))
    samples = np.arange(1, steps + 1, each, dtype=np.int64)
    if steps and samples[-1] != steps:
        samples = np.append(samples, steps)
    return samples * step_ns


def _sampled(track: Track, times_ns: Times) -> SampledTrack:
    at = np.searchsorted(track.times_ns, times_ns)
    there = np.isin(times_ns, track.times_ns)
    sampled = np.full((3, len(times_ns)), np.nan)
    sampled[:, there] = np.array([track.x, track.y, track.theta])[:, at[there]]
    x, y, theta = sampled
    return SampledTrack(x, y, theta, _stretches(track, times_ns))


def _stretches(track: Track, times_ns: Times) -> tuple[Stretch, ...]:
    """Divide a track by pens; of several changes between two samples the last counts."""
    pen, *later = track.pens
    changes = {int(np.searchsorted(times_ns, change.time_ns)): change for change in later}
    stretches: list[Stretch] = []
    start = 0
    for sample, change in [*sorted(changes.items()), (len(times_ns) - 1, None)]:
        # The stroke that leads to the sample of a change has the new colour already.
        end = max(sample - 1, start) if change else sample
        if end > start:
            stretches.append((start, end, pen))
        start = end
        pen = change or pen
    return tuple(stretches)


# Solids -----------------------------------------------------------------------------------------

#: Kept decimals: of a place [m], of a quaternion, of a size [m].
_PLACE, _TURN, _SIZE = 4, 4, 5
_KINDS = {"box": 0, "cylinder": 1, "sphere": 2, "triangles": 3}


def solid_data(solid: Solid) -> dict[str, Any]:
    """Return a solid as the script reads it.

    `t` are the times [s], `frames` each its parent and placings, `shapes` each its kind, frame,
    placing, sizes, colour and alpha; `ground` and `way`.
    """
    return {
        "t": [round(time_ns / 1e9, 2) for time_ns in solid.times_ns],
        "frames": [
            [frame.parent, [_placing(each) for each in frame.placings]] for frame in solid.frames
        ],
        "shapes": [_shape(each) for each in solid.shapes],
        "ground": None if solid.ground_m is None else round(solid.ground_m, _PLACE),
        "way": solid.way.round(3).tolist(),
    }


def _shape(shape: Shape) -> list[Any]:
    sizes = [round(size, _SIZE) for size in shape.sizes]
    placing = _placing(shape.placing)
    return [_KINDS[shape.kind], shape.frame, placing, sizes, shape.color, round(shape.alpha, 2)]


def _placing(placing: Placing | None) -> list[float] | None:
    if placing is None:
        return None
    at = [round(value, _PLACE) + 0.0 for value in placing.at]
    return [*at, *(round(value, _TURN) + 0.0 for value in placing.turned)]
