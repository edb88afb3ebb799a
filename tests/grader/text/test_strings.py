import pytest

from grader.exercise.verdict import Evidence, Finding
from grader.text import strings as text


@pytest.mark.parametrize(
    ("raw", "plain"),
    [
        ("\x1b[31mred\x1b[0m", "red"),
        ("\x1b]0;a title\x07text", "text"),
        ("one\r\ntwo\rthree\u2028four", "one\ntwo\nthree\nfour"),
        ("tab\tstays", "tab\tstays"),
        ("bell\x07 nul\x00", "bell\ufffd nul\ufffd"),
        ("half a character: \ud83d", "half a character: \ufffd"),
        ("gpj\u202eexe", "gpj\ufffdexe"),
        ("größer 🐢", "größer 🐢"),
    ],
)
def test_plain_text_has_no_colours_and_no_control_characters(raw, plain):
    assert text.plain(raw) == plain


@pytest.mark.parametrize(
    ("raw", "clean"),
    [
        ("bell\x07, nul\x00, a line\n", "bell?, nul?, a line?"),
        ("half: \udcff", "half: ?"),
        ("gpj\u202eexe", "gpj?exe"),
        ("\u2028", "?"),
        ("größer 🐢 x\u00a0=\u30001", "größer 🐢 x\u00a0=\u30001"),
    ],
)
def test_control_characters_are_replaced_and_nothing_else(raw, clean):
    assert text.without_controls(raw, "?") == clean
    assert text.without_controls("a\n\tb\x07", "?", keep="\n") == "a\n?b?"


def test_every_text_of_a_result_is_made_plain_and_numbers_stay():
    raw = {"a\x00": ["\x1b[1mb", {"c": "\ud800"}], "n": 1.5, "t": True, "z": None}
    plain = {"a\ufffd": ["b", {"c": "\ufffd"}], "n": 1.5, "t": True, "z": None}
    assert text.plain(raw) == plain
    found = Finding(1.0, "a\x00", evidence=(Evidence(1, 0.1, 2.0, 3.0, "\x1b[1mb"),))
    assert text.plain(found) == Finding(1.0, "a\ufffd", evidence=(Evidence(1, 0.1, 2.0, 3.0, "b"),))


def test_a_long_text_keeps_its_start_and_its_end():
    clipped = text.clip("a" * 500 + "b" * 500, 100, keeps_end=True)
    assert clipped.startswith("a" * 50)
    assert clipped.endswith("b" * 50)
    assert "900 characters left out" in clipped
    assert text.clip("short", 100, keeps_end=True) == "short"


@pytest.mark.parametrize(
    ("value", "shown"), [(5.0, "5"), (12.5, "12.5"), (8.333, "8.33"), (0, "0"), (100, "100")]
)
def test_points_have_two_decimals_at_most(value, shown):
    assert text.points(value) == shown
    assert repr(text.number(value)) == shown  # whole where it can be


def test_a_turtle_that_is_nowhere_is_at_an_unknown_place():
    assert str(text.place(1, 2.346)) == "(1.00, 2.35)"
    assert text.place(float("nan"), 2).key == "an unknown place"


@pytest.mark.parametrize(
    ("raw", "plain"),
    [
        ("::error::boo", ": :error::boo"),
        ("a\n \t::Set-Output name=x::y", "a\n \t: :Set-Output name=x::y"),
        ("std::vector stays", "std::vector stays"),
        ("in a line ##[error]x and ##VSO[task.logissue]x", "in a line # #[error]x and # #VSO[task"),
        ("## a title stays", "## a title stays"),
    ],
)
def test_plain_text_commands_no_runner_of_ci(raw, plain):
    assert text.plain(raw).startswith(plain)


def test_in_a_terminal_no_word_does_wherever_the_line_is_cut():
    assert text.for_terminal("x ::ERROR file=a::b \x1b[31m[/b]") == "x : :ERROR file=a: :b [/b]"


def test_a_text_alone_stays_whole_and_one_within_something_has_an_end():
    long = "x" * 1_000_001
    assert text.plain(long) == long
    assert {len(each) for each in text.plain({"a": long, "b": [long]}["b"])} == {1_000_000}
    assert len(text.plain({"a": long})["a"]) == 1_000_000
    assert text.plain({"a": "12345"}, 4) == {"a": "123…"}
