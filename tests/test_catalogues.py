"""The catalogues: each translation has its sentence's values; `make catalogues` keeps them."""

import json
import re
import runpy
import string
from pathlib import Path

import pytest

from grader.text.translations import ENGLISH, LANGUAGES

ROOT = Path(__file__).parents[1]
SCRIPT = runpy.run_path(str(ROOT / "scripts" / "catalogues.py"))
FILES = [
    folder / f"{language}.json"
    for folder in SCRIPT["CATALOGUES"]
    for language in LANGUAGES
    if language != ENGLISH
]
_PERCENT = re.compile(r"%(?:\(\w+\))?[a-z]")


def values(text):
    """The names in a sentence, each with its format; argparse's as they are."""
    fields = string.Formatter().parse(text) if "{" in text else ()
    # !u: a capital at the start, which not every language has
    named = {
        (name, form or "", (how or "").replace("u", ""))
        for _, name, form, how in fields
        if name is not None
    }
    return named | {(each,) for each in _PERCENT.findall(text)}


@pytest.mark.parametrize("file", FILES, ids=lambda file: str(file.relative_to(ROOT)))
def test_each_translation_has_the_values_of_its_sentence(file):
    number = {("n", form, "") for form in ("", ",")}  # "one pin" has none
    wrong = {
        key: form
        for key, said in json.loads(file.read_text(encoding="utf-8")).items()
        for form in ([said] if isinstance(said, str) else said)
        if (values(key) ^ values(form)) - (set() if isinstance(said, str) else number)
    }
    assert wrong == {}


def test_a_translation_is_kept_while_its_sentence_is_there_and_what_lacks_one_is_printed():
    there = {"a": "â", "gone": "perdu", "{n} b": ["un b", "{n} b"], "filled in later": ""}
    sentences = ["new", "a", "", ("{n} b", "{n} bs"), ("{n} c", "{n} cs"), "filled in later"]
    kept, missing = SCRIPT["update"](there, sentences)
    assert kept == {"a": "â", "{n} b": ["un b", "{n} b"]}
    assert missing == {"filled in later": "", "new": "", "{n} c": ["", ""]}
    assert SCRIPT["text"](kept) == '{\n "a": "â",\n "{n} b": ["un b", "{n} b"]\n}\n'


CODE = '''
LEFT = in_context("left", "of a wall")

@checks("name")
def name(seen):
    """It has a name.

    More of it.
    """
    say, key = msg("one {a}", a=msg("two")), "not seen"
    other.msg("a method's")
    return msg("{n} pin", "{n} pins", n=3), tr("three " "lines")
'''
TEMPLATE = '{{ tr("one {a}", a=tr("two \\"x\\"")) }} {{ tr("{n} a", "{n} as", n=2) }}'
PAGE = (
    '<p title="A title">Some\n  words <code>not these</code> 5 m/s</p><br>'
    '<p translate="no">Names <b>of</b></p><script>none()</script>'
)
SENTENCES = {
    "of_code": (
        CODE,
        ["It has a name", "left (of a wall)", "one {a}", "two", "three lines"],
        ("{n} pin", "{n} pins"),
    ),
    "of_template": (TEMPLATE, ["one {a}", 'two "x"'], ("{n} a", "{n} as")),
    "of_html": (PAGE, ["A title", "Some words"]),
    "of_script": ('t("one"); x = key( "two \\u00e9"); let(t); start("three")', ["one", "two é"]),
}


@pytest.mark.parametrize("reader", SENTENCES)
def test_sentences_are_found_in(reader, tmp_path):
    source, sentences, *pairs = SENTENCES[reader]
    (tmp_path / "file").write_text(source)
    assert set(SCRIPT[reader](tmp_path / "file")) == {*sentences, *pairs}
