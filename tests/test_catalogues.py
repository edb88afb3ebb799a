"""The catalogues: up to date, whole, and each translation has its key's values."""

from __future__ import annotations

import json
import re
import string
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from grader.translations import ENGLISH, LANGUAGES, catalogue
from tests.catalogues import script

TRANSLATED = tuple(code for code in LANGUAGES if code != ENGLISH)
FOLDERS = tuple(script().CATALOGUES)
of_each = pytest.mark.parametrize("folder", FOLDERS, ids=lambda folder: folder.name)
in_each = pytest.mark.parametrize("language", TRANSLATED)
_PERCENT = re.compile(r"%(?:\(\w+\))?[a-z]")


def values(text: str) -> list[tuple[str, ...]]:
    """The names in a sentence, each with its format; argparse's as they are."""
    fields = string.Formatter().parse(text) if "{" in text else ()
    # !u: a capital at the start, which not every language has
    named = {
        (name, form or "", (how or "").replace("u", ""))
        for _, name, form, how in fields
        if name is not None
    }
    return sorted([*named, *((each,) for each in _PERCENT.findall(text))])


def forms(said: Any) -> list[str]:
    return [said] if isinstance(said, str) else said


@cache
def many() -> dict[str, str]:
    """The key of a sentence about a number -> the English for more than one."""
    found = [each for folder in FOLDERS for each in script().CATALOGUES[folder]()]
    return dict(each for each in found if isinstance(each, tuple))


def pairs(language: str) -> list[tuple[str, str]]:
    """Each sentence with each of its translations."""
    read = script().read
    listed = [each for folder in FOLDERS for each in read(folder, language).items()]
    return [(many().get(key, key), form) for key, said in listed for form in forms(said)]


def test_there_are_catalogues_for_all_languages():
    assert script().LANGUAGES == TRANSLATED == tuple(script().FORMS)


@of_each
@in_each
def test_the_sentences_are_those_of_the_code_each_on_its_line(folder: Path, language):
    there, wanted = script().read(folder, language), script().updated(folder, language)
    assert sorted(wanted.keys() - there.keys()) == [], "not in the catalogue: run make catalogues"
    assert sorted(there.keys() - wanted.keys()) == [], "no longer in the code: make catalogues"
    text = (folder / f"{language}.json").read_text(encoding="utf-8")
    assert text == script().text(wanted), "not as make catalogues writes it"
    assert len(text.splitlines()) == len(wanted) + 2


@in_each
def test_a_sentence_about_a_number_has_the_forms_of_the_language(language):
    several = [said for folder in FOLDERS for said in script().read(folder, language).values()]
    assert {len(said) for said in several if isinstance(said, list)} == {script().FORMS[language]}


@in_each
def test_each_translation_has_the_values_of_its_key(language):
    wrong = []
    for key, said in pairs(language):
        try:
            missing = set(values(key)) - set(values(said)) - {("n", ",", ""), ("n", "", "")}
            extra = set(values(said)) - set(values(key))
        except ValueError as error:
            missing, extra = {(str(error),)}, set()
        if missing or extra:
            wrong.append(f"{key!r} -> {said!r}: lacks {missing}, has {extra} too many")
    assert wrong == []


@of_each
@in_each
def test_there_are_no_holes(folder: Path, language):
    assert script().holes(folder, language) == []


def test_french_has_a_blank_that_does_not_break_before_high_punctuation():
    wrong = [said for _, said in pairs("fr") if re.search(r"\w [:;!?»](?:\s|$)|« ", said)]
    assert wrong == []


def test_chinese_has_its_own_punctuation():
    said = [re.sub(r"\[[^]]*\]", "", each) for _, each in pairs("zh")]  # but within code
    wrong = [each for each in said if re.search(r"[\u4e00-\u9fff] ?[,;!?](?:\s|$)", each)]
    assert wrong == []


@in_each
def test_they_are_found_where_the_grader_is_installed(language):
    assert catalogue(language)["passed"] != "passed"
    assert catalogue(ENGLISH) == {}


def test_a_wrong_translation_is_told_apart():
    assert values("{a:.1f} of {b}") == values("{b} ({a:.1f})") != values("{b} ({a:.2f})")
    assert values("%(a)s of {b}")[0] == ("%(a)s",)


CODE = '''
from grader.message import in_context, msg, msg_many

LEFT = in_context("left", "of a wall")

@checks("name")
def name(seen):
    """It has a name.

    More of it.
    """
    say, key = msg("one {a}", a=msg("two")), "not seen"
    msg(key)
    other.msg("a method's")
    return msg_many("{n} pin", "{n} pins", 3), tr("three " "lines")
'''


def test_sentences_are_found_in_code(tmp_path):
    (tmp_path / "code.py").write_text(CODE)
    assert set(script().of_code(tmp_path / "code.py")) == {
        *("It has a name", "left (of a wall)", "one {a}", "two", "three lines"),
        ("{n} pin", "{n} pins"),
    }


def test_sentences_are_found_in_templates_and_pages(tmp_path):
    template, page, code = (tmp_path / name for name in ("a.html", "b.html", "c.js"))
    template.write_text(
        '{{ tr("one {a}", a=tr("two \\"x\\"")) }} {{ tr_many("{n} a", "{n} as", 2) }}'
    )
    assert list(script().of_template(template)) == ["one {a}", 'two "x"', ("{n} a", "{n} as")]
    page.write_text(
        '<p title="A title">Some\n  words <code>not these</code> 5 m/s</p><br>'
        '<p translate="no">Names <b>of</b></p><script>none()</script>'
    )
    assert list(script().of_html(page)) == ["A title", "Some words"]
    code.write_text('t("one"); x = key( "two \\u00e9"); let(t); start("three")')
    assert list(script().of_script(code)) == ["one", "two é"]


def test_a_new_sentence_is_a_hole_and_an_old_one_goes(tmp_path, monkeypatch):
    (tmp_path / "fr.json").write_text(json.dumps({"a": "â", "gone": "perdu", "{n} b": "un b"}))
    monkeypatch.setitem(script().CATALOGUES, tmp_path, lambda: ["new", "a", ("{n} b", "{n} bs")])
    made = script().updated(tmp_path, "fr")
    assert made == {"a": "â", "new": "", "{n} b": ["", ""]}
    assert script().holes(tmp_path, "fr") == ["new", "{n} b"]
    text = '{\n "a": "â",\n "new": "",\n "{n} b": ["", ""]\n}\n'
    assert script().text(made) == text
