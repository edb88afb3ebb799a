"""What surrounds the two processes of a run, whatever surrounds the grader."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from grader import scratch
from grader.errors import NotNow
from grader.recording.recording import Recording
from grader.run import environment, real_time, virtual_time
from grader.run.finish import SimulatorLost
from grader.run.handover import Plan
from grader.run.opening import open_submission
from grader.run.processes import levels, network
from grader.run.run_context import RunContext
from grader.scenes.scene import Limits
from tests.tiers import others_are_more
from turtlesim_py.world.events import CmdVel

ROOT = Path(__file__).parents[3]


CLOCKS = {"virtual": virtual_time.run, "real": real_time.run}
either_clock = pytest.mark.parametrize(
    "clock", others_are_more("the same surroundings, some seconds", CLOCKS, "virtual")
)


def recorded(
    folder: Path, text: str, clock: str = "virtual", *, name: str = "node.py", runs: int = 1
) -> Recording:
    """The last of so many runs of a submission."""
    (folder / name).write_text(text)
    with open_submission(folder / name) as submission:
        made = [CLOCKS[clock](submission, Plan(Limits(0.2, 0.2, 2))) for _ in range(runs)]
    return made[-1]


@pytest.fixture
def unconfined(monkeypatch: pytest.MonkeyPatch) -> None:
    """A level at which a submission reaches more than its own."""
    monkeypatch.setattr(levels, "best", lambda isolated: levels.Level("limits"))


OF_ROS_OR_PYTHON = (
    *("RMW_IMPLEMENTATION", "ROS_LOCALHOST_ONLY", "ROS_STATIC_PEERS", "ROS_SECURITY_ENABLE"),
    *("RCUTILS_CONSOLE_OUTPUT_FORMAT", "CYCLONEDDS_URI", "FASTRTPS_DEFAULT_PROFILES_FILE"),
    *("PYTHONPATH", "PYTHONSTARTUP"),
)


def test_nothing_of_the_user_s_ros_or_python_comes_along(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    for name in OF_ROS_OR_PYTHON:
        monkeypatch.setenv(name, "nonsense")
    monkeypatch.delenv("ROS_DISTRO", raising=False)
    env = environment.environment(tmp_path, {"ROS_DOMAIN_ID": "50"})
    assert "nonsense" not in env.values()
    assert env["ROS_DOMAIN_ID"] == "50"
    assert environment.simulator_environment(env)["PYTHONPATH"] == str(ROOT)


#: What is nobody's business, is the user's taste, or leads to what he has.
SECRETS = (
    *("GITHUB_TOKEN", "CI_JOB_TOKEN", "AWS_SECRET_ACCESS_KEY", "ACTIONS_RUNTIME_TOKEN"),
    *("SSH_AUTH_SOCK", "DBUS_SESSION_BUS_ADDRESS", "XDG_RUNTIME_DIR", "DISPLAY", "XAUTHORITY"),
    *("LD_PRELOAD", "GCONV_PATH", "MPLBACKEND", "UNHEARD_OF", "ROS_DOMAIN_ID", "HOME", "OLDPWD"),
    *("PATH_TOKEN", "path", "TZ_", "LC_ALL", "LD_AUDIT", "PYTHONUSERBASE"),
)


def test_nothing_comes_along_but_what_is_named(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    for name in SECRETS:
        monkeypatch.setenv(name, "secret")
    monkeypatch.setenv("TZ", "Asia/Tokyo")
    env = environment.environment(tmp_path, {})
    both = env | environment.simulator_environment(env) | environment.virtual_environment(env)
    assert "secret" not in both.values()
    assert env["TZ"] == "Asia/Tokyo"
    assert env["PATH"] == os.environ["PATH"]
    assert Path(env["HOME"]).is_dir()
    assert Path(env["HOME"]).is_relative_to(tmp_path)


@pytest.mark.parametrize("of", [environment.student_environment, environment.virtual_environment])
def test_messages_of_a_submission_look_at_their_fields_whatever_the_user_has_asked_for(of) -> None:  # type: ignore[no-untyped-def]
    assert of({"ROS_PYTHON_CHECK_FIELDS": "0"})["ROS_PYTHON_CHECK_FIELDS"] == "1"


def test_packages_that_the_user_has_installed_for_himself_are_found_in_another_home(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(environment.site, "ENABLE_USER_SITE", True)
    monkeypatch.setattr(environment.site, "getuserbase", lambda: "/home/ada/.local")
    assert environment.environment(tmp_path, {})["PYTHONUSERBASE"] == "/home/ada/.local"


TELLS = """
import os
names = [name for name in os.environ if "TOKEN" in name]
started_with = open("/proc/self/environ").read()
print(names, "a-token" in started_with, os.path.expanduser("~") == os.environ["HOME"])
"""


@either_clock
def test_a_token_never_reaches_a_submission_s_process(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, clock: str
) -> None:
    monkeypatch.setenv("GITHUB_TOKEN", "a-token")
    assert recorded(tmp_path, TELLS, clock).output == "[] False True\n"


def test_a_sourced_ros_is_kept(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("ROS_DISTRO", "jazzy")
    monkeypatch.setenv("PYTHONPATH", "/opt/ros")
    env = environment.environment(tmp_path, {})
    assert (env["ROS_DISTRO"], env["PYTHONPATH"]) == ("jazzy", "/opt/ros")
    assert environment.simulator_environment(env)["PYTHONPATH"] == f"{ROOT}:/opt/ros"


MISLEADING = (
    "turtlesim.py",
    "numpy.py",
    "json.py",
    "grader/run/simulator.py",
    "grader/__init__.py",
)
TELLS_WHERE = """
import os, sys
import rclpy
rclpy.init()
print('cwd', os.path.basename(os.getcwd()), sys.argv[1:])
"""
#: A grader: the clock, where its packages are, what is handed in.
RUNS = """
import sys
from pathlib import Path
clock, root, path = sys.argv[1:]
sys.path.insert(0, root)
from grader.run import real_time, virtual_time
from grader.run.handover import Plan
from grader.run.opening import open_submission
from grader.scenes.scene import Limits
with open_submission(Path(path)) as submission:
    recording = globals()[f"{clock}_time"].run(submission, Plan(Limits(0.2, 0.2, 2)))
