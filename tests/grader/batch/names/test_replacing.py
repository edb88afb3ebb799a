"""Names are found however they are written, and replaced so that all else stays as it was."""

from __future__ import annotations

import json
import unicodedata
from urllib.parse import quote

import pytest

from grader.batch.names.people import forms
from grader.batch.names.replacing import Names

ZOE = "Zoë Müller"
NAMES = Names({}, forms([ZOE, "zm4711", "zoe.mueller@uni.example"], "studentab12", frozenset()))


@pytest.mark.parametrize(
    "text",
    [
        ZOE,
        unicodedata.normalize("NFD", ZOE),
        "ZOË MÜLLER",
        "Müller, Zoë",
        "zoe_mueller",
        "ZoeMueller",
        "zmuller",
        "zm4711",
        json.dumps(ZOE)[1:-1],
        json.dumps(json.dumps(ZOE))[3:-3],
        quote(ZOE),
        quote(unicodedata.normalize("NFD", ZOE)),
        repr(ZOE.encode())[2:-1],
        "Zo&euml; M&uuml;ller",
        "Zo&#235; M&#xfc;ller",
        r"Zo\303\253 M\303\274ller",
        ascii(ZOE)[1:-1],
        json.dumps(ascii(ZOE))[2:-2],
        json.dumps(repr(ZOE.encode()))[3:-2],
        ZOE.encode("ascii", "backslashreplace").decode(),
        quote(ZOE.encode("latin-1")),
    ],
)
def test_a_whole_name_is_one_pseudonym_however_it_is_written(text: str) -> None:
    assert NAMES(f"by {text}!") in ("by studentab12!", "by studentab12x2_studentab12x3!")
    assert NAMES.are_in(text)


@pytest.mark.parametrize(
    ("text", "without"),
    [
        ("zoe_node.py", "studentab12x2_node.py"),
        ("class ZoeNode2(Node):", "class Studentab12x2Node2(Node):"),
        ("ZOE_RATE = 2", "STUDENTAB12X2_RATE = 2"),
        ("/home/zoe/müllers", "/home/studentab12x2/studentab12x3s"),
        ("zoe.mueller@uni.example", "studentab12@uni.example"),
    ],
)
def test_a_part_of_a_name_is_found_in_what_a_program_calls_its_things(
    text: str, without: str
) -> None:
    assert NAMES(text) == without


@pytest.mark.parametrize("text", ["", "azoe", "a canzoe", "Zo", "&amp; %41 \\u12", "é è", "4711"])
def test_what_is_no_name_stays_as_it_is(text: str) -> None:
    assert NAMES(text) == text


def test_a_name_of_a_script_without_blanks_is_found_within_a_sentence() -> None:
    names = Names({}, forms(["王小明"], "studentab12", frozenset()))
    assert names("我是王小明。") == "我是studentab12。"


def test_a_number_is_found_as_a_whole_and_not_within_another() -> None:
    names = Names({}, forms(["1234567"], "studentab12", frozenset()))
    assert names("id1234567, 0.12345678, 12345678") == "idstudentab12, 0.12345678, 12345678"


def test_names_of_many_come_behind_those_of_one() -> None:
    many = {f"name{number:03}son": f"student{number}" for number in range(200)} | {"zoe": "other"}
    names = Names({}, {"zoe": "studentab12"}, Names(many))
    text = "zoe name007son name007 zoe_name199son named"
    assert names(text) == "studentab12 student7 name007 studentab12_student199 named"
    assert names(names(text)) == names(text)


def test_pseudonyms_themselves_are_left_alone() -> None:
    once = NAMES(f"{ZOE} zoe_node")
    assert NAMES(once) == once


def test_a_picture_in_base64_has_no_names() -> None:
    text = "data:image/png;base64," + "zoeA1mullerB" * 40
    assert NAMES(text) == text
