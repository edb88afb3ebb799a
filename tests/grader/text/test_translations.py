"""A message is rendered in a language: order, numbers and plurals are that language's."""

import json

import pytest

from grader.text import translations
from grader.text.message import Message, authored, in_context, joined, msg
from grader.text.translations import (
    ENGLISH,
    LANGUAGES,
    catalogue,
    number,
    of_environment,
    tr,
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


@pytest.mark.parametrize(
    ("message", "said"),
    [
        (
            msg("{color}, at {at}", color=msg("red"), at=msg("{seconds:.1f} s", seconds=1.25)),
            "rouge (1,2 s)",
        ),
        # a clause begins a sentence, and a text is quoted in the reader's words
        (msg("{clause!u}.", clause=msg("red")), "Rouge."),
        (msg("not {color!r}", color=msg("red")), "pas 'rouge'"),
        # a row is rendered part by part
        (joined([msg("red"), "-", "x"]), "rouge-x"),
        (joined([msg("red"), msg("No {x:.1f}.", x=1.5)], " "), "rouge No 1.5."),
        # a translation that is like the English has numbers of its language
        (msg("{seconds:.1f} s", seconds=2.5), "2,5 s"),
        # one with other values is not used
        (msg("broken {name}", name="x"), "broken x"),
        # a word that means several things is found by its context
        (in_context("left", "of a wall"), "gauche"),
        (in_context("left", "over"), "left"),
        # what nobody translated is English with English numbers
        (msg("No such {x:.1f} sentence.", x=1.5), "No such 1.5 sentence."),
        (msg("{n} hole", "{n} holes", n=1.5), "1.5 holes"),
        (msg("{n:,} such", "{n:,} of them", n=4210), "4,210 of them"),
        (msg("No such {color}.", color=msg("red")), "No such red."),
        # a text in place of a number is shown as it is
        *(
            (Message("{n:,} pixel", {"n": n}, "{n:,} pixels"), f"{n} pixels")
            for n in ("many", "4,210", "")
        ),
        # a text that is no sentence is not looked up
        *((make(text), text) for text in ("red", "4,210.5", "{red}") for make in (str, Message.of)),
        (joined(["red", "red"]), "redred"),
    ],
)
def test_a_message_is_rendered_with_all_that_is_in_it(message, said):
    assert translate(message, "fr") == said


def test_a_language_has_its_own_row_and_plurals(monkeypatch):
    monkeypatch.setattr(translations, "catalogue", lambda _: {"a.": "甲。", "b.": "乙。"})
    assert translate(joined([msg("a."), msg("b.")], " "), "zh") == "甲。乙。"
    monkeypatch.setattr(translations, "catalogue", lambda _: {"{n} pixel": ["{n}个像素"]})
    for n in (1, 2):
        assert translate(msg("{n} pixel", "{n} pixels", n=n), "zh") == f"{n}个像素"


@pytest.mark.parametrize(
    ("n", "said"),
    [(0, "0 pixel"), (1.5, "1,5 pixel"), (2, "2 pixels"), (4210, f"4{NARROW}210 pixels")],
)
def test_plurals_are_those_of_the_language(n, said):
    assert translate(msg("{n:,} pixel", "{n:,} pixels", n=n), "fr") == said


def test_what_its_author_says_in_a_language_comes_before_the_catalogue():
    said = authored("red").translated("zh", "红色")
    assert [translate(said, language) for language in LANGUAGES] == ["red", "rouge", "红色"]


@pytest.mark.parametrize(
    ("text", "said"), [("4,210.5", f"4{NARROW}210,5"), ("0.5", "0,5"), ("-12", "-12"), ("1.", "1.")]
)
def test_numbers(text, said):
    assert (number(text, "fr"), number(text, "zh"), number(text, "en")) == (said, text, text)


def test_at_once_it_is_in_the_language_of_this_process():
    assert tr("red") == "red"
    use("fr")
    assert translations.current() == "fr"
    assert (tr("red"), tr("{n:,} pixel", "{n:,} pixels", n=2)) == ("rouge", "2 pixels")
    assert translate(msg("red")) == "rouge"
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
