import base64
import json

from grader_class.reports import github_autograding
from tests.grader.reports import samples
from tests.grader.reports.samples import verdict


def decoded(report):
    return json.loads(base64.b64decode(github_autograding.render(report)))


def test_one_line_of_base64_holds_the_tests():
    found = decoded(samples.report())
    assert (found["status"], found["max_score"]) == ("fail", 40)
    assert [test["status"] for test in found["tests"]] == ["pass", "fail", "fail", "fail"]
    assert [test["score"] for test in found["tests"]] == [10, 8.33, 0, 0]
    assert decoded(samples.report(verdict("a")))["status"] == "pass"
