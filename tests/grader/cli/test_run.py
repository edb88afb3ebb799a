"""`grader run` on real submissions: real processes, real ROS, virtual time and real time.

All runs of this module are started at once.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import zipfile
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import jsonschema
import psutil
import pytest
import yaml

from grader.result import json_file
from grader.run.processes import ZYGOTE
from grader.scenes.turtlesim.interfaces import adapted
from turtlesim_py.ros.interfaces import installed

SUBMISSIONS = Path(__file__).parents[2] / "submissions"
ROOT = Path(__file__).parents[3]

#: How the module that the simulator's process runs is called, up to the kind of time.
SIMULATOR = "grader.run.simulator."
SHORT_LIMITS = {"first_motion_s": 4, "rest_s": 1, "total_s": 30}

NODE = """
import rclpy
from geometry_msgs.msg import Twist
rclpy.init()
node = rclpy.create_node("node")
pub = node.create_publisher(Twist, {topic!r}, 10)
twist = Twist()
twist.linear.x = 1.0
"""

#: name -> what the file turtle_controller.py holds
FILES = {
    "syntax_error": "import rclpy\ndef main()\n    pass\n",
    "missing_import": "import rclpy\nimport turtlesim_messages\n\ndef main():\n    pass\n",
    "exits_at_once": "print('nothing to do')\n",
    "never_ends": NODE.format(topic="/turtle1/cmd_vel")
    + "rclpy.spin_once(node, timeout_sec=0.1)\nwhile True:\n    pass\n",
    "wrong_topic": NODE.format(topic="/turtle/cmd_vel")
    + "node.create_timer(0.1, lambda: pub.publish(twist))\nrclpy.spin(node)\n",
    "forks_away": "import os, time\nif os.fork() == 0:\n    os.setsid()\n    time.sleep(1000)\n",
    "forges": "import json, pathlib\n"
    "pathlib.Path('result.json').write_text(json.dumps({'score': 100}))\n"
    "print(json.dumps({'say': 'done', 'reason': 'rest'}))\n",
}
#: The right solution as a student of Lyrical writes it.
if has_both := len(installed()) == 2:
    FILES["for_lyrical"] = adapted((SUBMISSIONS / "quick_spiral.py").read_text(), "lyrical")
both = pytest.mark.skipif(not has_both, reason="beside a sourced ROS there is one package")


@dataclass
class Graded:
    """A finished `grader run`."""

    code: int
    stdout: str
    stderr: str
    out: Path

    @property
    def result(self):
        return json.loads((self.out / "result.json").read_text())


def start(submission: Path, out: Path, *more: str) -> subprocess.Popen[str]:
    command = [sys.executable, "-m", "grader", "run", submission, "--out", out, *more]
    return subprocess.Popen(
        [str(word) for word in command],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env={**os.environ, "PYTHONPATH": str(ROOT), "COLUMNS": "200"},
        cwd=out.parent,
    )


def finish(process: subprocess.Popen[str], out: Path) -> Graded:
    stdout, stderr = process.communicate(timeout=100)
    return Graded(process.returncode, stdout, stderr, out)


@pytest.fixture(scope="module")
def exercise(tmp_path_factory) -> Path:
    """The challenge with short limits and nominal runs only: a test suite is in a hurry."""
    source = ROOT / "grader/exercises/turtlesim_challenge/exercise.yaml"
    data = yaml.safe_load(source.read_text()) | {"limits": SHORT_LIMITS}
    data["varied_runs"]["count"] = 0
    path = tmp_path_factory.mktemp("exercise") / "short.yaml"
    path.write_text(yaml.safe_dump(data))
    return path


@pytest.fixture(scope="module")
def graded(tmp_path_factory, exercise):
    """Every submission of this module, graded at the same time."""
    folder = tmp_path_factory.mktemp("graded")
    paths = {"quick_spiral": SUBMISSIONS / "quick_spiral.py"}
    for name, text in FILES.items():
        paths[name] = folder / name / "turtle_controller.py"
        paths[name].parent.mkdir()
        paths[name].write_text(text)
    paths["starter"] = folder / "starter"
    new = [sys.executable, "-m", "grader", "new", str(paths["starter"])]
    subprocess.run(new, check=True, capture_output=True, cwd=ROOT)
    outs = {name: folder / f"out_{name}" for name in paths}
    running = {
        name: start(path, outs[name], "--exercise", str(exercise)) for name, path in paths.items()
    }
    outs["in_real_time"] = folder / "out_real"
    running["in_real_time"] = start(paths["quick_spiral"], outs["in_real_time"], "--time", "real")
    return {name: finish(process, outs[name]) for name, process in running.items()}


@pytest.mark.parametrize(("name", "time"), [("quick_spiral", "virtual"), ("in_real_time", "real")])
def test_a_right_solution_gets_full_marks_by_either_clock(graded, name, time):
    run = graded[name]
    assert run.code == 0, run.stderr
    assert (run.result["score"], run.result["max_score"]) == (100, 100)
    assert (run.result["run"]["outcome"], run.result["run"]["time"]) == ("finished", time)


@both
def test_a_solution_for_newer_releases_of_ros_needs_nothing_but_to_be_graded(graded):
    run, older = graded["for_lyrical"], graded["quick_spiral"]
    assert (run.code, run.result["score"]) == (0, 100)
    assert run.result["verdicts"] == older.result["verdicts"]
    assert run.result["run"]["trace_sha256"] == older.result["run"]["trace_sha256"]
    assert run.result["run"]["interfaces"] == "turtlesim_msgs"
    assert older.result["run"]["interfaces"] == "turtlesim"
    (flag,) = run.result["run"]["flags"]
    assert "turtlesim_msgs" in flag
    facts = json.loads((run.out / "recording" / "run.json").read_text())
    assert facts["run"]["interfaces"] == "turtlesim_msgs"
    for bag in ("recording.mcap", "metadata.yaml"):
        pair = [(graded_.out / "recording" / bag).read_bytes() for graded_ in (run, older)]
        assert pair[0] == pair[1]


@both
def test_it_is_graded_in_real_time_as_well(tmp_path, exercise):
    path = tmp_path / "turtle_controller.py"
    path.write_text(FILES["for_lyrical"])
    out = tmp_path / "out"
    run = finish(start(path, out, "--exercise", str(exercise), "--time", "real"), out)
    assert (run.code, run.result["score"]) == (0, 100)
    assert run.result["run"]["interfaces"] == "turtlesim_msgs"


def test_the_untouched_starter_gets_nothing_and_a_first_line_that_says_why(graded):
    run = graded["starter"]
    assert (run.code, run.result["score"]) == (0, 0)
    assert run.stdout.startswith(
        "First to mend: Your node published no velocity command on /turtle1/cmd_vel in 4.0 s"
    )
    assert run.result["run"]["outcome"] == "time_limit"


@pytest.mark.parametrize(
    ("name", "outcome", "words"),
    [
        ("syntax_error", "crashed", "SyntaxError: expected ':' (turtle_controller.py, line 2)"),
        ("missing_import", "crashed", "No module named 'turtlesim_messages' (turtle_controller.py"),
        ("exits_at_once", "exited", "ended by itself"),
        ("never_ends", "stalled", "no velocity command"),
        ("wrong_topic", "time_limit", "/turtle/cmd_vel"),
    ],
)
def test_a_submission_that_cannot_draw_gets_zero_and_is_told_why(graded, name, outcome, words):
    run = graded[name]
    assert (run.code, run.result["score"], run.result["run"]["outcome"]) == (0, 0, outcome)
    assert words in run.stdout
    assert "Traceback" not in run.stdout + run.stderr


def test_what_a_submission_writes_and_prints_is_no_result(graded):
    assert graded["forges"].result["score"] == 0


def test_a_submission_that_starts_processes_is_graded_in_real_time_and_the_result_says_why(graded):
    run = graded["forks_away"].result["run"]
    assert run["time"] == "real"
    assert any("graded in real time" in flag for flag in run["flags"])


def test_every_result_follows_the_schema_and_its_files_exist(graded):
    for run in graded.values():
        jsonschema.validate(run.result, json_file.schema("result"))
        assert all((run.out / path).exists() for path in run.result["artifacts"].values())


def test_the_page_of_a_run_is_the_one_that_report_makes_of_its_folder(graded):
    for run in (graded["quick_spiral"], graded["missing_import"], graded["in_real_time"]):
        page = run.out / "report.html"
        words = ["report", run.out / "result.json", "--format", "html"]
        again = subprocess.run(
            [sys.executable, "-m", "grader", *map(str, words)],
            check=True,
            capture_output=True,
            cwd=ROOT,
        )
        assert page.read_bytes() == again.stdout


def test_no_process_is_left_behind(graded):
    lines = [" ".join(p.info["cmdline"] or []) for p in psutil.process_iter(["cmdline"])]
    folders = [str(run.out.parent) for run in graded.values()]
    assert not [line for line in lines if any(folder in line for folder in folders)]


def test_a_score_below_the_mark_exits_with_1(graded, tmp_path):
    recording = graded["starter"].out / "recording"
    words = [sys.executable, "-m", "grader", "check", str(recording), "--fail-under", "1"]
    done = subprocess.run(words, capture_output=True, text=True, check=False, cwd=ROOT)
    assert done.returncode == 1


def test_a_recording_judged_again_gets_the_same_verdicts(graded, tmp_path, exercise):
    for name in ("quick_spiral", "starter", *(["for_lyrical"] if has_both else [])):
        file = tmp_path / f"{name}.json"
        words = ["check", graded[name].out / "recording", "--json", file, "--exercise", exercise]
        subprocess.run(
            [sys.executable, "-m", "grader", *map(str, words)],
            check=True,
            capture_output=True,
            cwd=ROOT,
        )
        again = json.loads(file.read_text())
        assert again["verdicts"] == graded[name].result["verdicts"]
        assert again["run"] == graded[name].result["run"]


def written_for_no_ros(folder):
    path = folder / "mixed.py"
    path.write_text("from turtlesim.msg import Pose\nfrom turtlesim_msgs.srv import SetPen\n")
    return path


def empty_zip(folder):
    path = folder / "empty.zip"
    zipfile.ZipFile(path, "w").close()
    return path


@pytest.mark.parametrize(
    ("make", "word"),
    [
        (lambda folder: folder / "nothing.py", "nothing.py"),
        (empty_zip, "empty"),
        (
            written_for_no_ros,
            "imports both turtlesim (mixed.py, line 1) and turtlesim_msgs (mixed.py, line 2)",
        ),
        (lambda folder: folder, "folder"),
    ],
)
def test_what_cannot_be_graded_gives_one_message_exit_code_2_and_no_files(tmp_path, make, word):
    handed_in = tmp_path / "handed_in"
    handed_in.mkdir()
    out = tmp_path / "out"
    run = finish(start(make(handed_in), out), out)
    assert run.code == 2
    assert word in run.stderr
    assert "Traceback" not in run.stderr
    assert not out.exists()


def test_a_simulator_that_dies_is_the_graders_failure_and_leaves_no_result(tmp_path, exercise):
    out = tmp_path / "out"
    slow = tmp_path / "slow.py"
    slow.write_text("while True: pass\n")
    process = start(slow, out, "--exercise", str(exercise))
    grader = psutil.Process(process.pid)
    while process.poll() is None:  # a spoiled run is repeated once
        with suppress(psutil.Error):
            for simulator in running(grader, SIMULATOR):
                simulator.kill()
    run = finish(process, out)
    assert run.code == 3
    assert "not the submission's fault" in run.stderr
    assert not (out / "result.json").exists()


def test_a_killed_grader_takes_both_processes_along(tmp_path, exercise):
    out = tmp_path / "out"
    slow = tmp_path / "slow.py"
    slow.write_text("while True: pass\n")
    process = start(slow, out, "--exercise", str(exercise))
    grader = psutil.Process(process.pid)
    wait_for_a_busy_run(grader)
    family = grader.children(recursive=True)
    process.kill()
    process.communicate()
    gone, alive = psutil.wait_procs(family, timeout=20)
    assert len(gone) >= 2
    assert not alive


def wait_for_a_busy_run(grader: psutil.Process) -> None:
    """Wait until a run has its simulator, and a process that does nothing but use the processor."""
    is_busy = False
    while not (is_busy and running(grader, SIMULATOR)):
        assert grader.is_running()
        assert grader.status() != psutil.STATUS_ZOMBIE
        is_busy = any(used_s(each) > 1.0 for each in grader.children(recursive=True))


def used_s(process: psutil.Process) -> float:
    """The processor time of a process; of one that has ended, none."""
    with suppress(psutil.Error):
        return process.cpu_times().user
    return 0.0


def running(grader: psutil.Process, name: str) -> list[psutil.Process]:
    """The processes of a module that serve runs."""
    own = grader.children()
    forked = [child for process in own for child in children(process)]
    family = [p for p in own if ZYGOTE not in words(p)] + forked
    return [p for p in family if any(word.startswith(name) for word in words(p))]


def children(process: psutil.Process) -> list[psutil.Process]:
    """A process's children; of one that has ended, none."""
    with suppress(psutil.Error):
        return process.children()
    return []


def words(process: psutil.Process) -> list[str]:
    """A process's command line; of one that has ended, nothing."""
    with suppress(psutil.Error):
        return process.cmdline() if process.status() != psutil.STATUS_ZOMBIE else []
    return []
