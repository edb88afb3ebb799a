"""A message is rendered in a language: order, numbers and plurals are that language's."""

from __future__ import annotations

import json

import pytest

from grader import translations
from grader.message import Message, authored, in_context, joined, msg, msg_many, plain_text
from grader.translations import (
    ENGLISH,
    LANGUAGES,
    catalogue,
    number,
    of_environment,
    tr,
    tr_many,
    translate,
    use,
)

SENTENCES = {
    "It made {turns:.1f} turns of {asked:g}.": "Sur {asked:g}, {turns:.1f} tours.",
    "{n:,} pixel": ["{n:,} pixel", "{n:,} pixels"],
    "red": "rouge",
    "left (of a wall)": "gauche",
    "{color}, at {at}": "{color} ({at})",
    "{seconds:.1f} s": "{seconds:.1f} s",
    "{clause!u}.": "{clause!u}.",
    "not {color!r}": "pas {color!r}",
    "broken {name}": "cassé {nome}",
}
NARROW = "\N{NARROW NO-BREAK SPACE}"


@pytest.fixture(autouse=True)
def small(monkeypatch):
    """A small catalogue; afterwards this process speaks English again."""
    monkeypatch.setattr(translations, "catalogue", lambda language: SENTENCES)
    yield
    use(ENGLISH)


def test_values_come_where_the_language_wants_them():
    said = msg("It made {turns:.1f} turns of {asked:g}.", turns=2.53, asked=3.5)
    assert translate(said, "fr") == "Sur 3,5, 2,5 tours."
    assert translate(said, "en") == str(said) == "It made 2.5 turns of 3.5."


def test_a_message_in_a_message_is_rendered_too():
    said = msg("{color}, at {at}", color=msg("red"), at=msg("{seconds:.1f} s", seconds=1.25))
    assert translate(said, "fr") == "rouge (1,2 s)"


def test_a_clause_begins_a_sentence_and_a_text_is_quoted_in_the_readers_words():
    assert translate(msg("{clause!u}.", clause=msg("red")), "fr") == "Rouge."
    assert translate(msg("not {color!r}", color=msg("red")), "fr") == "pas 'rouge'"


def test_a_row_is_rendered_part_by_part():
    assert translate(joined([msg("red"), "-", "x"]), "fr") == "rouge-x"
    assert translate(joined([msg("red"), msg("No {x:.1f}.", x=1.5)], " "), "fr") == "rouge No 1.5."


def test_behind_full_width_punctuation_a_row_has_no_blanks(monkeypatch):
    monkeypatch.setattr(translations, "catalogue", lambda _: {"a.": "甲。", "b.": "乙。"})
    assert translate(joined([msg("a."), msg("b.")], " "), "zh") == "甲。乙。"


@pytest.mark.parametrize(
    ("n", "said"),
    [
        (0, "0 pixel"),
        (1, "1 pixel"),
        (1.5, "1,5 pixel"),
        (2, "2 pixels"),
        (4210, f"4{NARROW}210 pixels"),
    ],
)
def test_plurals_are_those_of_the_language(n, said):
    assert translate(msg_many("{n:,} pixel", "{n:,} pixels", n), "fr") == said


def test_a_language_may_have_one_form_for_all(monkeypatch):
    monkeypatch.setattr(translations, "catalogue", lambda _: {"{n} pixel": ["{n}个像素"]})
    for n in (1, 2):
        assert translate(msg_many("{n} pixel", "{n} pixels", n), "zh") == f"{n}个像素"


@pytest.mark.parametrize(
    ("hole", "said"),
    [
        (msg("No such {x:.1f} sentence.", x=1.5), "No such 1.5 sentence."),
        (msg_many("{n} hole", "{n} holes", 1.5), "1.5 holes"),
        (msg_many("{n:,} such", "{n:,} of them", 4210), "4,210 of them"),
        (msg("No such {color}.", color=msg("red")), "No such red."),
    ],
)
def test_what_nobody_translated_is_english_with_english_numbers(hole, said):
    assert translate(hole, "fr") == said


