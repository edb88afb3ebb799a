"""Where varied runs start: a matter of the seed, at the distance that was asked for."""

import math

from hypothesis import given
from hypothesis import strategies as st

from grader.recording.subject import Start
from grader.scenes.turtlesim.scene import SCENE
from turtlesim_py.world.turtle import SIZE_M

starts = SCENE.starts

#: As every release so far has placed them.
FIRST_OF_2026 = [Start(6.223, 5.555, 0.074), Start(4.114, 4.468, -1.739)]


def test_places_are_a_matter_of_the_seed_and_the_same_in_every_release():
    assert starts(5, 2026, 0.5, 2.0)[:2] == starts(2, 2026, 0.5, 2.0) == FIRST_OF_2026
    assert not set(starts(5, 1, 0.5, 2.0)) & set(starts(5, 2, 0.5, 2.0))
    assert starts(0, 2026, 0.5, 2.0) == []


@given(seed=st.integers(), nearest=st.floats(0, 2), more=st.floats(0, 2))
def test_every_place_is_as_far_as_was_asked_for_and_easily_typed(seed, nearest, more):
    for start in starts(4, seed, nearest, nearest + more):
        assert all(value == round(value, 3) for value in (start.x, start.y, start.theta))
        distance = math.dist((start.x, start.y), (SIZE_M / 2, SIZE_M / 2))
        assert nearest - 0.001 <= distance <= nearest + more + 0.001
        assert -math.pi - 0.001 <= start.theta <= math.pi + 0.001
