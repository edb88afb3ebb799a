import json
import shutil
from dataclasses import replace

import pytest
import yaml

from grader import grading
from grader.cli import main
from tests import archive
from tests.files import contents
from tests.grader.testing import exercises


@pytest.fixture(scope="module")
def run_once(drawn, tmp_path_factory):
    """The folder in which alice.py was graded; nobody changes it."""
    folder = tmp_path_factory.mktemp("graded")
    with pytest.MonkeyPatch.context() as patch:
        run = lambda _, plan, __=None: replace(drawn, start=plan.start)  # noqa: E731
        patch.setitem(grading.RUNNERS, "virtual", run)
        patch.chdir(folder)
        (folder / "alice.py").write_text("import turtlesim.msg")
        assert main(["run", "alice.py"]) == 0
    return folder


@pytest.fixture
def graded(tmp_path, monkeypatch, in_no_time, run_once):
    """The folder of a result, as `grader run` leaves it; we are in the folder above."""
    shutil.copytree(run_once, tmp_path, dirs_exist_ok=True)
    monkeypatch.chdir(tmp_path)
    return tmp_path / "graded" / "alice.py"


def edited(tmp_path, **changes):
    path = tmp_path / "mine.yaml"
    path.write_text(yaml.safe_dump({"exercise": "turtlesim_challenge", **changes}))
    return str(path)


def result(folder):
    return json.loads((folder / "result.json").read_text())


def test_the_result_is_judged_by_the_new_exercise_and_so_is_its_page(graded, tmp_path, capsys):
    """Whose it is stays known, and lateness costs what it costs now."""
    before = result(graded)
    handed_in = {"id": "4711", "name": "Zoë", "attempt": 2, "at": "2026-12-01T01:00:00+01:00"}
    before["handed_in"] = handed_in | {"late_s": 0, "days": 0, "deducted": 0}
    (graded / "result.json").write_text(json.dumps(before))
    (graded / "report.html").write_text("of yesterday")
    late = {"due": "2026-11-30T22:00:00Z", "per_day": 3}
    asked = ["--exercise", edited(tmp_path, points={"moves": 7}, late=late)]
    assert main(["check", str(graded), *asked]) == 0
    after = result(graded)
    assert (after["submission"], after["score"], after["max_score"]) == ("alice.py", 7, 7)
    assert after["artifacts"] == before["artifacts"]
    assert after["provenance"]["recorded"] == before["provenance"]["recorded"]
    assert after["handed_in"] == handed_in | {"late_s": 7200, "days": 1, "deducted": 3}
    assert "alice.py: 4 of 7" in (graded / "report.html").read_text()
    assert f"The page with picture and plots: {graded / 'report.html'}" in capsys.readouterr().out


def test_a_result_by_an_edited_exercise_is_not_replaced_by_one_that_nobody_has_asked_for(
    graded, tmp_path, capsys
):
    hard = ["--exercise", edited(tmp_path, points={"moves": 7})]
    assert main(["run", "alice.py", *hard]) == 0
    before = result(graded)
    capsys.readouterr()
    assert main(["check", str(graded / "result.json"), "--fail-under", "1"]) == 0
    assert result(graded) == before
    said = capsys.readouterr()
    assert "say with --exercise which one you mean" in said.err
    assert "of 100" in said.out


def test_into_a_file_of_its_own_goes_the_result_and_nothing_else_changes(graded, tmp_path):
    before = contents(graded)
    again = tmp_path / "again.json"
    assert main(["check", str(graded / "recording"), "--json", str(again)]) == 0
    made = json.loads(again.read_text())
    assert made["verdicts"] == result(graded)["verdicts"]
    assert made["artifacts"]["recording"] == "graded/alice.py/recording"
    assert contents(graded) == before


def test_into_the_result_s_own_file_is_the_same_as_without_saying_so(graded):
    (graded / "report.html").unlink()
    assert main(["check", str(graded), "--json", str(graded / "result.json")]) == 0
    assert "alice.py" in (graded / "report.html").read_text()


def test_a_recording_anywhere_else_knows_its_name_and_its_exercise_and_nothing_is_written(
    tmp_path, capsys
):
    elsewhere = tmp_path / "elsewhere" / "recording"
    shutil.copytree(archive.folder("square", "right"), elsewhere)
    name = archive.result("square", "right").submission
    assert main(["check", str(elsewhere)]) == 0
    assert f"{name}: square" in capsys.readouterr().out
    (elsewhere / "circumstances.json").unlink()  # as an older grader has left it
    assert main(["check", str(elsewhere), "--exercise", "square"]) == 0
    assert "elsewhere: square" in capsys.readouterr().out
    assert [path.name for path in elsewhere.parent.iterdir()] == ["recording"]


def test_a_file_of_this_name_that_is_no_result_stays(graded):
    (graded / "result.json").write_text('{"mine": 1}')
    assert main(["check", str(graded)]) == 0
    assert (graded / "result.json").read_text() == '{"mine": 1}'


def test_what_only_a_run_can_follow_is_told(graded, tmp_path, capsys):
    varied = {"count": 4, "per_student": True}
    changed = edited(tmp_path, limits={"total_s": 240}, varied_runs=varied)
    assert main(["check", str(graded), "--exercise", changed]) == 0
    told = " ".join(capsys.readouterr().out.split())
    for key, then, now in (
        ("limits.total_s", 180, 240),
        ("varied_runs.count", 3, 4),
        ("varied_runs.per_student", 0, 1),
    ):
        line = (
            f"The recording was made with {key} {then}; the exercise now says {now}. "
            "Run the submission again for that."
        )
        assert line in told
        assert line in result(graded)["run"]["flags"]


def test_an_exercise_that_is_not_installed_is_to_be_named(graded, tmp_path, capsys):
    folder = exercises.write(tmp_path / "ahead")
    assert main(["run", "alice.py", "--exercise", str(folder)]) == 0
    assert main(["check", str(graded)]) == 2
    assert "not installed here; give its folder" in capsys.readouterr().err
    assert main(["check", str(graded), "--exercise", str(folder)]) == 0


def test_what_students_are_not_to_see_is_in_the_result_alone(graded, tmp_path, capsys):
    hiding = edited(tmp_path, visible={"edge_stop": "never", "picture": "after_due"})
    for words in (["check", str(graded)], ["run", "alice.py"]):
        capsys.readouterr()
        assert main([*words, "--exercise", hiding, "--json", "whole.json"]) == 0
        made = json.loads((tmp_path / "whole.json").read_text())
        seen = {each["check"]: each.get("visible") for each in made["verdicts"]}
        assert (seen["edge_stop"], seen["picture"], seen["moves"]) == ("never", "after_due", None)
        assert made["max_score"] == 100
        shown = capsys.readouterr().out
        assert "2 checks worth" in shown
        assert "edge_stop" not in shown
    assert result(graded) == made
    page = (graded / "report.html").read_text()
    assert "2 checks worth" in page
    assert "edge_stop" not in page
