import json
import re
from dataclasses import replace

import pytest

from grader.cli import main
from grader.recording import saving
from grader.recording.recording import Recordings
from grader.scenes.subject import load_subject
from grader.system import extensions
from tests.grader.driving import Spiral, drive
from tests.grader.reports import samples
from tests.grader.reports.samples import evidence, verdict


@pytest.fixture(scope="module")
def drawn():
    return drive(Spiral(), ticks=60)


@pytest.fixture
def graded(tmp_path, drawn):
    """The folder of a result with two runs, one of whose checks students do not see."""
    verdicts = [
        verdict("moves", evidence=[evidence("it starts")]),
        verdict("stops", "failed", 0, evidence=[evidence("too far", run=1)], visible="never"),
    ]
    return samples.graded(tmp_path / "graded", drawn, *verdicts, varied=(drawn,)).parent


def shown(page):
    text = page.read_text(encoding="utf-8")
    found = re.search(r'<script type="application/json" id="data">(.*?)</script>', text)
    data = json.loads(found[1])
    return data


@pytest.mark.parametrize("part", [".", "recording", "result.json"])
def test_the_page_lies_beside_the_result(graded, capsys, part):
    assert main(["view", str(graded / part), "--no-open"]) == 0
    page = graded / "view.html"
    assert capsys.readouterr().out == f"The page that plays it: {page}\n"
    text = page.read_text()  # needs nothing from elsewhere
    assert "default-src 'none'" in text
    assert not re.findall(r'(?:src|href)="(?!data:)', text)
    assert "fetch(" not in text
    data = shown(page)
    assert [run["title"] for run in data["runs"]] == ["Nominal run", "Varied run 1"]
    assert [run["last"] for run in data["runs"]] == [60, 60]


def test_what_students_do_not_see_is_in_no_page_of_theirs(graded):
    main(["view", str(graded), "--no-open"])
    assert [check["title"] for check in shown(graded / "view.html")["judged"]] == ["Title of moves"]
    main(["view", str(graded), "--no-open", "--whole"])
    whole = shown(graded / "view.html")["judged"]
    assert [moment["run"] for moment in whole[1]["moments"]] == [1]


def test_a_recording_without_a_result_is_played_without_verdicts(tmp_path, drawn):
    saving.save_all(Recordings(drawn), tmp_path / "mine")
    assert main(["view", str(tmp_path / "mine"), "--no-open", "--out", str(tmp_path / "p")]) == 0
    data = shown(tmp_path / "p")
    assert (data["title"], data["judged"]) == ("mine", [])
    assert not (tmp_path / "view.html").exists()


def test_two_are_compared(graded, tmp_path):
    other = drive(Spiral(), ticks=20)
    saving.save_all(Recordings(other), tmp_path / "other")
    assert main(["view", str(graded), "--no-open", "--compare", str(tmp_path / "other")]) == 0
    compared = shown(graded / "view.html")["other"]
    assert [run["last"] for run in compared["runs"]] == [20]
    assert [each["tick"] for each in compared["differences"]] == [32]


def test_the_browser_is_asked_to_show_it_and_not_if_nobody_wants_that(graded, monkeypatch):
    opened = []
    monkeypatch.setattr("turtlesim_py.browser.show", opened.append)
    main(["view", str(graded)])
    assert opened == [(graded / "view.html").resolve().as_uri()]
    main(["view", str(graded), "--no-open"])
    assert len(opened) == 1


def test_what_is_not_there_is_said_in_a_line(tmp_path, capsys):
    assert main(["view", str(tmp_path / "nowhere"), "--no-open"]) == 2
    said = capsys.readouterr().err
    assert said.startswith("grader view: ") and "nowhere" in said and "Traceback" not in said


def test_a_scene_that_has_no_such_page_is_led_to_the_report(graded, capsys, monkeypatch):
    (graded / "report.html").write_text("")
    monkeypatch.setattr("grader.cli.view.load_subject", lambda _: load_subject("package"))
    assert main(["view", str(graded), "--no-open"]) == 2
    said = capsys.readouterr().err
    assert "cannot be played; look at" in said
    assert str(graded / "report.html") in said
    assert not (graded / "view.html").exists()


def test_turtles_and_casts_are_played():
    names = extensions.points(extensions.SCENES)
    assert [name for name in names if load_subject(name).player] == ["graph", "turtlesim"]


def test_recordings_of_two_scenes_are_not_compared(graded, capsys, monkeypatch, drawn):
    from grader.cli import view

    found = iter([Recordings(drawn), Recordings(replace(drawn, scene="robot"))])
    monkeypatch.setattr(view, "load_all", lambda _: next(found))
    assert main(["view", str(graded), "--no-open", "--compare", str(graded)]) == 2
    assert "cannot compare recordings of the scenes 'turtlesim' and 'robot'" in (
        capsys.readouterr().err
    )


@pytest.mark.parametrize("part", ["result.json", "recording/recording.mcap", "recording/run.json"])
def test_nothing_that_it_is_made_from_is_written_over(graded, capsys, part):
    before = (graded / part).read_bytes()
    assert main(["view", str(graded), "--no-open", "--out", str(graded / part)]) == 2
    assert "this call reads it" in capsys.readouterr().err
    assert (graded / part).read_bytes() == before
