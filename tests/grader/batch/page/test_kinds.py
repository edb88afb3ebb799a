"""Two sentences are of one kind where they differ in what is a student's own."""

from __future__ import annotations

import pytest

from grader.batch.page.kinds import kind_of

ALIKE = {
    "numbers": (
        "It came to rest 4.95 m from the nearest wall; 2.1 m or less is near.",
        "It came to rest 12 m from the nearest wall; 2.1 m or less is near.",
    ),
    "signs": ("It changed by -0.07 m.", "It changed by 1,034 m."),
    "files and lines": (
        "Your node crashed at 6.0 s: ZeroDivisionError: division by zero (alice.py, line 54).",
        "Your node crashed at 0.5 s: ZeroDivisionError: division by zero (pkg/bob.py, line 7).",
    ),
    "what is quoted": (
        "AttributeError: 'Pose' object has no attribute 'z'",
        "AttributeError: 'My_Node' object has no attribute 'pen's'",
    ),
    "topics and types": (
        "You publish geometry_msgs/msg/Twist on /turtle/cmd_vel, where nobody listens.",
        "You publish std_msgs/msg/String on /cmd, where nobody listens.",
    ),
    "places and colours": (
        "Quadrants I and III are both white (255, 255, 255).",
        "Quadrants II and IV are both red (255, 0, 0).",
    ),
    "how many there are": (
        "There is next to nothing drawn in quadrant I (top right), II (top left).",
        "There is next to nothing drawn in quadrant III (bottom left).",
    ),
    "how often it is said": (
        "Quadrant I is all red (255, 0, 0). Quadrant IV is all blue (0, 0, 255).",
        "Quadrant II is all red (255, 0, 0).",
    ),
    "sides": ("It ran into the left wall at 5 s.", "It ran into the right wall at 6.25 s."),
    "addresses": ("<Node at 0x7f00aa>", "<Node at 0x1>"),
}


@pytest.mark.parametrize("pair", ALIKE.values(), ids=ALIKE.keys())
def test_these_are_alike(pair):
    assert kind_of(pair[0]) == kind_of(pair[1])


def test_other_words_are_another_kind():
    said = [one for pair in ALIKE.values() for one in pair]
    assert len({kind_of(sentence) for sentence in said}) == len(ALIKE)


def test_words_stay():
    assert kind_of("The pen was never changed.") == "The pen was never changed."


@pytest.mark.parametrize("part", ["'", "(", "/a", "1", "ab and ", "N, ", "a" * 31 + ", ", "\x1b["])
def test_a_sentence_made_to_be_slow_is_cut_off(part):
    assert len(kind_of(part * 100_000)) <= 1200
