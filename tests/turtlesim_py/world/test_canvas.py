import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from turtlesim_py.world.canvas import Canvas, Pen

WHITE = (255, 255, 255)
RED = Pen(255, 0, 0, 3)
BLUE = Pen(0, 0, 255, 3)


def painted(canvas):
    return int((canvas.rgba()[..., 3] == 255).sum())


def test_a_new_canvas_is_transparent_white_and_as_large_as_the_originals_and_so_its_pen():
    pixels = Canvas().rgba()
    assert pixels.shape == (500, 500, 4)
    assert pixels.dtype == np.uint8
    assert (pixels == (255, 255, 255, 0)).all()
    assert Pen() == Pen(0xB3, 0xB8, 0xFF, 3)


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ((256, 0, 0, 3), "pen r is 256, expected 0 to 255"),
        ((0, 0, -1, 3), "pen b is -1, expected 0 to 255"),
        ((0, 0, 0, 300), "pen width is 300, expected 0 to 255"),
    ],
)
def test_a_pen_outside_of_a_byte_is_refused(values, message):
    with pytest.raises(ValueError, match=message):
        Pen(*values)


def test_a_dot_is_painted_opaque_in_the_pens_colour():
    canvas = Canvas()
    canvas.draw_line(7.5, 4.5, 7.5, 4.5, Pen(1, 2, 3, 3))
    pixels = canvas.rgba()
    assert (pixels[3:6, 6:9] == (1, 2, 3, 255)).all()
    assert painted(canvas) == 9


def test_the_colour_under_a_point_is_that_of_the_nearest_pixel_number_halves_up():
    canvas = Canvas()
    canvas.draw_line(7.0, 9.0, 7.0, 9.0, Pen(9, 8, 7, 1))  # pixel 7, 9 alone
    for x, expected in [(6.49, WHITE), (6.5, (9, 8, 7)), (7.49, (9, 8, 7)), (7.5, WHITE)]:
        assert canvas.color_at(x, 9.0) == expected
        assert canvas.color_at(7.0, x + 2.0) == expected
    canvas.draw_line(0.0, 3.0, 0.0, 3.0, Pen(9, 8, 7, 1))
    assert canvas.color_at(float("nan"), 3.0) == (9, 8, 7)  # as pixel 0
    assert canvas.color_at(float("nan"), float("nan")) == WHITE


@given(st.floats(), st.floats())
def test_the_colour_of_an_unpainted_canvas_is_white_everywhere_and_outside_too(x, y):
    assert Canvas().color_at(x, y) == WHITE


@pytest.mark.parametrize("x", [-0.51, -1e300, float("-inf"), 499.5, 1e300, float("inf")])
def test_outside_of_a_painted_canvas_the_colour_is_white(x):
    canvas = Canvas()
    canvas.draw_line(0.0, 250.0, 500.0, 250.0, RED)
    assert canvas.color_at(499.49, 250.0) == canvas.color_at(-0.5, 250.0) == (255, 0, 0)
    assert canvas.color_at(x, 250.0) == WHITE


def test_a_copy_and_pixels_that_were_handed_out_have_a_life_of_their_own():
    canvas = Canvas()
    before = canvas.rgba()
    canvas.draw_line(10.0, 10.0, 20.0, 20.0, RED)
    assert (before[..., 3] == 0).all()
    canvas.rgba()[:] = 0
    assert canvas.color_at(15.0, 15.0) == (255, 0, 0)
    copy = canvas.copy()
    assert (copy.rgba() == canvas.rgba()).all()
    canvas.clear()
    assert (canvas.rgba() == Canvas().rgba()).all()
    assert painted(copy) > 0
    copy.clear()
    copy.draw_line(1.5, 1.5, 1.5, 1.5, BLUE)
    assert painted(canvas) == 0
