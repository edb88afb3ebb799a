import hashlib

import pytest

from turtlesim_py.world.picture import sprite
from turtlesim_py.world.turtle import SPRITES


def test_there_is_a_picture_for_each_name_of_the_original_in_its_order():
    expected = "ardent bouncy crystal dashing eloquent foxy galactic humble iron jazzy rolling"
    assert " ".join(SPRITES) == expected


def test_the_pictures_are_the_same_bytes_on_every_machine():
    """Of the original's size; whoever draws the turtles anew puts the new number here."""
    assert {sprite(name).shape for name in SPRITES} == {(45, 45, 4)}
    digest = hashlib.sha256(b"".join(sprite(name).tobytes() for name in SPRITES)).hexdigest()
    assert digest == "6b0395581f0f7b7538b023489cec535649807eeb2a87bd7632e321fb1b6bbe85"


def test_a_picture_is_read_once_and_cannot_be_spoilt():
    assert sprite("iron") is sprite("iron")
    with pytest.raises(ValueError, match="read-only"):
        sprite("iron")[0, 0, 0] = 1


def test_an_unknown_name_is_refused_with_the_names_that_exist():
    with pytest.raises(KeyError, match="'kilted', expected one of ardent, bouncy"):
        sprite("kilted")
