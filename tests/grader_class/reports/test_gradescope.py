import json

from grader.reports import read as read_report
from grader_class.reports import gradescope
from tests.grader.driving import Spiral, drive
from tests.grader.reports import readers, samples


def test_students_see_the_picture_and_what_their_node_printed(tmp_path):
    path = samples.graded(tmp_path, drive(Spiral(), ticks=200), output="<b>Traceback</b>\n")
    content = gradescope.render(read_report(path))
    readers.gradescope(content)
    overview = json.loads(content)["output"]
    assert 'src="data:image/png;base64,' in overview
    assert "<pre>&lt;b&gt;Traceback&lt;/b&gt;</pre>" in overview


def test_what_is_not_judged_is_failed_and_partial_credit_is_named():
    _, partial, _, waiting = json.loads(gradescope.render(samples.report()))["tests"]
    assert waiting["status"] == "failed"
    assert waiting["output"].startswith("Not judged.\n")
    assert "Waits for: stops" in waiting["output"]
    assert (partial["score"], partial["status"]) == (8.33, "failed")
    assert partial["output"].startswith("Partial credit.\n")
