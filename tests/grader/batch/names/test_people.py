"""What tells who somebody is: of a roster, of the files of a hand-in, and of their names."""

from __future__ import annotations

from pathlib import Path

import pytest

from grader.batch.entry import Person
from grader.batch.names.people import called_in, forms, known_words, names_of, of_all, said_in
from grader.batch.names.replacing import Names
from grader.exercise.loading import load_exercise
from tests.grader.batch.names.accented import ZOE, nick_of, package


def test_a_part_that_is_a_word_of_the_grader_counts_only_in_the_whole_name() -> None:
    names = Names({}, forms(["Mark Green"], "studentab12", known_words()))
    assert names("mark a green line by Mark Green") == "mark a green line by studentab12"


def test_short_parts_and_short_numbers_count_only_in_the_whole_name() -> None:
    names = Names({}, forms(["Bo Li", "17"], "studentab12", frozenset()))
    assert names("Bo Li has 17 in li_17") == "studentab12 has 17 in li_17"


def test_columns_that_tell_who_somebody_is_are_names_and_others_are_not() -> None:
    columns = {
        "Email address": "z@a.example",
        "SIS Login ID": "zm1",
        "Section": "A",
        "Group": "Red",
    }
    assert names_of(Person("4711", "Zoe", columns)) == ["Zoe", "4711", "z@a.example", "zm1"]


def test_what_two_students_share_stands_for_neither() -> None:
    known = of_all(
        {"studenta": ["Anna Schmidt"], "studentb": ["Jan Schmidt"]}, frozenset(), "student"
    )
    assert known["schmidt"] == "student"
    assert known["anna schmidt"] == "studenta"


def test_the_files_of_a_hand_in_say_who_its_authors_are(tmp_path: Path) -> None:
    package(tmp_path / "in", ZOE)
    git = [(tmp_path / "in" / ".git" / "logs" / "HEAD").read_text("utf-8")]
    said = " ".join(said_in(tmp_path / "in", git))
    assert ZOE in said
    assert nick_of(ZOE) in said
    assert "def" not in said.split()


def test_unusual_words_in_names_of_files_are_named_and_usual_ones_are_not(tmp_path: Path) -> None:
    (tmp_path / "launch").mkdir()
    for name in ("setup.py", "turtle_controller.py", "nightowl_node.py", "launch/a.launch.py"):
        (tmp_path / name).touch()
    assert called_in(tmp_path, "package", known_words()) == ["nightowl"]


@pytest.mark.parametrize(
    "text",
    ["Publishing: Hello", "minimal_publisher", "MinimalPublisher", "TIMER_PERIOD", "subscription"],
)
@pytest.mark.parametrize("name", ["Ka-Shing Li", "Nimal Perera", "blishin", "minim", "Imer Ripti"])
def test_a_name_within_a_word_of_the_task_is_none(name: str, text: str) -> None:
    known = known_words(load_exercise("talker"))
    names = Names({}, forms([name], "studentab12", known), known=known)
    assert names(text) == text
    own = name.split()[0].lower()
    assert names(f"a {own}_node by {name}") != f"a {own}_node by {name}"


@pytest.mark.parametrize("name", ["Turtle 1", "Mark Green", "Team Turtle"])
def test_a_name_of_words_of_the_task_counts_only_as_it_is_written(name: str) -> None:
    known = known_words(load_exercise("talker")) | {"team"}
    names = Names({}, forms([name], "studentab12", known), known=known)
    first, second = name.lower().split()
    for other in (f"/{first}{second}/cmd_vel", f"{first}_{second}", f"{first} {second}", name[:-1]):
        assert names(other) == other
    assert names(f"by {name}, {name} 2") == "by studentab12, studentab12 2"


def test_a_login_of_words_of_the_task_is_no_name_and_its_address_is_one() -> None:
    known = known_words(load_exercise("talker"))
    for login in ("turtle1", "talker12", "/turtle"):
        assert forms([login], "studentab12", known) == {}
    names = Names({}, forms(["turtle1@uni.example"], "studentab12", known), known=known)
    assert names("turtle1 turtle1@uni.example") == "turtle1 studentab12"
    for login in ("s17", "kb4712", "s1234567"):
        assert Names({}, forms([login], "studentab12", known))(login) == "studentab12"
