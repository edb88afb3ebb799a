"""`grader run` on real submissions: real processes, real ROS, virtual time and real time.

Each submission is graded when the first test looks at it, and only once.
"""

from __future__ import annotations

import io
import json
import os
import subprocess
import sys
import zipfile
from contextlib import redirect_stderr, redirect_stdout, suppress
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import psutil
import pytest
import yaml

from grader import scratch
from grader.cli import main
from grader.run.processes import FORK_SERVER
from grader.scenes.turtlesim.interfaces import adapted
from grader.strict_json import first_error
from tests import once
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
    "in_real_time": NODE.format(topic="/turtle1/cmd_vel")
    + "pub.publish(twist)\nrclpy.spin(node)\n",
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
    left_running: tuple[str, ...] = ()

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


def process_of(submission: Path, out: Path, *more: str) -> Graded:
    return finish(start(submission, out, *more), out)


def called(submission: Path, out: Path, *more: str) -> Graded:
    """The same in this process, for what is the same there."""
    said, messages = io.StringIO(), io.StringIO()
    with (
        pytest.MonkeyPatch.context() as patch,
        redirect_stdout(said),
        redirect_stderr(messages),
    ):
        patch.setenv("COLUMNS", "200")
        patch.chdir(out.parent)
        code = main(["run", str(submission), "--out", str(out), *more])
    return Graded(code, said.getvalue(), messages.getvalue(), out)


def finish(process: subprocess.Popen[str], out: Path) -> Graded:
    stdout, stderr = process.communicate(timeout=100)
    return Graded(process.returncode, stdout, stderr, out)


def short_exercise(**more: object) -> str:
    """The challenge with short limits and nominal runs only: a test suite is in a hurry."""
    source = ROOT / "grader/exercises/turtlesim_challenge/exercise.yaml"
    data = yaml.safe_load(source.read_text()) | {"limits": SHORT_LIMITS}
    data["varied_runs"]["count"] = 0
    return yaml.safe_dump(data | more)


@pytest.fixture(scope="module")
def exercise(tmp_path_factory) -> Path:
    path = tmp_path_factory.mktemp("exercise") / "short.yaml"
    path.write_text(short_exercise())
    return path


NAMES = ("quick_spiral", "starter", *FILES)
#: What the exercise says besides. A whole spiral takes ten seconds of the clock.
ALSO: dict[str, dict[str, object]] = {"in_real_time": {"points": {"moves": 100}}}


def _grade(name: str, folder: Path) -> None:
    """Grade the submission of this name; the folder keeps all that became of it."""
    submission = SUBMISSIONS / "quick_spiral.py"
    if name in FILES:
        submission = folder / name / "turtle_controller.py"
        submission.parent.mkdir()
        submission.write_text(FILES[name])
    elif name == "starter":
        submission = folder / name
        with redirect_stdout(io.StringIO()), redirect_stderr(io.StringIO()):
            assert main(["new", str(submission)]) == 0
    (folder / "short.yaml").write_text(short_exercise(**ALSO.get(name, {})))
    words = ["--exercise", str(folder / "short.yaml")]
    words += ["--time", "real"] if name == "in_real_time" else []
    # one as a process of its own, the others by what this one has imported already
    how = process_of if name == "quick_spiral" else called
    run = how(submission, folder / "out", *words)
    lines = [" ".join(p.info["cmdline"] or []) for p in psutil.process_iter(["cmdline"])]
    left = [line for line in lines if str(folder) in line]
    kept = {"code": run.code, "stdout": run.stdout, "stderr": run.stderr, "left_running": left}
    (folder / "kept.json").write_text(json.dumps(kept))


@pytest.fixture(scope="module")
def graded():
    """What became of a submission, by its name; nobody changes it."""

    def of(name: str) -> Graded:
        key = (name, FILES.get(name), SHORT_LIMITS, ALSO.get(name))
        folder = once.folder(partial(_grade, name), "grader run", *key)
        return Graded(**json.loads((folder / "kept.json").read_text()), out=folder / "out")

    return of


@pytest.mark.parametrize(("name", "time"), [("quick_spiral", "virtual"), ("in_real_time", "real")])
def test_a_right_solution_gets_full_marks_by_either_clock(graded, name, time):
    run = graded(name)
    assert run.code == 0, run.stderr
    assert (run.result["score"], run.result["max_score"]) == (100, 100)
    assert (run.result["run"]["outcome"], run.result["run"]["time"]) == ("finished", time)


@both
def test_a_solution_for_newer_releases_of_ros_needs_nothing_but_to_be_graded(graded):
    run, older = graded("for_lyrical"), graded("quick_spiral")
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
        pair = [(each.out / "recording" / bag).read_bytes() for each in (run, older)]
        assert pair[0] == pair[1]


