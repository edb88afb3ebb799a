"""Copies are found whatever they look like; honest solutions of the same task are not listed."""

import shutil

import pytest

from grader.batch.similar import look
from tests.grader.batch.similar.classes import CHALLENGE, HONEST, hand_in, listed, looked_at, text
from tests.grader.batch.similar.disguises import DISGUISES
from tests.grader.driving import Spiral, drive
from tests.submissions.mutants import MUTANTS, REFERENCE

STYLES = sorted((HONEST["timer"].parent).glob("*.py"))
#: Without functions there is nothing to put in another order.
ONE_FILE = ("quick", "timer", "functions", "states", "loop")


@pytest.fixture(scope="module")
def honest(tmp_path_factory):
    """A class of honest solutions, all of which drive the same."""
    out = tmp_path_factory.mktemp("honest") / "out"
    recording = drive(Spiral(), 4000)
    for who, handed_in in HONEST.items():
        hand_in(out, who, handed_in, recording)
    return out


@pytest.fixture
def out(honest, tmp_path):
    """The same, to be added to."""
    shutil.copytree(honest, tmp_path / "out")
    return tmp_path / "out"


def test_honest_solutions_are_not_listed_though_all_of_them_drive_the_same(out):
    assert listed(out) == set()


@pytest.mark.parametrize("who", ONE_FILE)
@pytest.mark.parametrize("disguise", DISGUISES)
def test_a_disguised_copy_is_listed_and_nothing_else(out, who, disguise):
    hand_in(out, "zz_copy", {"mine.py": DISGUISES[disguise](text(who))})
    assert listed(out) == {(who, "zz_copy")}


def test_a_copy_within_a_longer_program_is_listed(out):
    rest = text("states").replace("Machine", "Unused").replace("main()", "unused()")
    hand_in(out, "zz_copy", {"mine.py": DISGUISES["renamed"](text("functions")) + rest})
    assert ("functions", "zz_copy") in listed(out)


def test_copies_of_a_whole_group_are_one_group_and_none_makes_the_others_likely(out):
    for number, disguise in enumerate(DISGUISES.values()):
        hand_in(out, f"zz_{number}", {"mine.py": disguise(text("functions"))})
    found = looked_at(out).look
    assert [len(members) for members in found.groups] == [1 + len(DISGUISES)]
    assert {pair.outside for pair in found.pairs} == {0}
    assert all(pair.source.pairs > 1 for pair in found.pairs if pair.source.share < 1)


def test_what_many_have_in_common_lists_nobody(tmp_path):
    """The same class stands in all of these files; it may have been on a slide."""
    names = ("asyncio_loop", "busy_polling", "clock_sleep", "own_parameters", "two_nodes")
    for path in (path for path in STYLES if path.stem in names):
        hand_in(tmp_path / "out", path.stem, path)
    for who in ("functions", "states", "loop", "parts"):
        hand_in(tmp_path / "out", who, HONEST[who])
    assert listed(tmp_path / "out") == set()


def test_two_that_are_written_like_the_reference_have_that_from_the_reference(tmp_path):
    hand_in(tmp_path / "out", "alice", REFERENCE)
    renamed = DISGUISES["renamed"](REFERENCE.read_text())
    hand_in(tmp_path / "out", "bob", {"mine.py": renamed})
    for name in ("no_stop", "wrong_topic", "never_spins"):
        hand_in(tmp_path / "out", name, {"turtle_controller.py": MUTANTS[name].text()})
    assert listed(tmp_path / "out") == set()


def test_who_handed_in_the_starter_is_told_as_such_and_with_nobody(tmp_path):
    for who in ("alice", "bob"):
        hand_in(tmp_path / "out", who, CHALLENGE.starter)
    found = looked_at(tmp_path / "out").look
    assert (found.pairs, found.only_given) == ((), (0, 1))


def test_the_same_files_are_told_to_be_the_same(out):
    hand_in(out, "zz_copy", {"another_name.py": text("loop")})
    (pair,) = looked_at(out).look.pairs
    assert pair.same_content and pair.source.share == 1


def test_the_same_files_are_listed_even_where_they_cannot_be_parsed(out):
    for who in ("zz_1", "zz_2"):
        hand_in(out, who, {"a.py": "def broken(:\n"})
    found = looked_at(out).look
    assert [pair.same_content for pair in found.pairs] == [True]
    assert len(found.not_compared) == 2


def test_what_else_everybody_was_given_can_be_said(out, tmp_path):
    hand_in(out, "zz_copy", {"mine.py": DISGUISES["all"](text("functions"))})
    assert len(listed(out)) == 1
    slide = tmp_path / "slide.py"
    slide.write_text(text("functions"))
    assert look.look_together(looked_at(out).entries, CHALLENGE, [slide]).look.pairs == ()
