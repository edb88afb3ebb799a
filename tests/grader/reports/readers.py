"""Strict readers: what a course system would make of a format. Each returns the total score."""

import base64
import csv
import io
import json
import math
import re
from functools import cache
from html.parser import HTMLParser
from pathlib import Path

import jsonschema
import xmlschema
from markdown_it import MarkdownIt

CONTRACTS = Path(__file__).parent / "contracts"
VOID = {"br", "hr", "img", "input", "link", "meta"}
LOADING = {"src", "href", "srcset", "poster", "data", "action", "formaction", "xlink:href"}


@cache
def schema(name):
    loaded = json.loads((CONTRACTS / f"{name}.schema.json").read_text())
    return loaded


@cache
def junit_schema():
    return xmlschema.XMLSchema(str(CONTRACTS / "junit.xsd"))


def strict_json(content):
    def refuse(constant):
        raise ValueError(f"{constant} is not JSON")

    def distinct(pairs):
        assert len({key for key, _ in pairs}) == len(pairs)
        return dict(pairs)

    return json.loads(content, parse_constant=refuse, object_pairs_hook=distinct)


def total(parts):
    return round(math.fsum(parts), 2)


def gradescope(content):
    document = strict_json(content)
    jsonschema.validate(document, schema("gradescope"))
    assert document["score"] == total([test["score"] for test in document["tests"]])
    balanced(document["output"])
    return document["score"]


def classroom50(content):
    document = strict_json(content)
    jsonschema.validate(document, schema("classroom50"))
    tests = document["tests"]
    assert document["score"] == sum(test["score"] for test in tests) <= document["max-score"]
    assert document["max-score"] == sum(test["max-score"] for test in tests)
    assert all(test["score"] <= test["max-score"] for test in tests)
    return document["score"]


def prairielearn(content):
    assert len(content.encode()) <= 1_000_000
    document = strict_json(content)
    jsonschema.validate(document, schema("prairielearn"))
    most = math.fsum(test["max_points"] for test in document["tests"])
    points = total([test["points"] for test in document["tests"]])
    assert math.isclose(document["score"] * most, points, abs_tol=0.006) or not most
    return points


def autolab(content):
    assert content.endswith("\n")
    before, last = content[:-1].split("\n")
    for line, part in ((before, "feedback"), (last, "autoresult")):
        jsonschema.validate(strict_json(line), schema("autolab")["$defs"][part])
    return total(list(strict_json(last)["scores"].values()))


def moodle_vpl(content):
    """As VPL's `proposedgrade` and `proposedcomment` do."""
    lines = content.split("\n")
    grades = [line.removeprefix("Grade :=>>") for line in lines if line.startswith("Grade :=>>")]
    assert len(grades) == 1
    inside, blocks = False, 0
    for line in lines:
        if inside and line.strip() == "--|>":
            inside = False
        elif not inside and line.strip() == "<|--":
            inside, blocks = True, blocks + 1
        else:
            assert inside or line.startswith("Grade :=>>") or not line
            assert not (line.startswith("-") and re.search(r"\([^)]*\)$", line))
    assert blocks == 1
    assert not inside
    return float(grades[0])


def csv_table(content):
    header, row = list(csv.reader(io.StringIO(content), strict=True))
    assert len(set(header)) == len(header) == len(row)
    assert not [cell for cell in row if cell.startswith(("=", "@", "+", "\t", "\r"))]
    return float(dict(zip(header, row, strict=True))["score"])


def junit(content):
    junit_schema().validate(content)
    suite = next(iter(xmlschema.XMLResource(content).root))
    properties = {p.get("name"): p.get("value") for p in suite.iter("property")}
    cases = list(suite.iter("testcase"))
    assert int(suite.get("tests")) == len(cases)
    assert int(suite.get("failures")) == len(list(suite.iter("failure")))
    assert int(suite.get("skipped")) == len(list(suite.iter("skipped")))
    assert len({(case.get("classname"), case.get("name")) for case in cases}) == len(cases)
    # what is not shown is skipped, and has no points
    said = [out.text or "" for case in cases if (out := case.find("system-out")) is not None]
    points = total([float(text.split(", ")[1].split(" / ")[0]) for text in said])
    assert float(properties["score"]) == points
    return points


