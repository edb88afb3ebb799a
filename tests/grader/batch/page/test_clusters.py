"""Who failed alike stands together, once by the first cause and once for each check."""

from __future__ import annotations

from dataclasses import replace

import pytest

from grader.batch.page import clusters
from grader.batch.page.clusters import kind_of, of_check, to_mend_first
from grader.batch.page.students import students
from grader.message import joined, listed, msg, plain_text
from tests.grader.batch.page.classes import OFF, entry, result
from tests.grader.reports.samples import diagnosis

BAD, GOOD = {"a": 0.0, "b": 10.0}, {"a": 10.0, "b": 10.0}


def crashed(file, time_s):
    cause = msg(
        "Your node crashed at {time_s} s: {error} ({file}, line 3).",
        time_s=time_s,
        error="ValueError: x",
        file=file,
    )
    judged = result(BAD, diagnosis=diagnosis())
    return replace(judged, diagnosis=replace(judged.diagnosis, cause=cause))


def off(metres):
    return OFF.given(metres=metres)


def counted(found):
    return [(cluster.heading, cluster.count) for cluster in found]


def test_each_student_is_in_one_cluster_by_the_first_cause():
    everybody = students(
        [
            entry("s1", crashed("one.py", 6)),
            entry("s2", crashed("two.py", 7.25)),
            entry("s3", result(BAD)),
            entry("s4", result(GOOD)),
            entry("s5", state="unusable", message="The zip s5.zip is damaged."),
            entry("s6", state="nothing", message="Nothing was handed in."),
            entry("s7", state="failed", message="The disk is full."),
        ]
    )
    assert counted(to_mend_first(everybody)) == [
        ("crashed", 2),
        ("Title of a", 1),
        ("cannot be started", 1),
        ("nothing handed in", 1),
        ("the grader failed", 1),
    ]


def test_of_a_check_the_rationales_count_and_the_first_causes_are_told():
    everybody = students(
        [
            entry("s1", crashed("one.py", 6)),
            entry("s2", result(BAD, off(2.5))),
            entry("s3", result(BAD, msg("It is nowhere."))),
            entry("s4", result(GOOD)),
        ]
    )
    first, second = of_check(everybody, "a")
    assert (first.count, first.causes) == (2, (("crashed", 1),))
    assert (second.example, second.count) == ("It is nowhere.", 1)
    assert of_check(everybody, "b") == []


def test_who_was_not_judged_by_an_earlier_check_is_counted_there_alone():
    judged = result({"a": 0.0, "b": -1.0, "c": -1.0})
    a, b, c = judged.verdicts
    waiting = replace(judged, verdicts=(a, replace(b, depends_on=("a",)), c))
    everybody = students([entry("s1", waiting)])
    assert [len(of_check(everybody, check)) for check in "abc"] == [1, 0, 1]


def test_the_example_is_what_is_said_most_often():
    said = [off(3), off(2), off(2)]
    everybody = students(entry(f"s{k}", result(BAD, text)) for k, text in enumerate(said))
    (only,) = of_check(everybody, "a")
    assert (only.example, only.nameless) == ("It is 2 m off.", "It is … m off.")


def test_the_nameless_sentence_has_no_name_or_id_of_anybody_in_it():
    text = msg("MUELLER17 and Zoë are unknown.")
    (only,) = of_check(students([entry("mueller17", result(BAD, text), name="Zoë Müller")]), "a")
    assert only.nameless == "… and … are unknown."


def test_kinds_beyond_the_commonest_are_told_together():
    word = "abcdefghijklmnop"
    said = [msg(f"It is {letter}{letter}.") for letter in word] + [msg("It is aa.")]
    found = of_check(students(entry(f"s{k}", result(BAD, t)) for k, t in enumerate(said)), "a")
    assert len(found) == clusters.MOST_KINDS + 1
    assert found[0].count == 2
    assert counted(found)[-1] == (str(clusters.RARER), len(word) - clusters.MOST_KINDS)


def crash(time_s, error, where):
    return msg(
        "Your node crashed at {at} s: {error} ({where}).", at=time_s, error=error, where=where
    )


def wall(side, time_s):
    return msg("It ran into the {side} wall at {time_s:.3g} s.", side=side, time_s=time_s)


def coloured(quadrant, colour):
    return msg("Quadrant {quadrant} is all {colour}.", quadrant=quadrant, colour=colour)


ALIKE = {
    "numbers": tuple(
        msg(
            "It came to rest {m:.3g} m from the nearest wall; {most} m or less is near.",
            m=m,
            most=2.1,
        )
        for m in (4.95, 12)
    ),
    "signs": tuple(msg("It changed by {by:,} m.", by=by) for by in (-0.07, 1034)),
    "files and lines": (
        crash(6.0, "ZeroDivisionError: division by zero", "alice.py, line 54"),
        crash(0.5, "ZeroDivisionError: by zero", "pkg/bob.py, line 7"),
    ),
    "another error": (
        crash(6.0, "AttributeError: 'Pose' object has no attribute 'z'", "alice.py, line 5"),
        crash(6.0, "AttributeError: 'My_Node' object has no attribute 'pen's'", "a.py, line 5"),
    ),
    "topics and types": tuple(
        msg("You publish {kind} on {topic}, where nobody listens.", kind=kind, topic=topic)
        for kind, topic in (("geometry_msgs/msg/Twist", "/turtle/cmd_vel"), ("String", "/cmd"))
    ),
    "how many there are": tuple(
        msg("There is next to nothing drawn in {where}.", where=listed(where))
        for where in (("I (top right)", "II (top left)"), ("III (bottom left)",))
    ),
    "how often it is said": (
        joined([coloured("I", msg("red")), coloured("IV", msg("blue"))], " "),
        coloured("II", msg("red")),
    ),
    "sides": (wall(msg("left"), 5), wall(msg("right"), 6.25)),
    "texts that are no sentence of ours": (plain_text("<Node at 0x7f00aa>"), plain_text("<Node>")),
}


@pytest.mark.parametrize("pair", ALIKE.values(), ids=ALIKE.keys())
def test_these_are_alike(pair):
    assert kind_of(pair[0]) == kind_of(pair[1])


def test_other_words_are_another_kind():
    said = [one for pair in ALIKE.values() for one in pair]
    assert len({kind_of(sentence) for sentence in said}) == len(ALIKE)


def test_words_stay():
    assert str(kind_of(msg("The pen was never changed."))) == "The pen was never changed."


@pytest.mark.parametrize("part", ["'", "(", "/a", "1", "ab and ", "N, ", "a" * 31 + ", ", "\x1b["])
def test_what_is_made_to_be_slow_is_left_out(part):
    assert str(kind_of(msg("It says {what}.", what=part * 100_000))) == "It says …."
