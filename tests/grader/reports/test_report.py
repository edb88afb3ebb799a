import os
import re
from dataclasses import replace

import pytest

from grader.exercise.result.result import Result
from grader.recording.recording import Recordings
from grader.reports import Report, render
from grader.reports import read as read_report
from tests.grader.driving import Spiral, drive
from tests.grader.reports import samples
from tests.grader.reports.samples import FORMATS, evidence, verdict


@pytest.fixture(scope="module")
def recording():
    return drive(Spiral(), ticks=600)


def test_the_first_thing_to_mend_is_the_first_failed_check_else_one_that_was_not_judged():
    assert samples.report().first_to_mend.check == "draws"
    assert samples.report().headline == "Rationale of draws."
    report = samples.report(verdict("a"), verdict("b", "not_judged", 0))
    assert report.first_to_mend.check == "b"
    report = samples.report(verdict("a"), verdict("b"))
    assert report.first_to_mend is None
    assert report.headline == "Nothing to fix: all 2 checks passed."


def test_a_diagnosis_comes_first_and_leads_to_the_check_that_it_repeats():
    report = samples.report(diagnosis=samples.diagnosis(check="stops"))
    assert report.headline == "You crashed at 6.0 s (drive.py, line 39)."
    assert report.first_to_mend.check == "stops"


def test_evidence_is_numbered_over_all_verdicts_and_names_its_run():
    report = samples.report(
        verdict("a", evidence=[evidence("x"), evidence("y", run=2)]),
        verdict("b", evidence=[evidence("z")]),
    )
    assert [(p.number, p.verdict, p.evidence.run, str(p.evidence.note)) for p in report.points] == [
        (1, 0, 0, "x"),
        (2, 0, 2, "y"),
        (3, 1, 0, "z"),
    ]
    assert str(report.points[1]) == "varied run 2, at 1.60 s, at (5.50, 7.25): y"


def test_checks_that_look_the_same_or_have_no_name_can_be_told_apart():
    names = [v.check for v in samples.report(*map(verdict, ["a", "", "a\n", "a (2)"])).verdicts]
    assert names[:3] == ["a", "check 2", "a (2)"]
    assert len(set(names)) == 4


def test_a_result_is_read_with_what_lies_beside_it(tmp_path, recording):
    report = read_report(samples.graded(tmp_path, recording, varied=(recording,), output="hi\x07"))
    assert report.artifacts.canvas_path == tmp_path.resolve() / "canvas.png"
    assert list(report.recordings) == [0, 1]
    assert report.output == "hi\ufffd"


def test_a_report_made_in_memory_is_the_one_that_is_read(tmp_path, recording):
    printed = replace(recording, output="one\r\ntwo\r\x1b[0m\n\ufffd</pre>")
    pinned = verdict("draws", "failed", 8.33, evidence=[evidence("a gap"), evidence("b", run=1)])
    path = samples.graded(
        tmp_path, printed, pinned, verdict("b"), varied=(recording,), output=printed.output
    )
    recordings = Recordings(printed, (recording,))
    made = Report.of(Result.read(path), tmp_path, recordings)
    read = read_report(path)
    when = re.compile(r'"(datetime|graded_at)": "[^"]*"')  # Classroom 50's format says it
    for name in FORMATS:
        one, other = (when.sub("", render(name, [report])) for report in (made, read))
        assert one == other, name


def test_a_report_made_in_memory_reads_no_file(tmp_path, recording):
    result = Result.from_json(
        samples.result(artifacts={"canvas": "canvas.png", "recording": "recording"})
    )
    (tmp_path / "canvas.png").write_text("no picture")
    (tmp_path / "recording").write_text("no recording")
    page = render("html", [Report.of(result, tmp_path, Recordings(recording))])
    assert page.count("data:image/png;base64,") == 1
    assert 'class="plots run on-paper"' in page


def test_a_missing_recording_is_no_error_and_the_reason_is_known(tmp_path, recording):
    path = samples.graded(tmp_path, recording)
    (tmp_path / "recording" / "run.json").unlink(missing_ok=True)
    (tmp_path / "recording" / "recording.json").unlink(missing_ok=True)
    report = read_report(path)
    assert report.recordings == {}
    assert "recording" in report.no_recording(0)
    assert samples.report().no_recording(0) == "no recording lies beside it"


@pytest.mark.parametrize("path", ["../secret.png", "/etc/passwd", "link.png", "pipe.png"])
def test_only_files_below_the_results_folder_are_opened(tmp_path, path):
    folder = tmp_path / "graded"
    folder.mkdir()
    (tmp_path / "secret.png").write_bytes(b"secret")
    (folder / "link.png").symlink_to(tmp_path / "secret.png")
    os.mkfifo(folder / "pipe.png")
    result = samples.result(artifacts={"canvas": path, "output": path})
    report = samples.report_in(folder, result)
    assert report.artifacts.canvas_path is None
    assert report.output == ""