def test_a_translation_that_is_like_the_english_has_numbers_of_its_language():
    assert translate(msg("{seconds:.1f} s", seconds=2.5), "fr") == "2,5 s"


def test_a_translation_with_other_values_is_not_used():
    assert translate(msg("broken {name}", name="x"), "fr") == "broken x"


@pytest.mark.parametrize(
    ("n", "said"), [("many", "many pixels"), ("4,210", "4,210 pixels"), ("", " pixels")]
)
def test_a_text_in_place_of_a_number_is_shown_as_it_is(n, said):
    assert translate(Message("{n:,} pixel", {"n": n}, "{n:,} pixels"), "fr") == said


@pytest.mark.parametrize("text", ["red", "4,210.5", "{red}", "a. b"])
def test_a_text_that_is_no_sentence_is_not_looked_up(text):
    assert translate(text, "fr") == translate(plain_text(text), "fr") == text
    assert translate(joined([text, text]), "fr") == text + text


def test_what_its_author_says_in_a_language_comes_before_the_catalogue():
    said = authored("red").translated("zh", "红色")
    assert [translate(said, language) for language in LANGUAGES] == ["red", "rouge", "红色"]


def test_a_word_that_means_several_things_is_found_by_its_context():
    assert translate(in_context("left", "of a wall"), "fr") == "gauche"
    assert translate(in_context("left", "over"), "fr") == "left"


@pytest.mark.parametrize(
    ("text", "said"),
    [("4,210.5", f"4{NARROW}210,5"), ("0.5", "0,5"), ("-12", "-12"), ("1.", "1.")],
)
def test_numbers(text, said):
    assert (number(text, "fr"), number(text, "zh"), number(text, "en")) == (said, text, text)


def test_at_once_it_is_in_the_language_of_this_process():
    assert tr("red") == "red"
    use("fr")
    assert translations.current() == "fr"
    assert (tr("red"), tr_many("{n:,} pixel", "{n:,} pixels", 2)) == ("rouge", "2 pixels")
    assert translate(msg("red")) == "rouge"


def test_a_language_that_is_none_of_ours_is_refused():
    with pytest.raises(ValueError, match="expected one of en, fr, zh, found 'xx'"):
        use("xx")


@pytest.mark.parametrize(
    ("environment", "language"),
    [
        ({}, "en"),
        ({"LANG": "fr_CA.UTF-8"}, "fr"),
        ({"LANG": "zh_CN.GB18030"}, "zh"),
        ({"LANG": "C.UTF-8"}, "en"),
        ({"LANG": "POSIX"}, "en"),
        ({"LANG": "de_DE.UTF-8"}, "en"),
        ({"LANGUAGE": "xx:zh_CN", "LANG": "fr_FR.UTF-8"}, "zh"),
        ({"LANGUAGE": "", "LANG": "fr"}, "fr"),
        ({"LC_ALL": "C", "LANG": "fr_FR.UTF-8"}, "en"),
        ({"LC_MESSAGES": "zh-Hans", "LANG": "fr_FR.UTF-8"}, "zh"),
        ({"LANG": "FR@euro"}, "fr"),
    ],
)
def test_the_locale_of_a_user_chooses(environment, language):
    assert of_environment(environment) == language


def test_a_catalogue_is_a_file_of_its_language(monkeypatch, tmp_path):
    (tmp_path / "languages").mkdir()
    (tmp_path / "languages/fr.json").write_text(json.dumps({"red": "rouge"}))
    monkeypatch.setattr(translations, "files", lambda package: tmp_path)
    monkeypatch.setattr(translations, "catalogue", catalogue.__wrapped__)
    assert translate(msg("red"), "fr") == "rouge"
    assert catalogue.__wrapped__("en") == {}
