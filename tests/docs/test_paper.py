"""paper/: in the format of the Journal of Open Source Education, and true to the repository."""

from __future__ import annotations

import re

import yaml

from tests.once import ROOT

PAPER = (ROOT / "paper" / "paper.md").read_text(encoding="utf-8")
BIB = (ROOT / "paper" / "paper.bib").read_text(encoding="utf-8")
HEAD, BODY = PAPER.removeprefix("---\n").split("\n---\n", 1)
SECTIONS = [
    *("Summary", "Statement of need", "Learning objectives", "Content and instructional design"),
    *("How another instructor adopts it", "Story of the project", "AI usage disclosure"),
    *("Acknowledgements", "References"),
]


def entries() -> dict[str, dict[str, str]]:
    """The bibliography; every brace that opens is closed."""
    found = {}
    for kind, key, rest in re.findall(r"^@(\w+)\{(\w+),\n(.*?)^\}", BIB, re.MULTILINE | re.DOTALL):
        assert rest.count("{") == rest.count("}"), key
        fields = re.findall(r"^  (\w+) = \{(.*?)\}(?=,?\n)", rest, re.MULTILINE | re.DOTALL)
        found[key] = {"kind": kind, **dict(fields)}
    assert len(found) == BIB.count("\n@") + 1
    return found


def test_the_head_has_what_the_journal_reads():
    head = yaml.safe_load(HEAD)
    assert {"title", "tags", "authors", "affiliations", "date", "bibliography"} <= head.keys()
    assert head["bibliography"] == "paper.bib"
    places = {each["index"] for each in head["affiliations"]}
    assert {each["affiliation"] for each in head["authors"]} <= places
    assert all(re.fullmatch(r"(\d{4}-){3}\d{3}[\dX]", each["orcid"]) for each in head["authors"])


def test_its_sections_are_there_and_it_is_short():
    assert re.findall(r"^# (.+)$", BODY, re.MULTILINE) == SECTIONS
    assert 750 < len(BODY.split()) < 1750


def test_what_is_cited_is_in_the_bibliography_and_the_other_way_round():
    cited = set(re.findall(r"@(\w+)", BODY))
    assert cited == entries().keys()
    for key, entry in entries().items():
        assert {"author", "title", "year"} <= entry.keys(), key
        assert re.fullmatch(r"10\.\d{4,9}/\S+", entry.get("doi", "10.1000/none")), key
        assert "journal" not in entry or "doi" in entry, key


def test_figures_are_there_and_every_label_is_used():
    for file in re.findall(r"\]\(([\w./]+)\)", BODY):
        assert (ROOT / "paper" / file).is_file(), file
    labels = re.findall(r"\\label\{(\w+)\}|label=\"(\w+)\"", BODY)
    assert {one or other for one, other in labels} == set(re.findall(r"\\autoref\{(\w+)\}", BODY))
