"""The catalogues: compiled as they are, up to date, and each translation has its key's values."""

from __future__ import annotations

import importlib.util
import re
import string
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from babel.messages.mofile import read_mo

from grader.language.catalogue import LANGUAGES, catalogue

ROOT = Path(__file__).parents[3]
TRANSLATED = tuple(code for code in LANGUAGES if code != "en")
#: So many sentences may have no translation. It only goes down.
HOLES = {"fr": 0, "zh": 0}
_PERCENT = re.compile(r"%(?:\(\w+\))?[a-z]")


@cache
def script() -> Any:
    path = ROOT / "scripts" / "catalogues.py"
    spec = importlib.util.spec_from_file_location("catalogues", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


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


def several(text: Any) -> tuple[str, ...]:
    return tuple(text) if isinstance(text, list | tuple) else (text,)


def translations(catalog: Any) -> dict[tuple[str, ...], tuple[str, ...]]:
    """What is translated, by its key; a plural has two."""
    listed = ((several(message.id), several(message.string)) for message in catalog if message.id)
    return {key: said for key, said in listed if all(said)}


def pairs(language: str) -> list[tuple[str, str]]:
    """Each sentence with each of its translations."""
    listed = translations(script().read(language)).items()
    return [(key[-1], each) for key, said in listed for each in said]


@pytest.mark.parametrize("language", TRANSLATED)
def test_what_is_compiled_is_what_translators_have_written(language):
    with script().po(language).with_suffix(".mo").open("rb") as file:
        compiled = translations(read_mo(file))
    assert compiled == translations(script().read(language))


@pytest.mark.parametrize("language", TRANSLATED)
def test_the_sentences_are_those_of_the_code(language):
    there = {str(message.id) for message in script().read(language)}
    wanted = {str(message.id) for message in script().template()}
    assert sorted(wanted - there) == [], "not in the catalogue: run make catalogues"
    assert sorted(there - wanted) == [], "no longer in the code: run make catalogues"


@pytest.mark.parametrize("language", TRANSLATED)
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


@pytest.mark.parametrize("language", TRANSLATED)
def test_there_are_no_more_holes_than_known(language):
    holes = script().holes(language)
    print(*(f"{language}: {sentence}" for sentence in holes), sep="\n")
    assert len(holes) <= HOLES[language]


def test_french_has_a_blank_that_does_not_break_before_high_punctuation():
    wrong = [said for _, said in pairs("fr") if re.search(r"\w [:;!?»](?:\s|$)|« ", said)]
    assert wrong == []


def test_chinese_has_its_own_punctuation():
    said = [re.sub(r"\[[^]]*\]", "", each) for _, each in pairs("zh")]  # but within code
    wrong = [each for each in said if re.search(r"[\u4e00-\u9fff] ?[,;!?](?:\s|$)", each)]
    assert wrong == []


@pytest.mark.parametrize("language", TRANSLATED)
def test_they_are_found_where_the_grader_is_installed(language):
    assert catalogue(language).gettext("passed") != "passed"


def test_a_wrong_translation_is_told_apart():
    assert values("{a:.1f} of {b}") == values("{b} ({a:.1f})") != values("{b} ({a:.2f})")
    assert values("%(a)s of {b}")[0] == ("%(a)s",)
