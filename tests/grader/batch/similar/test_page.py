"""The page and its data: whole in themselves, and the same for the same class."""

import json
import re

import pytest

from grader.batch.entry import entries
from grader.batch.similar import look
from tests.grader.batch.similar.classes import CHALLENGE, HONEST, hand_in, text
from tests.grader.batch.similar.disguises import DISGUISES


@pytest.fixture(scope="module")
def out(tmp_path_factory):
    out = tmp_path_factory.mktemp("class") / "out"
    for who, handed_in in HONEST.items():
        hand_in(out, who, handed_in, name=f"{who.title()} Ünal")
    evil = "# <script>alert(1)</script> \x1b[31m \u202e\n"
    copy = {"</pre><b>.py": evil + DISGUISES["renamed"](text("states"))}
    hand_in(out, "zz_copy", copy, name="<script>alert('Zoë')</script>")
    look.write(entries(out), CHALLENGE, out)
    return out


def page(out):
    return (out / look.PAGE).read_text(encoding="utf-8")


def test_it_needs_nothing_but_itself(out):
    assert "<script" not in page(out)
    assert not re.findall(r"""(?:src|href)=["'](?!#|submissions/)""", page(out))
    assert "url(" not in page(out) and "@import" not in page(out)


def test_what_strangers_have_written_is_text(out):
    assert "&lt;script&gt;alert(&#39;Zoë&#39;)&lt;/script&gt;" in page(out)
    assert "&lt;script&gt;alert(1)&lt;/script&gt;" in page(out)
    assert not {"\x1b", "\u202e"} & set(page(out))


def test_both_sources_stand_side_by_side_with_passages_that_lead_to_each_other(out):
    marked = set(re.findall(r'id="(p1[ab]\d+)"', page(out)))
    assert {f"p1{side}1" for side in "ab"} <= marked
    assert set(re.findall(r'href="#(p1[ab]\d+)"', page(out))) == marked


def test_it_accuses_nobody_and_says_how_usual_it_is(out):
    words = page(out)
    assert "Of 28 pairs in this class no other is as similar or more." in words
    assert "Right solutions of one task converge." in words
    assert not re.search(r"plagiaris|cheat|guilt|suspect", words, re.IGNORECASE)


def test_names_can_be_hidden_and_every_name_has_its_number(out):
    names = re.findall(r'<span class="who"><span class="name">', page(out))
    assert len(re.findall(r'<span class="number">Student \d+</span></span>', page(out))) == len(
        names
    )
    without = re.sub(r'<span class="name">.*?</span>(?=<span class="number">)', "", page(out))
    assert "Ünal" not in without and "Zoë" not in without


def test_the_same_class_gives_the_same_bytes(out):
    before = [(out / name).read_bytes() for name in (look.PAGE, look.LINES)]
    look.write(list(entries(out)), CHALLENGE, out)
    assert [(out / name).read_bytes() for name in (look.PAGE, look.LINES)] == before


def test_the_data_has_a_line_for_each_pair(out):
    (line,) = (out / look.LINES).read_text(encoding="utf-8").splitlines()
    pair = json.loads(line)
    assert pair["schema"] == look.SCHEMA
    assert pair["ids"] == ["states", "zz_copy"]
    assert pair["source"]["share"] == 1 and pair["pairs_in_all"] == 28


def test_a_class_of_nobody_has_a_page(tmp_path):
    look.write([], CHALLENGE, tmp_path)
    assert "No two hand-ins are alike enough" in page(tmp_path)
    assert (tmp_path / look.LINES).read_bytes() == b""


def test_a_hand_in_without_its_signature_is_told(tmp_path):
    entry = hand_in(tmp_path / "out", "alice", HONEST["quick"])
    (entry.folder / "similar.json").unlink()
    found = look.look_together(entries(tmp_path / "out"), CHALLENGE)
    assert found.look.not_compared == (0,)
