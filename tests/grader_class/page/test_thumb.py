import base64
import io
import json
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from PIL import Image

from grader.recording.recording import Recordings
from grader_class.page.thumb import (
    EDGE_PX,
    PICTURE_BYTES,
    SCHEMA,
    THUMB,
    UNITS,
    Thumb,
    pieces,
    simplified,
    thumb,
)
from tests.grader.driving import Spiral, drive
from turtlesim_py.world.turtle import SIZE_M


@pytest.fixture(scope="module")
def spiral():
    return Recordings(drive(Spiral()))


def read(folder, data):
    (folder / THUMB).write_bytes(data)
    return Thumb.read(folder)


def test_it_is_the_picture_and_the_way_of_the_nominal_run(spiral, tmp_path):
    made = read(tmp_path, thumb(spiral))
    assert thumb(spiral) == thumb(Recordings(drive(Spiral())))
    with Image.open(io.BytesIO(base64.b64decode(made.picture.partition(",")[2]))) as picture:
        assert picture.size == (EDGE_PX, EDGE_PX)
    (piece,) = made.path
    way = next(iter(spiral.nominal.trace.trajectories.values()))
    end = (way.x[-1] / SIZE_M * UNITS, UNITS - way.y[-1] / SIZE_M * UNITS)
    assert piece[-2:] == pytest.approx(end, abs=2)
    assert 50 < len(piece) // 2 <= 300
    assert len(made.picture) < 6000


def test_noise_weighs_no_more_than_a_spiral_may(spiral, tmp_path):
    trace = spiral.nominal.trace
    noise = np.random.default_rng(1).integers(0, 256, trace.window.shape, dtype=np.uint8)
    loud = Recordings(replace(spiral.nominal, trace=replace(trace, window=noise)))
    made = read(tmp_path, thumb(loud))
    assert len(base64.b64decode(made.picture.partition(",")[2])) <= PICTURE_BYTES


def test_a_way_of_no_end_has_few_corners(spiral, tmp_path):
    trace = spiral.nominal.trace
    (name,) = trace.trajectories
    way = trace.trajectories[name]
    rng = np.random.default_rng(1)
    wild = replace(way, x=rng.uniform(0, SIZE_M, len(way)), y=rng.uniform(0, SIZE_M, len(way)))
    lost = replace(trace, trajectories={name: wild})
    made = read(tmp_path, thumb(Recordings(replace(spiral.nominal, trace=lost))))
    assert sum(len(piece) // 2 for piece in made.path) <= 301


def test_an_svg_path_says_the_same_in_steps():
    path = ((0, 0, 10, 5, 7, 9), (1000, 1000, 999, 1000))
    assert Thumb("", "", path).svg() == "M0 0l10 5-3 4M1000 1000l-1 0"


PNG = "data:image/png;base64,iVBORw0KGgo="
GOOD = {"schema": SCHEMA, "picture": PNG, "words": "", "path": [[0, 0, 1, 1]]}


@pytest.mark.parametrize(
    "spoiled",
    [
        {"schema": "other/v1"},
        {"picture": 1},
        {"picture": "https://example.org/a.png"},
        {"picture": 'data:image/png;base64,"><script>'},
        {"picture": "data:image/png;base64,PHN2Zz4="},
        {"picture": PNG[:-4] + "A" * 20_000},
        {"path": {}},
        {"path": [[0, 0]]},
        {"path": [[0, 0, 1]]},
        {"path": [[0, 0, 1, 1001]]},
        {"path": [[0, 0, 1, True]]},
        {"path": [[0, 0, 1, '"']]},
    ],
)
def test_what_is_damaged_is_not_shown(spoiled, tmp_path):
    assert read(tmp_path, json.dumps(GOOD).encode()) is not None
    assert read(tmp_path, json.dumps(GOOD | spoiled).encode()) is None


def test_what_is_no_json_or_not_there_or_too_long_is_not_shown(tmp_path):
    assert Thumb.read(tmp_path) is None
    for data in (b"", b"\xff", b"[" * 30_000, json.dumps(GOOD).encode() + b" " * 50_000):
        assert read(tmp_path, data) is None


def off(points, line):
    starts, ways = line[:-1], np.diff(line, axis=0)
    squared = np.maximum((ways**2).sum(axis=1), 1e-300)
    along = ((points[:, None] - starts) * ways).sum(axis=2) / squared
    nearest = starts + np.clip(along, 0, 1)[..., None] * ways
    return np.linalg.norm(points[:, None] - nearest, axis=2).min(axis=1).max()


@given(
    arrays(
        np.float64,
        st.tuples(st.integers(2, 30), st.just(2)),
        elements=st.integers(0, 1000).map(float),
    )
)
def test_no_point_is_farther_off_than_the_tolerance(points):
    line = simplified(points, 5.0)
    assert len(line) <= len(points)
    assert np.array_equal(line[[0, -1]], points[[0, -1]])
    assert off(points, line) <= 5.0 + 1e-6


def test_a_straight_line_is_its_two_ends_and_cut_where_it_was_nowhere():
    points = np.column_stack([np.arange(100.0), np.arange(100.0)])
    assert simplified(points, 0.5).tolist() == [[0, 0], [99, 99]]
    x = np.array([np.nan, 1, 2, np.inf, 3, np.nan, 4, 5])
    assert [piece.tolist() for piece in pieces(x, x)] == [[[1, 1], [2, 2]], [[4, 4], [5, 5]]]
    assert pieces(x[:0], x[:0]) == []