@pytest.mark.more("both the clock and the interfaces are in `make test`, not together")
@both
def test_it_is_graded_in_real_time_as_well(tmp_path, exercise):
    path = tmp_path / "turtle_controller.py"
    path.write_text(FILES["for_lyrical"])
    out = tmp_path / "out"
    run = finish(start(path, out, "--exercise", str(exercise), "--time", "real"), out)
    assert (run.code, run.result["score"]) == (0, 100)
    assert run.result["run"]["interfaces"] == "turtlesim_msgs"


def test_the_untouched_starter_gets_nothing_and_a_first_line_that_says_why(graded):
    run = graded("starter")
    assert (run.code, run.result["score"]) == (0, 0)
    assert run.stdout.startswith(
        "Fix this first: Your node published no velocity command on /turtle1/cmd_vel in 4.0 s"
    )
    assert run.result["run"]["outcome"] == "time_limit"


stalls = pytest.mark.more("the patience with a node that is stuck is long; tests of runs prove it")


@pytest.mark.parametrize(
    ("name", "outcome", "words"),
    [
        ("syntax_error", "crashed", "SyntaxError: expected ':' (turtle_controller.py, line 2)"),
        ("missing_import", "crashed", "No module named 'turtlesim_messages' (turtle_controller.py"),
        ("exits_at_once", "exited", "ended by itself"),
        pytest.param("never_ends", "stalled", "no velocity command", marks=stalls),
        ("wrong_topic", "time_limit", "/turtle/cmd_vel"),
    ],
)
def test_a_submission_that_cannot_draw_gets_zero_and_is_told_why(graded, name, outcome, words):
    run = graded(name)
    assert (run.code, run.result["score"], run.result["run"]["outcome"]) == (0, 0, outcome)
    assert words in run.stdout
    assert "Traceback" not in run.stdout + run.stderr


def test_what_a_submission_writes_and_prints_is_no_result(graded):
    assert graded("forges").result["score"] == 0


def test_a_submission_that_starts_processes_is_graded_in_real_time_and_the_result_says_why(graded):
    run = graded("forks_away").result["run"]
    assert run["time"] == "real"
    assert any("graded in real time" in flag for flag in run["flags"])


@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=stalls) if n == "never_ends" else n for n in NAMES]
)
def test_a_result_follows_the_schema_its_files_exist_and_no_process_is_left(graded, name):
    run = graded(name)
    assert first_error("grader.result", "result", run.result) is None
    assert all((run.out / path).exists() for path in run.result["artifacts"].values())
    assert not run.left_running


def test_the_page_of_a_run_is_the_one_that_report_makes_of_its_folder(graded, capfdbinary):
    for run in (graded("quick_spiral"), graded("missing_import"), graded("in_real_time")):
        page = run.out / "report.html"
        capfdbinary.readouterr()
        assert main(["report", str(run.out / "result.json"), "--format", "html"]) == 0
        assert page.read_bytes() == capfdbinary.readouterr().out


def test_a_score_below_the_mark_exits_with_1(graded):
    recording = graded("starter").out / "recording"
    assert main(["check", str(recording), "--fail-under", "1"]) == 1


def test_a_recording_judged_again_gets_the_same_verdicts(graded, tmp_path, exercise):
    for name in ("quick_spiral", "starter", *(["for_lyrical"] if has_both else [])):
        file = tmp_path / f"{name}.json"
        words = ["check", graded(name).out / "recording", "--json", file, "--exercise", exercise]
        assert main([*map(str, words)]) == 0
        again = json.loads(file.read_text())
        assert again["verdicts"] == graded(name).result["verdicts"]
        assert again["run"] == graded(name).result["run"]


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
    run = called(make(handed_in), out)
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
    while not is_over(process):  # a spoiled run is repeated once
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
    wait_for_a_busy_run(process)
    family = grader.children(recursive=True)
    process.kill()
    process.communicate()
    gone, alive = psutil.wait_procs(family, timeout=20)
    assert len(gone) >= 2
    assert not alive
    with scratch.make_folder():
        pass  # as the next run does, which removes what this one has left


def wait_for_a_busy_run(process: subprocess.Popen[str]) -> None:
    """Wait until a run has its simulator, and a process that does nothing but use the processor."""
    grader, is_busy = psutil.Process(process.pid), False
    while not (is_busy and running(grader, SIMULATOR)):
        assert not is_over(process)
        forked = set(grader.children(recursive=True)) - set(grader.children())
        is_busy = any(used_s(each) > 0.3 for each in forked)  # nothing of its start is counted


def is_over(process: subprocess.Popen[str]) -> bool:
    """Whether it has ended, a moment later: who only looks takes the time that others need."""
    with suppress(subprocess.TimeoutExpired):
        process.wait(0.02)
    return process.poll() is not None


def used_s(process: psutil.Process) -> float:
    """The processor time of a process; of one that has ended, none."""
    with suppress(psutil.Error):
        return process.cpu_times().user
    return 0.0


def running(grader: psutil.Process, name: str) -> list[psutil.Process]:
    """The processes of a module that serve runs."""
    own = grader.children()
    forked = [child for process in own for child in children(process)]
    family = [p for p in own if FORK_SERVER not in words(p)] + forked
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
