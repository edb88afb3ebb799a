import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from turtlesim_py.world.canvas import Canvas, Pen
from turtlesim_py.world.floats import PI
from turtlesim_py.world.picture import render, sprite
from turtlesim_py.world.turtle import SPRITES, Sprite

BLUE = (69, 86, 255)
MIDDLE = 250.5  # a picture of 45 pixels lies on whole pixels around it


def window(*turtles, background=BLUE):
    return render(Canvas(), background, turtles)


def changed(picture, background=BLUE):
    return (picture != background).any(axis=2)


def over(background, pixels):
    color, alpha = pixels[..., :3].astype(int), pixels[..., 3:].astype(int)
    return (color * alpha + np.array(background) * (255 - alpha) + 127) // 255


def test_the_path_lies_on_the_background():
    canvas = Canvas()
    canvas.draw_line(100.0, 100.0, 200.0, 100.0, Pen(9, 8, 7, 2))
    picture = render(canvas, BLUE, [])
    painted = canvas.rgba()[..., 3] == 255
    assert (picture[painted] == (9, 8, 7)).all()
    assert (picture[~painted] == BLUE).all()
    canvas.draw_line(100.0, 100.0, 200.0, 100.0, Pen(255, 255, 255, 2))
    assert tuple(render(canvas, BLUE, [])[100, 150]) == (255, 255, 255)
    assert (window(background=(1, 2, 3)) == (1, 2, 3)).all()
    before = canvas.rgba()
    render(canvas, BLUE, [Sprite(MIDDLE, MIDDLE, 0.0, "iron")])
    assert (canvas.rgba() == before).all()


@pytest.mark.parametrize("name", ["ardent", "rolling"])
@pytest.mark.parametrize(("heading_rad", "quarter_turns"), [(0.0, -1), (-PI, 1), (-PI / 2.0, 2)])
def test_a_turtle_looks_along_its_heading(name, heading_rad, quarter_turns):
    """To the right, to the left, down: the pictures look up, and `np.rot90` turns to the left."""
    picture = window(Sprite(MIDDLE, MIDDLE, heading_rad, name))
    expected = over(BLUE, np.rot90(sprite(name), quarter_turns))
    assert (picture[228:273, 228:273] == expected).all()
    assert changed(picture).sum() == changed(expected).sum()


def test_a_turtle_that_turned_left_from_0_looks_up():
    """Its angle is not exactly a quarter turn, so the picture lies a pixel further, as in Qt."""
    picture = window(Sprite(MIDDLE, MIDDLE, PI / 2.0, "foxy"))
    expected = over(BLUE, sprite("foxy"))
    assert any(
        (picture[228 + dy : 273 + dy, 228 + dx : 273 + dx] == expected).all()
        for dy in (0, 1)
        for dx in (0, 1)
    )


def test_a_turtle_between_the_quarters_keeps_its_centre_and_size():
    for heading_rad in np.linspace(-PI, PI, 30):
        mask = changed(window(Sprite(250.0, 250.0, heading_rad, "humble")))
        rows, columns = np.nonzero(mask)
        assert abs(mask.sum() - changed(over(BLUE, sprite("humble"))).sum()) < 60
        assert abs(rows.mean() + 0.5 - 250.0) < 2.0
        assert abs(columns.mean() + 0.5 - 250.0) < 2.0


def test_later_turtles_lie_over_earlier_ones():
    foxy, iron = (Sprite(MIDDLE, MIDDLE, 0.0, name) for name in ("foxy", "iron"))
    assert (window(foxy, iron)[250, 250] == window(iron)[250, 250]).all()
    assert (window(iron, foxy)[250, 250] == window(foxy)[250, 250]).all()


def test_a_turtle_at_the_edge_is_cut_off():
    whole = changed(window(Sprite(MIDDLE, MIDDLE, 0.0, "iron")))[228:273, 228:273]
    corner = changed(window(Sprite(0.5, 0.5, 0.0, "iron")))
    assert (corner[:23, :23] == whole[22:, 22:]).all()
    assert not corner[23:].any()
    assert not corner[:, 23:].any()
    corner = changed(window(Sprite(499.5, 499.5, 0.0, "iron")))
    assert (corner[477:, 477:] == whole[:23, :23]).all()
    assert corner.sum() == whole[:23, :23].sum()


@pytest.mark.parametrize("x", [-300.0, 800.0, 1e300, -1e300])
def test_a_turtle_far_outside_is_not_seen(x):
    assert not changed(window(Sprite(x, MIDDLE, 1.0, "iron"))).any()
    assert not changed(window(Sprite(MIDDLE, x, 1.0, "iron"))).any()


def test_a_turtle_that_is_nowhere_stands_in_the_first_corner_as_in_the_original():
    lost = window(Sprite(float("nan"), float("nan"), 0.0, "iron"))
    assert (lost == window(Sprite(22.5, 22.5, 0.0, "iron"))).all()


@pytest.mark.parametrize("heading_rad", [float("nan"), float("inf"), 1e308])
def test_a_turtle_without_a_heading_is_invisible_as_in_the_original(heading_rad):
    assert not changed(window(Sprite(MIDDLE, MIDDLE, heading_rad, "iron"))).any()


@given(st.floats(), st.floats(), st.floats(), st.sampled_from(SPRITES))
def test_any_turtle_can_be_shown(x_px, y_px, heading_rad, name):
    canvas = Canvas()
    picture = render(canvas, BLUE, [Sprite(x_px, y_px, heading_rad, name)])
    assert picture.shape == (500, 500, 3)