print(recording.run.outcome, recording.output)
"""


@either_clock
def test_files_in_the_user_s_folder_do_not_replace_the_simulator(
    tmp_path: Path, clock: str
) -> None:
    for name in MISLEADING:
        (tmp_path / name).parent.mkdir(exist_ok=True, parents=True)
        (tmp_path / name).write_text("raise SystemExit('misled')\n")
    handed_in = tmp_path / "handed_in" / "weg_zurück.py"
    handed_in.parent.mkdir()
    handed_in.write_text(TELLS_WHERE)
    misleads = {"PYTHONPATH": str(tmp_path / "nowhere"), "RMW_IMPLEMENTATION": "none"}
    done = subprocess.run(
        [sys.executable, "-P", "-c", RUNS, clock, str(ROOT), str(handed_in)],
        cwd=tmp_path,
        env=os.environ | misleads | {"LC_ALL": "POSIX"},
        capture_output=True,
        encoding="utf-8",
        check=False,
    )
    assert done.stdout.split() == ["exited", "cwd", "handed_in", "[]"], done.stdout + done.stderr


LOOKS_FOR_THE_RECORDING = """
import glob, os, time
import rclpy
from geometry_msgs.msg import Twist
rclpy.init()
publisher = rclpy.create_node("driver").create_publisher(Twist, "/turtle1/cmd_vel", 10)
twist = Twist()
twist.linear.x = 1.0
publisher.publish(twist)
folder = os.environ["TMPDIR"]
if folder != "/tmp":
    folder = os.path.dirname(folder)
for _ in range(8):
    time.sleep(0.1)
    found = [os.path.join(at, name) for at, _, names in os.walk(folder) for name in names
             if "site-packages" not in at]
    found += glob.glob("/proc/self/fd/*")
    found = [path for path in found if "recording" in os.path.basename(os.path.realpath(path))]
    if found:
        print(found, flush=True)
"""


@either_clock
def test_the_recording_is_out_of_the_submission_s_reach(tmp_path: Path, clock: str) -> None:
    (tmp_path / "looks.py").write_text(LOOKS_FOR_THE_RECORDING)
    with open_submission(tmp_path / "looks.py") as submission:
        recording = CLOCKS[clock](submission, Plan(Limits(first_motion_s=2, rest_s=0.3, total_s=9)))
    assert recording.trace.of_kind(CmdVel)
    assert recording.output == ""


#: What lies beside it, what it is called, where it stands, whether it can change what it is.
LOOKS_ROUND = """
import importlib, os, stat, sys
print(__file__, os.getcwd(), sys.path[0], os.listdir())
for name in ("bob", "turtlesim.msg"):
    try:
        print(getattr(importlib.import_module(name), "WHOSE", "installed"))
    except ImportError as error:
        print(error)
modes = [stat.S_IMODE(os.stat(path).st_mode) for path in (".", __file__)]
print([oct(mode) for mode in modes], os.path.exists("__pycache__"))
raise ValueError("mine")
"""


@either_clock
def test_a_submission_runs_in_a_copy_and_tells_of_where_it_was_handed_in(
    tmp_path: Path, clock: str
) -> None:
    for name in ("bob.py", "turtlesim.py"):
        (tmp_path / name).write_text("WHOSE = 'a neighbour'\n")
    recording = recorded(tmp_path, LOOKS_ROUND, clock, name="alice.py")
    script = tmp_path / "alice.py"
    assert recording.output.splitlines() == [
        f"{script} {tmp_path} {tmp_path} ['alice.py']",
        "No module named 'bob'",
        "installed",
        "['0o755', '0o644'] False",
        "Traceback (most recent call last):",
        f'  File "{script}", line 11, in <module>',
        '    raise ValueError("mine")',
        "ValueError: mine",
    ]
    there = {path.name for path in tmp_path.iterdir()}
    assert there == {"alice.py", "bob.py", "turtlesim.py"}


WRITES = """
import os, sqlite3
os.mkdir("logs")
for path in ("logs/log.csv", __file__):
    with open(path, "a") as file:
        file.write("# more")
