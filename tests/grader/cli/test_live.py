import json
import os
import pty
import re
import signal
import subprocess
import sys
import threading
from dataclasses import replace

import pytest
from rich.console import Console
from websockets.sync.client import connect

from grader import grading
from grader.cli import live, main
from grader.exercise.loading import load_exercise
from grader.scenes.scene import load_scene
from grader.scenes.turtlesim.pages import TurtlesimPage
from tests.programs import DEADLINE_S, ROOT

QUICK = ROOT / "tests" / "submissions" / "quick_spiral.py"
#: One run is seen from its first tick to its last.
ONE_RUN = "exercise: turtlesim_challenge\nvaried_runs: {count: 0}\n"


@pytest.fixture
def in_no_time(monkeypatch, drawn):
    """Runs take no time, and the nominal one is judged before the next; nobody is waited for.

    Gives where runs began and what the page was told, in order.
    """
    order = []
    judged = threading.Event()

    def tell(page, known):
        order.append(known)
        if is_judged(known):
            judged.set()

    def made(submission, plan, progress=None, *, audience=None):
        assert plan.start is None or judged.wait(60)
        audience.begins(plan, "virtual")
        order.append(plan.start)
        audience.hear([{"tick": 1, "drawn": [], "calls": []}])
        audience.ends(True)
        return replace(drawn, start=plan.start)

    monkeypatch.setitem(grading.RUNNERS, "virtual", made)
    monkeypatch.setattr(live, "PATIENCE_S", 0.0)
    monkeypatch.setattr(TurtlesimPage, "update", tell)
    return order


def is_judged(known):
    return any(check.status != "waiting" for check in known.judged)


def test_runs_go_one_after_the_other_and_verdicts_are_told_as_they_are_known(
    in_no_time, tmp_path, capfd
):
    out = tmp_path / "out"
    assert main(["run", str(QUICK), "--live", "--speed", "5", "--out", str(out)]) == 0
    starts = [each for each in in_no_time if not isinstance(each, live.Grading)]
    exercise = load_exercise("turtlesim_challenge")
    assert starts == [None, *exercise.starts()]
    told = [each for each in in_no_time if isinstance(each, live.Grading)]
    headings = list(dict.fromkeys(each.run for each in told))
    assert headings[:2] == ["", "nominal run, five times as fast as in real time"]
    assert headings[2].startswith("varied run 1 of 3 from (")
    assert headings[3].startswith("varied run 2 of 3 from (")
    early = next(each for each in told if is_judged(each))
    assert (early.score, early.is_over) == ("The nominal run is over, the others still go.", False)
    result = json.loads((out / "result.json").read_text())
    assert told[0].score == "Verdicts come after the nominal run, some after the varied runs."
    titles = [verdict["title"] for verdict in result["verdicts"]]
    for each in told:
        assert [check.title for check in each.judged] == titles
    assert {check.word for check in told[0].judged} == {"after the run"}
    waiting = {check.word for check in early.judged if check.status == "waiting"}
    assert waiting == {"after the varied runs"}
    assert "waiting" not in {check.status for check in told[-1].judged}
    assert (told[-1].score, told[-1].is_over) == (f"Score: {result['score']:g} of 100", True)
    said = capfd.readouterr().err
    assert re.search(r"See the runs at http://127.0.0.1:\d+/\?token=\S+\n", said)
    assert "Nobody has opened the page yet; the run begins." in said


def test_who_presses_ctrl_c_as_soon_as_it_is_offered_gets_the_code_of_the_score(
    in_no_time, tmp_path, monkeypatch
):
    class Pressed(Console):
        def print(self, *said, **how):
            raise KeyboardInterrupt

    monkeypatch.setattr(live, "Console", Pressed)
    monkeypatch.setattr("sys.stderr.isatty", lambda: True)
    out = str(tmp_path / "out")
    assert main(["run", str(QUICK), "--live", "--fail-under", "101", "--out", out]) == 1


def test_who_has_come_by_ssh_is_told_how_to_see_it_also_at_another_port(
    in_no_time, tmp_path, monkeypatch, capfd
):
    monkeypatch.setenv("SSH_CONNECTION", "10.0.0.7 50122 192.0.2.4 22")
    first = load_scene("turtlesim").live_page(0)
    monkeypatch.setattr(live, "USUAL_PORT", int(first.address.split(":")[2].split("/")[0]))
    try:
        assert main(["run", str(QUICK), "--live", "--out", str(tmp_path / "out")]) == 0
    finally:
        first.close()
    said = capfd.readouterr().err
    assert f":{live.USUAL_PORT}/" not in said
    assert re.search(
        r"on your own machine, run there: ssh -L (\d+):127\.0\.0\.1:\1 \S+@192\.0\.2\.4\n", said
    )


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--speed", "5"], "--speed is for --live"),
        (["--live", "--speed", "free", "--time", "real"], "--speed free needs virtual time"),
    ],
)
def test_what_cannot_be_shown_is_told_before_anything_is_written(words, said, tmp_path, capfd):
    out = tmp_path / "out"
    assert main(["run", str(QUICK), *words, "--out", str(out)]) == 2
    assert said in " ".join(capfd.readouterr().err.split())
    assert not out.exists()


def test_in_a_terminal_the_page_stays_until_ctrl_c(tmp_path):
    """Whoever looks sees the last picture for as long as he likes; the exit code is the score's."""
    terminal, theirs = pty.openpty()
    (tmp_path / "node.py").write_text("import rclpy\n")
    (tmp_path / "one_run.yaml").write_text(ONE_RUN)
    words = ("run", "node.py", "--exercise", "one_run.yaml")
    words += ("--live", "--speed", "free", "--fail-under", "101")
    with subprocess.Popen(
        [sys.executable, "-m", "grader", *words],
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        cwd=tmp_path,
        stdout=subprocess.DEVNULL,
        stderr=theirs,
    ) as program:
        os.close(theirs)
        said = ""
        while not (found := re.search(r"See the runs at (http://\S+)\r\n", said)):
            said += os.read(terminal, 4096).decode()
        socket = found[1].replace("http:", "ws:").replace("/?", "/socket?")
        with connect(socket) as viewer:
            viewer.send(json.dumps({"op": "subscribe", "topic": "/turtlesim_live"}))
            is_over = False
            while not is_over:
                told = json.loads(viewer.recv(timeout=DEADLINE_S))["msg"]
                is_over = told.get("grading", {}).get("is_over", False)
        while "Ctrl-C ends it" not in said:
            said += os.read(terminal, 4096).decode()
        assert program.poll() is None
        program.send_signal(signal.SIGINT)
        assert program.wait(DEADLINE_S) == 1
    os.close(terminal)
