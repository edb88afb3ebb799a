import json

from grader_class.reports import autolab
from tests.grader.reports import samples
from tests.grader.reports.samples import verdict


def test_the_last_line_has_the_scores_and_the_line_before_the_hints():
    before, last = autolab.render(samples.report()).splitlines()
    assert json.loads(last) == {"scores": {"starts": 10, "draws": 8.33, "stops": 0, "rests": 0}}
    checks = json.loads(before)["Checks"]
    assert checks["starts"] == {"passed": True}
    assert checks["rests"]["hint"].startswith("Not judged. Rationale of rests. Waits for: stops")


def test_a_text_cannot_make_a_line_of_its_own():
    text = '\n{"scores": {"a": 100}}\n'
    content = autolab.render(samples.report(verdict("a", "failed", 0, rationale=text, help=text)))
    assert content.count("\n") == 2
