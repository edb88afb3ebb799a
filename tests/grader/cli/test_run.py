"""`grader run` on real submissions: real processes, real ROS.

Each submission is graded when the first test looks at it, and only once.
"""

from __future__ import annotations

import io
import json
import os
import subprocess
import sys
from contextlib import redirect_stderr, redirect_stdout, suppress
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import psutil
import pytest
import yaml

from grader.cli import main
from grader.system import scratch
from grader.system.strict_json import first_error
from tests import once
from tests.programs import ROOT

QUICK = (ROOT / "tests" / "submissions" / "quick_spiral.py").read_text()
ENV = {**os.environ, "PYTHONPATH": str(ROOT), "COLUMNS": "200"}
#: The challenge with short limits and nominal runs only: a test suite is in a hurry.
SHORT = yaml.safe_dump(
    {
        "exercise": "turtlesim_challenge",
        "limits": {"first_motion_s": 4, "rest_s": 1, "total_s": 30},
        "varied_runs": {"count": 0},
    }
)
FORGES = """
import json, pathlib
pathlib.Path('result.json').write_text(json.dumps({'score': 100}))
print(json.dumps({'say': 'done', 'reason': 'rest'}))
"""
#: name -> what the file turtle_controller.py holds
FILES = {"quick": QUICK, "syntax_error": "import rclpy\ndef main()\n    pass\n", "forges": FORGES}


@dataclass
class Graded:
    """A finished `grader run`."""

    code: int
    stdout: str
    stderr: str
    out: Path
    left_running: tuple[str, ...] = ()

    @property
    def result(self):
        return json.loads((self.out / "result.json").read_text())


def start(*words):
    command = [sys.executable, "-m", "grader", "run", *map(str, words)]
    pipe = subprocess.PIPE
    return subprocess.Popen(command, stdout=pipe, stderr=pipe, text=True, env=ENV)


def called(*words):
    """The same in this process, for what is the same there."""
    said, messages = io.StringIO(), io.StringIO()
    with pytest.MonkeyPatch.context() as patch, redirect_stdout(said), redirect_stderr(messages):
        patch.setenv("COLUMNS", "200")
        return main(["run", *map(str, words)]), said.getvalue(), messages.getvalue()


def _grade(name, folder):
    """Grade the submission of this name; the folder keeps all that became of it."""
    submission = folder / name
    if name == "starter":
        assert main(["new", str(submission)]) == 0
    else:
        submission.mkdir()
        (submission / "turtle_controller.py").write_text(FILES[name])
    (folder / "short.yaml").write_text(SHORT)
    words = (submission, "--out", folder / "out", "--exercise", folder / "short.yaml")
    if name == "quick":  # as a process of its own, others by what this one has imported already
        process = start(*words)
        stdout, stderr = process.communicate(timeout=100)
        run = process.returncode, stdout, stderr
    else:
        run = called(*words)
    lines = [" ".join(p.info["cmdline"] or []) for p in psutil.process_iter(["cmdline"])]
    kept = (*run, [line for line in lines if str(folder) in line])
    (folder / "kept.json").write_text(json.dumps(kept))


def graded(name):
    """What became of a submission, by its name; nobody changes it."""
    folder = once.folder(partial(_grade, name), "grader run", name, FILES.get(name), SHORT)
    code, stdout, stderr, left = json.loads((folder / "kept.json").read_text())
    return Graded(code, stdout, stderr, folder / "out", tuple(left))


@pytest.mark.parametrize("name", ["quick", "starter", "syntax_error", "forges"])
def test_a_result_follows_the_schema_its_files_exist_and_no_process_is_left(
    name, tmp_path, capfdbinary
):
    """The page is the one that report makes of its folder, and judged again it is the same."""
    run = graded(name)
    assert first_error("grader.exercise.result", "result", run.result) is None
    assert all((run.out / path).exists() for path in run.result["artifacts"].values())
    assert not run.left_running
    capfdbinary.readouterr()
    assert main(["report", str(run.out / "result.json"), "--format", "html"]) == 0
    assert (run.out / "report.html").read_bytes() == capfdbinary.readouterr().out
    again = tmp_path / "again.json"
    words = ["check", run.out / "recording", "--json", again]
    assert main([*map(str, words), "--exercise", str(run.out.parent / "short.yaml")]) == 0
    for part in ("verdicts", "run"):
        assert json.loads(again.read_text())[part] == run.result[part]


def test_a_right_solution_gets_full_marks():
    run = graded("quick")
    assert run.code == 0, run.stderr
    assert (run.result["score"], run.result["max_score"]) == (100, 100)
    assert (run.result["run"]["outcome"], run.result["run"]["time"]) == ("finished", "virtual")


@pytest.mark.parametrize(
    ("name", "outcome", "words"),
    [
        (
            "starter",
            "time_limit",
            "Fix this first: Your node published no velocity command on /turtle1/cmd_vel in 4.0 s",
        ),
        ("syntax_error", "crashed", "SyntaxError: expected ':' (turtle_controller.py, line 2)"),
        ("forges", "exited", "ended by itself"),
    ],
)
def test_a_submission_that_cannot_draw_gets_zero_and_is_told_why(name, outcome, words):
    run = graded(name)
    assert (run.code, run.result["score"], run.result["run"]["outcome"]) == (0, 0, outcome)
    assert words in run.stdout
    assert "Traceback" not in run.stdout + run.stderr
    assert main(["check", str(run.out / "recording"), "--fail-under", "1"]) == 1


@pytest.mark.parametrize(
    ("name", "content", "word"),
    [
        ("nothing.py", None, "nothing.py"),
        ("empty.zip", b"PK\x05\x06" + bytes(18), "empty"),
        (
            "mixed.py",
            b"from turtlesim.msg import Pose\nfrom turtlesim_msgs.srv import SetPen\n",
            "imports both turtlesim (mixed.py, line 1) and turtlesim_msgs (mixed.py, line 2)",
        ),
        (".", None, "folder"),
    ],
)
def test_what_cannot_be_graded_gives_one_message_exit_code_2_and_no_files(
    tmp_path, name, content, word
):
    handed_in = tmp_path / "handed_in"
    handed_in.mkdir()
    if content is not None:
        (handed_in / name).write_bytes(content)
    code, _, messages = called(handed_in / name, "--out", tmp_path / "out")
    assert (code, word in messages, "Traceback" in messages) == (2, True, False), messages
    assert not (tmp_path / "out").exists()


def is_busy(process):
    """Whether it has done nothing but use the processor; of a fork its parent's start is not in."""
    with suppress(psutil.Error):
        return process.cpu_times().user > 0.3
    return False


@pytest.mark.more("that all processes end with the grader is tested where they are started")
def test_a_killed_grader_takes_all_its_processes_along(tmp_path):
    slow = tmp_path / "slow.py"
    slow.write_text("while True: pass\n")
    process = start(slow, "--out", tmp_path / "out")
    grader, family = psutil.Process(process.pid), []
    while not any(map(is_busy, set(family) - set(grader.children()))):
        with suppress(subprocess.TimeoutExpired):
            process.wait(0.02)
        assert process.poll() is None
        family = grader.children(recursive=True)
    process.kill()
    process.communicate()
    gone, alive = psutil.wait_procs(family, timeout=20)
    assert len(gone) >= 2
    assert not alive
    with scratch.make_folder():
        pass  # as the next run does, which removes what this one has left
