from itertools import pairwise

import pytest
from markdown_it import MarkdownIt

from grader_class.reports import markdown
from tests.grader.reports import samples
from tests.grader.reports.samples import verdict

SPECIAL = (
    "a | b *c* _d_ `e` <f> &amp; [g](http://h.example) # i ~~j~~ $k$ \\ ![l](m) @nobody "
    "www.n.example \\| 1. - +"
)


def rendered(text):
    return MarkdownIt("gfm-like", {"linkify": False}).render(text)


def cells(text):
    tokens = MarkdownIt("gfm-like", {"linkify": False}).parse(text)
    found = []
    for before, token in pairwise(tokens):
        if before.type == "td_open":
            found.append("".join(child.content for child in token.children))
    return found


def test_a_title_with_every_sign_of_markdown_comes_out_as_it_went_in():
    table = cells(markdown.render(samples.report(verdict("x", title=SPECIAL))))
    assert table[1].replace("\u2060", "") == SPECIAL


@pytest.mark.parametrize(
    "text", ["- a", "1. a", "# a", "> a", "+ a", "---", "===", "    a", "2) b"]
)
def test_a_rationale_begins_no_list_title_or_code(text):
    html = rendered(markdown.render(samples.report(verdict("x", "failed", 0, rationale=text))))
    assert f"<p>{text.strip().replace('>', '&gt;')}</p>" in html


def test_an_address_becomes_no_link_and_nobody_is_notified():
    text = "see http://evil.example or www.evil.example, and ask @somebody or me@evil.example"
    content = markdown.render(samples.report(verdict("x", "failed", 0, rationale=text)))
    # what GitHub makes links and notifications from
    for words in ("http://", "www.", "@somebody", "@evil"):
        assert words not in content
    assert content.endswith("\n")  # it can be appended


def test_the_table_has_a_row_for_each_verdict_and_the_total():
    table = cells(markdown.render(samples.report()))
    assert len(table) == 4 * 5
    assert table[5:7] == ["Title of draws", "8.33 / 10 (partial credit)"]
    assert table[12] == "⏸️ not judged"
    assert table[15] == "rests (waits for stops)"
    assert table[18] == "18.33 / 40"


def test_printed_fences_do_not_end_the_fence(tmp_path):
    (tmp_path / "out.txt").write_text("```\n</details>\n````\n# title\n")
    report = samples.report_in(tmp_path, samples.result(artifacts={"output": "out.txt"}))
    html = rendered(markdown.render(report))
    assert "<h1>" not in html
    assert html.count("</details>") == 1
    assert "&lt;/details&gt;" in html
