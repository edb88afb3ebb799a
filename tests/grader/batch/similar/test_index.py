"""The inverted index finds what a comparison of each two would find, and ends in any class."""

import math
import random
from itertools import combinations

import numpy as np

from grader.batch.similar import index
from grader.batch.similar.index import Index, at_least


def sets_of(size, seed=1):
    chance = random.Random(seed)
    passages = [range(100 * n, 100 * n + 30) for n in range(8)]
    made = []
    for _ in range(size):
        own = chance.sample(range(10_000, 10**9), 20)
        made.append({*own, *chance.choice(passages), *chance.choice(passages)})
    return [*made, made[0], made[0], set()]


def test_it_finds_what_comparing_each_two_would_find():
    sets = sets_of(40)
    found = Index(sets)
    pairs = found.pairs(5)
    rows = zip(pairs.first.tolist(), pairs.second.tolist(), strict=True)
    by_kinds = {kinds: row for row, kinds in enumerate(rows)}
    weight = {
        each: math.log2(1 + len(sets) / sum(each in one for one in sets))
        for each in set().union(*sets)
    }
    for a, b in combinations(range(len(sets)), 2):
        both = sets[a] & sets[b]
        row = by_kinds.get(tuple(sorted((int(found.kind[a]), int(found.kind[b])))))
        assert (row is not None) == (len(both) >= 5)
        if row is not None:
            bits = sum(weight[each] for each in both)
            lighter = min(sum(weight[e] for e in sets[n]) for n in (a, b))
            assert pairs.count[row] == len(both)
            assert math.isclose(pairs.bits[row], bits)
            assert math.isclose(pairs.share[row], bits / lighter, abs_tol=1e-5)


def test_every_pair_of_sets_is_counted_once():
    found = Index(sets_of(20))
    all_of_them = found.pairs(0)
    assert found.stands_for(all_of_them).sum() <= found.pairs_in_all
    equal = all_of_them.first == all_of_them.second
    assert found.stands_for(all_of_them)[equal].tolist() == [3, 0][: equal.sum()]


def test_what_too_many_have_is_not_followed_and_the_rest_is(monkeypatch):
    monkeypatch.setattr(index, "MOST_STEPS", 100)
    common, rare = range(100), {1000, 1001, 1002}
    sets = [{*common, 5000 + n} for n in range(50)]
    sets[3] |= rare
    sets[9] |= rare
    found = Index(sets)
    pairs = found.pairs(3)
    assert (pairs.first.tolist(), pairs.second.tolist(), pairs.count.tolist()) == ([3], [9], [3])
    assert not found.followed.all()


def test_a_class_of_thousands_of_equal_hand_ins_is_one_kind():
    found = Index([{1, 2, 3}] * 5000)
    pairs = found.pairs(2)
    assert len(pairs.first) == 1
    assert found.stands_for(pairs).tolist() == [found.pairs_in_all]


def test_an_empty_class_has_no_pairs():
    assert len(Index([]).pairs(0).first) == len(Index([set()]).pairs(1).first) == 0


def test_at_least_counts_by_weight():
    values, weights = np.array([0.5, 1.0, 0.7]), np.array([10, 1, 5])
    assert at_least(values, weights, values).tolist() == [16, 1, 6]