sqlite3.connect("my.db").close()
print(sorted(os.listdir()))
"""


@either_clock
@pytest.mark.parametrize("level", ["the best", "limits"])
def test_a_submission_writes_into_its_own_folder_and_no_other_run_sees_it(
    tmp_path: Path, request: pytest.FixtureRequest, clock: str, level: str
) -> None:
    if level == "limits":
        request.getfixturevalue("unconfined")
    recording = recorded(tmp_path, WRITES, clock, runs=2)
    assert recording.output == "['logs', 'my.db', 'node.py']\n"
    assert (tmp_path / "node.py").read_text() == WRITES
    assert [path.name for path in tmp_path.iterdir()] == ["node.py"]


LEAVES = """
import os, tempfile
here = os.environ["HOME"]
os.makedirs(f"{here}/closed/in")
os.chmod(f"{here}/closed", 0)
os.mkfifo(f"{here}/pipe")
os.symlink("/", f"{here}/all")
os.mkfifo(os.path.join(tempfile.gettempdir(), "pipe"))
for _ in range(300):
    os.mkdir("d" * 50) if _ else os.chdir(here)
    os.chdir("d" * 50) if _ else None
print(here)
"""


@pytest.mark.usefixtures("unconfined")  # else it has a file system of its own, which goes with it
def test_nothing_is_left_of_the_folder_of_a_run(tmp_path: Path) -> None:
    recording = recorded(tmp_path, LEAVES, runs=2)
    assert recording.run.exit_code == 0, recording.output
    assert not Path(recording.output.strip()).parent.exists()
    assert Path("/").is_dir()


TAKES_ITS_RUN_AWAY = """
import os, shutil
shutil.rmtree(os.path.dirname(os.environ["HOME"]))
"""


@pytest.mark.usefixtures("unconfined")  # else it cannot
def test_a_run_goes_on_when_the_submission_has_taken_its_folder_away_before_the_simulator_came(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    start = virtual_time.start_simulator

    def start_when_it_is_gone(module: str, context: RunContext, *more: Any, **options: Any) -> Any:
        deadline = time.monotonic() + 60
        while context.folder.exists():
            assert time.monotonic() < deadline, "the folder stays"
            time.sleep(0.01)
        return start(module, context, *more, **options)

    monkeypatch.setattr(virtual_time, "start_simulator", start_when_it_is_gone)
    run = recorded(tmp_path, TAKES_ITS_RUN_AWAY).run
    assert (run.time, run.outcome, run.exit_code, run.flags) == ("virtual", "exited", 0, ())


KEEPS_ALL_LOCKS = """
import fcntl, glob, os, time
told, tells = os.pipe()
if os.fork() == 0:
    os.setsid()
    if os.fork():
        os._exit(0)
    kept = []
    for path in glob.glob({home!r} + "/*.lock"):
        kept.append(open(path))
        try:
            fcntl.flock(kept[-1], fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            pass
    os.write(tells, b"kept")
    while True:
        time.sleep(1000)
os.wait()
print(os.read(told, 4))
"""


def test_locks_that_a_submission_has_taken_are_free_when_its_run_is_over(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where nothing but its process group keeps it from them; a sandbox hides them."""
    home = tmp_path / "runs"
    home.mkdir()
    monkeypatch.setattr(scratch, "home", lambda: home)
    for number in network.DOMAINS:
        (home / f"domain-{number}.lock").touch()
    recording = recorded(tmp_path, KEEPS_ALL_LOCKS.format(home=str(home)), "real")
    assert recording.output == "b'kept'\n"
    for number in network.DOMAINS:
        lock = scratch.acquire_lock(f"domain-{number}")
        assert lock is not None
        lock.close()


@either_clock
def test_what_could_not_be_confined_is_not_judged(
    clock: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    prepare = levels.prepare

    def prepare_badly(*words: Any, **more: Any) -> levels.Confinement:
        good = prepare(*words, **more)
        steps = [["bind", "/there/is/none"]]
        return replace(good, order={**(good.order or {}), "level": "namespaces", "steps": steps})

    levels.here()  # the trial has been good
    monkeypatch.setattr(levels, "prepare", prepare_badly)
    with pytest.raises(NotNow) as raised:
        recorded(tmp_path, "print('it runs')\n", clock)
    assert not isinstance(raised.value, SimulatorLost)
    assert "could not be started" in str(raised.value.message)
