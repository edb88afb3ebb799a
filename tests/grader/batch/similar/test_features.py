"""Behaviour alone lists two only where it is unusual in a class that is large enough to tell."""

import random
from itertools import combinations

import pytest

from grader.batch.similar.compare import (
    FEWEST,
    LARGE_CLASS,
    LEAST_SHARE,
    Commands,
    Compared,
    compare,
    equal,
    grams,
)
from grader.batch.similar.features import POINTS, Features, TimedCommand


def behaves(number, end_mm=4000, step=31):
    """Somebody with commands and a way of his own kind, and nothing else."""
    commands = tuple(TimedCommand(step * n, 100 * number + n) for n in range(20))
    path = tuple(value for n in range(POINTS) for value in (n * end_mm // POINTS, number * n))
    return Compared("", Features((), commands, path))


def listed(handed_in):
    return [(pair.first, pair.second) for pair in compare(handed_in).pairs]


def usual(many):
    """Three ways to do it, each of which many have chosen."""
    return [behaves(n % 3, 4000 + 500 * (n % 3)) for n in range(many)]


def test_a_behaviour_that_many_have_lists_nobody():
    assert listed(usual(60)) == []


def test_a_behaviour_that_two_have_and_nobody_else_lists_them():
    assert listed([*usual(60), behaves(50), behaves(50)]) == [(60, 61)]


def test_in_a_small_class_it_lists_nobody():
    assert listed([*usual(LARGE_CLASS - 3), behaves(50), behaves(50)]) == []


def test_ways_that_are_nearly_the_same_are_found_though_no_command_is():
    near = behaves(50)
    other = Compared("", Features((), behaves(51).features.commands, near.features.path))
    (pair,) = compare([*usual(60), near, other]).pairs
    assert (pair.first, pair.second, pair.path_mm, pair.equal_commands) == (60, 61, 0, 0.0)


def test_who_did_nothing_is_like_nobody():
    nothing = Compared("", Features())
    assert listed([*usual(60), nothing, nothing, Compared("", None)]) == []


def test_commands_of_which_nearly_all_are_the_same_are_alike():
    one = behaves(50).features.commands
    other = (*one[:19], TimedCommand(31 * 19, 7))
    other_way = behaves(51, 8000).features.path
    changed = Compared("", Features((), other, other_way))
    (pair,) = compare([*usual(60), behaves(50), changed]).pairs
    assert (pair.first, pair.second, pair.commands_hands) == (60, 61, 2)


def test_commands_of_any_two_are_alike_if_nearly_all_are_the_same_and_never_otherwise():
    chance = random.Random(1)
    originals = [[chance.randrange(1000) for _ in range(many)] for many in (9, 40, 90)]
    of_each = []
    for number in range(90):
        hashes = list(originals[number % 3][: -chance.randrange(1, 5)])
        for _ in range(chance.randrange(3)):
            hashes[chance.randrange(len(hashes))] = chance.randrange(1000)
        of_each.append([TimedCommand(31 * n, each) for n, each in enumerate(hashes)])
    found, expected = Commands(of_each), set()
    for first, second in combinations(range(len(of_each)), 2):
        one, other = grams(of_each[first]), grams(of_each[second])
        if len(one & other) >= max(FEWEST, LEAST_SHARE * max(len(one), len(other))):
            expected.add((first, second))
    assert {pair for pair in combinations(range(90), 2) if found.hands(*pair)} == expected
    assert 50 < len(expected) < 1000
    assert set(found.pairs(90)) == expected


def test_what_three_in_a_class_of_sixty_do_lists_nobody():
    assert listed([*usual(60), behaves(50), behaves(50), behaves(50)]) == []


def test_how_many_others_behave_so_is_told():
    found = compare([*usual(60), behaves(50), behaves(50)]).pairs[0]
    assert (found.commands_hands, found.path_hands) == (2, 2)


@pytest.mark.parametrize(
    ("one", "other", "time_ns", "share"),
    [
        ([(0, 1), (31, 2), (62, 3)], [(0, 1), (31, 2), (62, 3)], 62, 1.0),
        ([(0, 1), (31, 2), (62, 3)], [(0, 1), (31, 2), (62, 4)], 62, 0.6667),
        ([(0, 1), (31, 2), (62, 3)], [(0, 1), (30, 2), (62, 3)], 30, 0.6667),
        ([(0, 1), (31, 2)], [(0, 1)], 31, 0.5),
        ([], [(0, 1)], 0, 0.0),
    ],
)
def test_commands_are_compared_one_by_one(one, other, time_ns, share):
    both = ([TimedCommand(*each) for each in commands] for commands in (one, other))
    assert equal(*both) == (time_ns / 1e9, share)
