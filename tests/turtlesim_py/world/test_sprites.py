"""The turtles' pictures."""

import hashlib

import numpy as np
import pytest

from turtlesim_py.world.picture import sprite
from turtlesim_py.world.turtle import SPRITES


def test_there_is_a_picture_for_each_name_of_the_original_in_its_order():
    expected = "ardent bouncy crystal dashing eloquent foxy galactic humble iron jazzy rolling"
    assert " ".join(SPRITES) == expected


@pytest.mark.parametrize("name", SPRITES)
def test_a_picture_has_the_originals_size_and_free_corners(name):
    pixels = sprite(name)
    assert pixels.shape == (45, 45, 4)
    assert pixels.dtype == np.uint8
    assert not pixels[[0, 0, -1, -1], [0, -1, 0, -1], 3].any()
    assert 500 < (pixels[..., 3] == 255).sum() < 1300


@pytest.mark.parametrize("name", SPRITES)
def test_a_turtle_is_the_same_on_its_left_and_right(name):
    assert (sprite(name) == sprite(name)[:, ::-1]).all()


@pytest.mark.parametrize("name", SPRITES)
def test_a_turtle_looks_up(name):
    pupils = np.argwhere((sprite(name)[..., :3].max(axis=2) < 90) & (sprite(name)[..., 3] == 255))
    assert {row for row, column in pupils if 18 <= column <= 26} & set(range(3, 7))


def test_no_two_turtles_look_the_same():
    assert len({sprite(name).tobytes() for name in SPRITES}) == 11


def test_the_pictures_are_the_same_bytes_on_every_machine():
    """Whoever draws the turtles anew puts the new number here."""
    digest = hashlib.sha256(b"".join(sprite(name).tobytes() for name in SPRITES)).hexdigest()
    assert digest == "6b0395581f0f7b7538b023489cec535649807eeb2a87bd7632e321fb1b6bbe85"


def test_a_picture_is_drawn_once_and_cannot_be_spoilt():
    assert sprite("iron") is sprite("iron")
    with pytest.raises(ValueError, match="read-only"):
        sprite("iron")[0, 0, 0] = 1


def test_an_unknown_name_is_refused_with_the_names_that_exist():
    with pytest.raises(KeyError, match="'kilted', expected one of ardent, bouncy"):
        sprite("kilted")
