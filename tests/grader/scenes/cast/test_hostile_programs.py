"""A program that misuses a cast ends within the limits, earns what it does, and breaks nothing."""

import json
from pathlib import Path

import pytest

from grader.exercise.loading import load_exercise
from tests import runs
from tests.tiers import others_are_more

EVERYTHING = load_exercise(Path(__file__).parent / "everything")
#: What each may earn: what it does is right, or shows nothing.
EARNED = {
    "poses_as_a_peer": {"got"},
    "forges_events": set[str](),
    "sends_odd_values": {"got"},
    "has_odd_types": {"got"},
    "serves_badly": {"out", "got"},
    "takes_the_peers_place": {"got"},
    "floods_a_topic": set[str](),
    "floods_with_texts": set[str](),
    "floods_peers": set[str](),
    "floods_the_graph": set[str](),
}


def graded(name):
    return runs.graded(f"hostile_casts/{name}", EVERYTHING)


def said(result, check):
    return next(str(each.rationale) for each in result.verdicts if each.check == check)


def test_who_does_all_gets_all():
    assert graded("does_all").score == 100


@pytest.mark.parametrize(
    "name",
    others_are_more(
        "names, values and a flood stand for the rest",
        EARNED,
        *("poses_as_a_peer", "sends_odd_values", "floods_with_texts"),
    ),
)
def test_a_hostile_program_earns_only_what_it_does(name):
    result = graded(name)
    assert result.run.time == "virtual"
    assert {each.check for each in result.verdicts if each.score} <= EARNED[name]
    assert r"\u001b" not in json.dumps(result.to_json())


def test_who_is_called_like_a_peer_hides_nothing():
    result = graded("poses_as_a_peer")
    assert "Nothing subscribes to /data" in said(result, "out")
    assert "data was 'hidden', expected 'Hello 0'" in said(result, "chatter")


def test_what_a_peer_cannot_use_is_a_finding():
    result = graded("sends_odd_values")
    assert "b was 0, expected 3" in said(result, "served")
    assert "has no parameter p" in said(result, "asks")


def test_what_lies_behind_a_flood_is_not_taken_for_right():
    result = graded("floods_with_texts")
    assert any("of what was exchanged, the first" in str(flag) for flag in result.run.flags)
    assert "was recorded" in said(result, "chatter")
