"""The page and its data: whole in themselves, and the same for the same class."""

import json
import re
from dataclasses import replace

import pytest

from grader.batch.entry import entries
from grader.batch.similar import page
from grader.cli import main
from tests.grader.batch.similar.classes import CHALLENGE, HONEST, hand_in, text


@pytest.fixture(scope="module")
def out(tmp_path_factory):
    out = tmp_path_factory.mktemp("class") / "out"
    for who, handed_in in HONEST.items():
        hand_in(out, who, handed_in, name=f"{who.title()} Ünal")
    hand_in(out, "zz_copy", {"</pre><b>.py": text("states")}, name="<script>alert('Zoë')</script>")
    for who in ("starter_1", "starter_2"):
        hand_in(out, who, CHALLENGE.starter)
    for folder in ("mine", "My-Robot"):
        assert main(["new", str(out.parent / folder)]) == 0
        hand_in(out, f"starter_{folder}", out.parent / folder)
    page.write(entries(out), CHALLENGE, out)
    return out


def html(out):
    return (out / page.PAGE).read_text(encoding="utf-8")


def test_it_needs_nothing_but_itself(out):
    assert "<script" not in html(out)
    assert not re.findall(r"""(?:src|href)=["'](?!#|submissions/)""", html(out))
    assert "url(" not in html(out) and "@import" not in html(out)


def test_what_strangers_have_written_is_text(out):
    assert "&lt;script&gt;alert(&#39;Zoë&#39;)&lt;/script&gt;" in html(out)


def test_it_says_where_the_sources_are_and_who_compares_them(out):
    words = html(out)
    assert "Sources are compared by JPlag and Dolos: what they read is in export/." in words
    assert "Their sources are in submissions/ID/source." in words


def test_who_handed_in_the_starter_is_told_as_such_and_with_nobody(out):
    found = page.compare_class(entries(out), CHALLENGE)
    ids = [found.students[number].entry.id for number in found.only_given]
    assert ids == ["starter_1", "starter_2", "starter_My-Robot", "starter_mine"]
    assert "Nothing of their own" in html(out)


def test_it_accuses_nobody_and_says_how_usual_it_is(out):
    words = html(out)
    assert "the same files, byte for byte" in words
    assert "Right solutions of one task converge." in words
    assert not re.search(r"plagiaris|cheat|guilt|suspect", words, re.IGNORECASE)


def test_names_can_be_hidden_and_every_name_has_its_number(out):
    names = re.findall(r'<span class="who"><span class="name">', html(out))
    assert len(re.findall(r'<span class="number">Student \d+</span></span>', html(out))) == len(
        names
    )
    without = re.sub(r'<span class="name">.*?</span>(?=<span class="number">)', "", html(out))
    assert "Ünal" not in without and "Zoë" not in without


def test_the_same_class_gives_the_same_bytes(out):
    before = [(out / name).read_bytes() for name in (page.PAGE, page.LINES)]
    page.write(list(entries(out)), CHALLENGE, out)
    assert [(out / name).read_bytes() for name in (page.PAGE, page.LINES)] == before


def test_the_data_has_a_line_for_each_pair(out):
    (line,) = (out / page.LINES).read_text(encoding="utf-8").splitlines()
    pair = json.loads(line)
    assert pair["schema"] == page.SCHEMA
    assert pair["ids"] == ["states", "zz_copy"]
    assert pair["same_content"] and pair["group"] == 1


def test_a_class_of_nobody_has_a_page(tmp_path):
    page.write([], CHALLENGE, tmp_path)
    assert "No two hand-ins are alike enough" in html(tmp_path)
    assert (tmp_path / page.LINES).read_bytes() == b""


def test_hand_ins_of_which_nothing_is_kept_are_compared_as_a_whole(tmp_path):
    for who in ("alice", "bob"):
        entry = hand_in(tmp_path / "out", who, HONEST["quick"])
        replace(entry, key="abcdef").put()
        (entry.folder / "similar.json").unlink()
    (pair,) = page.compare_class(entries(tmp_path / "out"), CHALLENGE).comparison.pairs
    assert pair.same_content
