"""Who failed alike stands together, once by the first cause and once for each check."""

from __future__ import annotations

from grader.batch.page import clusters
from grader.batch.page.clusters import of_check, to_mend_first
from grader.batch.page.students import students
from tests.grader.batch.page.classes import entry, result
from tests.grader.reports.samples import diagnosis

BAD, GOOD = {"a": 0.0, "b": 10.0}, {"a": 10.0, "b": 10.0}


def crashed(file, time_s):
    cause = f"Your node crashed at {time_s} s: ValueError: x ({file}, line 3)."
    return result(BAD, diagnosis=diagnosis(cause=cause))


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
            entry("s2", result(BAD, "It is 2.5 m off.")),
            entry("s3", result(BAD, "It is nowhere.")),
            entry("s4", result(GOOD)),
        ]
    )
    first, second = of_check(everybody, "a")
    assert (first.count, first.causes) == (2, (("crashed", 1),))
    assert (second.example, second.count) == ("It is nowhere.", 1)
    assert of_check(everybody, "b") == []


def test_the_example_is_what_is_said_most_often():
    said = ["It is 3 m off.", "It is 2 m off.", "It is 2 m off."]
    everybody = students(entry(f"s{k}", result(BAD, text)) for k, text in enumerate(said))
    (only,) = of_check(everybody, "a")
    assert (only.example, only.nameless) == ("It is 2 m off.", "It is N m off.")


def test_the_nameless_sentence_has_no_name_or_id_of_anybody_in_it():
    text = "NameError: MUELLER17 and Zoë are unknown."
    (only,) = of_check(students([entry("mueller17", result(BAD, text), name="Zoë Müller")]), "a")
    assert only.nameless == "NameError: … and … are unknown."


def test_kinds_beyond_the_commonest_are_told_together():
    word = "abcdefghijklmnop"
    said = [f"It is {letter}{letter}." for letter in word] + ["It is aa."]
    found = of_check(students(entry(f"s{k}", result(BAD, t)) for k, t in enumerate(said)), "a")
    assert len(found) == clusters.MOST_KINDS + 1
    assert found[0].count == 2
    assert counted(found)[-1] == (clusters.RARER, len(word) - clusters.MOST_KINDS)
