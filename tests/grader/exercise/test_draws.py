"""Values that an exercise draws: each run has its own, and the recording keeps them."""

import re

import pytest

import grader
from grader.errors import ExerciseError
from grader.exercise.draws import draw, put_in, read_draws
from grader.exercise.loading import load_exercise
from grader.system.expressions import filled
from tests.files import lay

DRAWS = {
    "a": {"integer": [1, 99], "example": 2},
    "x": {"number": [0.5, 2], "example": 1.0},
    "word": {"word": 6, "example": "orange"},
    "side": {"one_of": ["left", "right"], "example": "left"},
}
YAML = """
exercise: adds
title: It adds
scene: graph
draw: {a: {integer: [1, 99], example: 2}}
cast:
  caller:
    calls: {one: {service: add, type: example_interfaces/srv/AddTwoInts, request: REQUEST}}
limits: {first_motion_s: 5, rest_s: 0, total_s: 3}
cases: CASES
expect: {sums: {call: one, response: {sum: RESPONSE}}}
points: {sums: 1}
"""


def test_a_run_has_the_same_values_each_time_and_another_run_or_seed_has_others():
    draws = read_draws({"draw": DRAWS})
    runs = [draw(draws, seed, run) for seed in range(5) for run in range(5)]
    assert runs == [draw(draws, seed, run) for seed in range(5) for run in range(5)]
    assert len({tuple(each.values()) for each in runs}) == 25
    assert all(1 <= each["a"] <= 99 and 0.5 <= each["x"] <= 2 for each in runs)
    assert all(re.fullmatch("[a-z]{6}", each["word"]) for each in runs)
    assert {each["side"] for each in runs} == {"left", "right"}
    assert not any(each["a"] == 2 or each["word"] == "orange" for each in runs)


@pytest.mark.parametrize(
    ("template", "made"),
    [
        ("=drawn.a + 1", 8),
        ("=drawn.a + b", "=7 + b"),
        ("{drawn.word}: {drawn.x:.1f}", "pear: 1.2"),
        ("{drawn.word} {b}", "{('pear')} {(b)}"),
        ("/x{2} {drawn.a}/", "/x{2} {(7)}/"),
        ({"a": ["=drawn.a", "drawn"]}, {"a": [7, "drawn"]}),
    ],
)
def test_what_was_drawn_takes_its_place_and_what_is_known_then_is_computed(template, made):
    assert put_in(template, {"a": 7, "x": 1.25, "word": "pear"}) == made


def test_in_a_pattern_and_beside_other_values_it_is_read_as_it_was_drawn():
    made = put_in({"log": "/a{2}: {drawn.x}/", "text": "{drawn.a} of {n}"}, {"a": 7, "x": 1.5})
    log, text = filled(made, {"n": 9}, has_patterns=True).values()
    assert (log.pattern, text) == (r"a{2}: 1\.5", "7 of 9")


def loaded(folder, request="{a: '=drawn.a', b: 1}", response="'=drawn.a + 1'", cases="{}"):
    text = YAML.replace("REQUEST", request).replace("RESPONSE", response).replace("CASES", cases)
    return load_exercise(lay(folder, {"exercise.yaml": text}))


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"request": "{a: '=drawn.c'}"}, "there is no value drawn.c here, only a"),
        ({"request": "{a: '=drawn.a / 2 + 0.25'}"}, "expected a whole number"),
        ({"response": "'=drawn.c'"}, "there is no value drawn.c here, only a"),
        ({"request": "{a: '=drawn.a * 10 ** 18'}"}, "a whole number from -9223372036854775808"),
        ({"cases": "{more: {drawn: 0}}"}, "expected a number of runs"),
        ({"cases": "{more: {drawn: 30}}"}, "expected at most 20 runs, found 30"),
    ],
)
def test_what_cannot_be_drawn_is_a_mistake_of_the_exercise(tmp_path, given, said):
    with pytest.raises(ExerciseError, match=re.escape(said)):
        loaded(tmp_path, **given)


@pytest.mark.parametrize(
    ("one", "said"),
    [
        ({"example": 1}, "line 5: draw: a: expected exactly one of integer, number, word, one_of"),
        ({"integer": [3, 1], "example": 1}, "the lower one first"),
        ({"number": [0, 10**19], "example": 1}, "the lower one first"),
        ({"word": 0, "example": 1}, "expected 1 to 40 letters, found 0"),
        ({"one_of": [], "example": 1}, "one_of: expected values, found none"),
        ({"one_of": ["{x}"], "example": 1}, "expected a number or a word"),
        ({"word": 3}, "example"),
    ],
)
def test_how_a_value_is_drawn_is_checked(one, said, tmp_path):
    text = YAML.replace("{integer: [1, 99], example: 2}", repr(one)).replace("CASES", "{}")
    text = text.replace("REQUEST", "{a: 1}").replace("RESPONSE", "1")
    with pytest.raises(ExerciseError, match=re.escape(said)):
        load_exercise(lay(tmp_path, {"exercise.yaml": text}))


def test_further_runs_of_a_case_draw_anew(tmp_path):
    exercise = loaded(tmp_path, cases="{more: {drawn: 3}}")
    cases = exercise.drawn_cases(5)
    assert [case.name for case, _ in cases] == ["", "more", "more", "more"]
    asked = [case.cast["caller"]["calls"]["one"]["request"] for case, _ in cases]
    assert asked == [{"a": drawn["a"], "b": 1} for _, drawn in cases]
    assert len({drawn["a"] for _, drawn in cases}) > 1


def test_a_result_and_the_sheet_show_what_was_drawn():
    exercise = load_exercise("service_server")
    result = grader.grade(exercise.folder / "reference" / "service_server.py", exercise, seed=3)
    assert result.score == 100
    assert result.run.drawn == exercise.drawn_cases(3)[0][1]
    assert result.run.seed == 3