def github_autograding(content):
    assert content.count("\n") == 1
    document = strict_json(base64.b64decode(content.strip(), validate=True).decode())
    jsonschema.validate(document, schema("github_autograding"))
    return total([test["score"] for test in document["tests"]])


def markdown(content):
    """Every HTML token is ours, there are no links or pictures, and one well-formed table."""
    tokens = MarkdownIt("gfm-like", {"linkify": False}).parse(content)
    inline = [child for token in tokens for child in token.children or []]
    assert not [t for t in inline if t.type in ("link_open", "image", "html_inline", "s_open")]
    html = [t.content.strip() for t in tokens if t.type == "html_block"]
    assert set(html) <= {"<details><summary>What the node printed</summary>", "</details>"}
    assert [t.type for t in tokens].count("table_open") == 1
    columns = 0
    for token in tokens:
        if token.type == "tr_open":
            columns = 0
        columns += token.type in ("td_open", "th_open")
        assert token.type != "tr_close" or columns == 4
    first = next(t for t in tokens if t.type == "inline").content
    return float(first.rsplit(": ", 1)[1].split(" of ")[0])


def terminal(content):
    assert not re.search(r"[\x00-\x09\x0b-\x1f\x7f-\x9f]", content)
    assert not re.search(r"::(error|warning|set-output|stop-commands|add-mask)\b", content)
    return float(content.rstrip().rsplit("Score: ", 1)[1].split(" of ")[0])


class Page(HTMLParser):
    """Checks that every tag is closed in order, and takes down what a page would load."""

    def __init__(self):
        super().__init__(convert_charrefs=True)
        self.open = []
        self.ids = []
        self.anchors = []
        self.loads = []
        self.tags = []
        self.text = []

    def handle_starttag(self, tag, attrs):
        assert len({name for name, _ in attrs}) == len(attrs), f"an attribute twice in <{tag}>"
        if tag not in VOID:
            self.open.append(tag)
        self._note(tag, dict(attrs))

    def handle_startendtag(self, tag, attrs):
        self._note(tag, dict(attrs))

    def handle_endtag(self, tag):
        assert self.open, f"</{tag}> without a beginning"
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.text.append(data)

    def _note(self, tag, attrs):
        self.tags.append((tag, attrs))
        assert not [name for name in attrs if name.startswith("on")], "a script in an attribute"
        if attrs.get("id"):
            self.ids.append(attrs["id"] or "")
        for name in LOADING & attrs.keys():
            value = attrs[name] or ""
            (self.anchors if value.startswith("#") else self.loads).append(value)


def balanced(content):
    page = Page()
    page.feed(content)
    page.close()
    assert page.open == []
    return page


def elements(content, name):
    return [attrs for tag, attrs in balanced(content).tags if tag == name]


def html(content):
    assert len(content.encode()) < 2_000_000
    page = balanced(content)
    assert len(set(page.ids)) == len(page.ids)
    assert {anchor[1:] for anchor in page.anchors} <= set(page.ids)
    assert all(load.startswith("data:image/png;base64,") for load in page.loads)
    assert "url(" not in content
    assert "@import" not in content
    tags = [tag for tag, _ in page.tags]
    # data, the page's own, and what draws a solid, if there is one
    kinds = [attrs.get("type") for tag, attrs in page.tags if tag == "script"]
    data, own = kinds.count("application/json"), kinds.count(None)
    assert data + own == len(kinds) and own == (2 if "canvas" in tags else 1)
    assert not {"iframe", "object", "embed", "link", "base", "form"} & set(tags)
    (score,) = [attrs["value"] for tag, attrs in page.tags if tag == "data"]
    return float(score or "nan")


READERS = {
    "terminal": terminal,
    "html": html,
    "markdown": markdown,
    "csv": csv_table,
    "junit": junit,
    "gradescope": gradescope,
    "classroom50": classroom50,
    "prairielearn": prairielearn,
    "autolab": autolab,
    "moodle-vpl": moodle_vpl,
    "github-autograding": github_autograding,
}
