"""What surrounds the two processes of a run, whatever surrounds the grader."""

import os
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
import yaml

from grader.errors import NotNow
from grader.recording.recording import Recording
from grader.run import environment, virtual_time
from grader.run.finish import SimulatorLost
from grader.run.handover import Plan
from grader.run.opening import open_submission
from grader.run.processes import levels, network
from grader.run.run_context import RunContext
from grader.scenes.scene import Limits
from grader.system import scratch
from tests.grader.run.conftest import CLOCKS, either_clock
from turtlesim_py.world.events import CmdVel

TEXTS = yaml.safe_load(Path(__file__).with_suffix(".yaml").read_text())

ROOT = Path(__file__).parents[3]


def recorded(
    folder: Path, text: str, clock: str = "virtual", *, name: str = "node.py", runs: int = 1
) -> Recording:
    """The last of so many runs of a submission."""
    (folder / name).write_text(text)
    with open_submission(folder / name) as submission:
        made = [CLOCKS[clock](submission, Plan(Limits(0.2, 0.2, 2))) for _ in range(runs)]
    return made[-1]


@pytest.fixture
def unconfined(monkeypatch):
    """A level at which a submission reaches more than its own."""
    monkeypatch.setattr(levels, "best", lambda isolated: levels.Level("limits"))


#: What is nobody's business, is the user's taste or ROS, or leads to what he has.
SECRETS = (
    *("GITHUB_TOKEN", "CI_JOB_TOKEN", "AWS_SECRET_ACCESS_KEY", "ACTIONS_RUNTIME_TOKEN"),
    *("SSH_AUTH_SOCK", "DBUS_SESSION_BUS_ADDRESS", "XDG_RUNTIME_DIR", "DISPLAY", "XAUTHORITY"),
    *("LD_PRELOAD", "GCONV_PATH", "MPLBACKEND", "UNHEARD_OF", "ROS_DOMAIN_ID", "HOME", "OLDPWD"),
    *("PATH_TOKEN", "path", "TZ_", "LC_ALL", "LD_AUDIT", "PYTHONUSERBASE"),
    *("RMW_IMPLEMENTATION", "ROS_LOCALHOST_ONLY", "ROS_STATIC_PEERS", "ROS_SECURITY_ENABLE"),
    *("RCUTILS_CONSOLE_OUTPUT_FORMAT", "CYCLONEDDS_URI", "FASTRTPS_DEFAULT_PROFILES_FILE"),
    *("PYTHONPATH", "PYTHONSTARTUP"),
)


def test_nothing_comes_along_but_what_is_named(monkeypatch, tmp_path):
    for name in SECRETS:
        monkeypatch.setenv(name, "secret")
    monkeypatch.setenv("TZ", "Asia/Tokyo")
    monkeypatch.delenv("ROS_DISTRO", raising=False)
    env = environment.environment(tmp_path, {"ROS_DOMAIN_ID": "50"})
    of_simulator = environment.simulator_environment(env)
    both = env | of_simulator | environment.virtual_environment(env)
    assert "secret" not in both.values()
    assert (env["ROS_DOMAIN_ID"], env["TZ"]) == ("50", "Asia/Tokyo")
    assert (env["PATH"], of_simulator["PYTHONPATH"]) == (os.environ["PATH"], str(ROOT))
    assert Path(env["HOME"]).is_dir()
    assert Path(env["HOME"]).is_relative_to(tmp_path)


@pytest.mark.parametrize("of", [environment.student_environment, environment.virtual_environment])
def test_messages_of_a_submission_look_at_their_fields_whatever_the_user_has_asked_for(of):
    assert of({"ROS_PYTHON_CHECK_FIELDS": "0"})["ROS_PYTHON_CHECK_FIELDS"] == "1"


def test_packages_that_the_user_has_installed_for_himself_are_found_in_another_home(
    monkeypatch, tmp_path
):
    monkeypatch.setattr(environment.site, "ENABLE_USER_SITE", True)
    monkeypatch.setattr(environment.site, "getuserbase", lambda: "/home/ada/.local")
    assert environment.environment(tmp_path, {})["PYTHONUSERBASE"] == "/home/ada/.local"


@either_clock
def test_a_token_never_reaches_a_submission_s_process(monkeypatch, tmp_path, clock):
    monkeypatch.setenv("GITHUB_TOKEN", "a-token")
    assert recorded(tmp_path, TEXTS["tells"], clock).output == "[] False True\n"


def test_a_sourced_ros_is_kept(monkeypatch, tmp_path):
    monkeypatch.setenv("ROS_DISTRO", "jazzy")
    monkeypatch.setenv("PYTHONPATH", "/opt/ros")
    env = environment.environment(tmp_path, {})
    assert (env["ROS_DISTRO"], env["PYTHONPATH"]) == ("jazzy", "/opt/ros")
    assert environment.simulator_environment(env)["PYTHONPATH"] == f"{ROOT}:/opt/ros"


MISLEADING = (
    *("turtlesim.py", "numpy.py", "json.py", "grader/run/simulator.py", "grader/__init__.py"),
)


@either_clock
def test_files_in_the_user_s_folder_do_not_replace_the_simulator(tmp_path, clock):
    for name in MISLEADING:
        (tmp_path / name).parent.mkdir(exist_ok=True, parents=True)
        (tmp_path / name).write_text("raise SystemExit('misled')\n")
    handed_in = tmp_path / "handed_in" / "weg_zurück.py"
    handed_in.parent.mkdir()
    handed_in.write_text(TEXTS["tells_where"])
    misleads = {"PYTHONPATH": str(tmp_path / "nowhere"), "RMW_IMPLEMENTATION": "none"}
    done = subprocess.run(
        [sys.executable, "-P", "-c", TEXTS["runs"], clock, str(ROOT), str(handed_in)],
        cwd=tmp_path,
        env=os.environ | misleads | {"LC_ALL": "POSIX"},
        capture_output=True,
        encoding="utf-8",
        check=False,
    )
    assert done.stdout.split() == ["exited", "cwd", "handed_in", "[]"], done.stdout + done.stderr


@either_clock
def test_the_recording_is_out_of_the_submission_s_reach(tmp_path, clock):
    (tmp_path / "looks.py").write_text(TEXTS["looks_for_the_recording"])
    with open_submission(tmp_path / "looks.py") as submission:
        recording = CLOCKS[clock](submission, Plan(Limits(first_motion_s=2, rest_s=0.3, total_s=9)))
    assert recording.trace.of_kind(CmdVel)
    assert recording.output == ""


@either_clock
def test_a_submission_runs_in_a_copy_and_tells_of_where_it_was_handed_in(tmp_path, clock):
    for name in ("bob.py", "turtlesim.py"):
        (tmp_path / name).write_text("WHOSE = 'a neighbour'\n")
    recording = recorded(tmp_path, TEXTS["looks_round"], clock, name="alice.py")
    script = tmp_path / "alice.py"
    assert recording.output.splitlines() == [
        f"{script} {tmp_path} {tmp_path} ['alice.py']",
        "No module named 'bob'",
        "installed",
        "['0o755', '0o644'] False",
        "Traceback (most recent call last):",
        f'  File "{script}", line 10, in <module>',
        '    raise ValueError("mine")',
        "ValueError: mine",
    ]
    there = {path.name for path in tmp_path.iterdir()}
    assert there == {"alice.py", "bob.py", "turtlesim.py"}


@either_clock
@pytest.mark.parametrize("level", ["the best", "limits"])
def test_a_submission_writes_into_its_own_folder_and_no_other_run_sees_it(
    tmp_path, request, clock, level
):
    if level == "limits":
        request.getfixturevalue("unconfined")
    recording = recorded(tmp_path, TEXTS["writes"], clock, runs=2)
    assert recording.output == "['logs', 'my.db', 'node.py']\n"
    assert (tmp_path / "node.py").read_text() == TEXTS["writes"]
    assert [path.name for path in tmp_path.iterdir()] == ["node.py"]


@pytest.mark.usefixtures("unconfined")  # else it has a file system of its own, which goes with it
def test_nothing_is_left_of_the_folder_of_a_run(tmp_path):
    recording = recorded(tmp_path, TEXTS["leaves"], runs=2)
    assert recording.run.exit_code == 0, recording.output
    assert not Path(recording.output.strip()).parent.exists()
    assert Path("/").is_dir()


@pytest.mark.usefixtures("unconfined")  # else it cannot
def test_a_run_goes_on_when_the_submission_has_taken_its_folder_away_before_the_simulator_came(
    tmp_path, monkeypatch
):
    start = virtual_time.start_simulator

    def start_when_it_is_gone(module: str, context: RunContext, *more: Any, **options: Any) -> Any:
        deadline = time.monotonic() + 60
        while context.folder.exists():
            assert time.monotonic() < deadline, "the folder stays"
            time.sleep(0.01)
        return start(module, context, *more, **options)

    monkeypatch.setattr(virtual_time, "start_simulator", start_when_it_is_gone)
    run = recorded(tmp_path, TEXTS["takes_its_run_away"]).run
    assert (run.time, run.outcome, run.exit_code, run.flags) == ("virtual", "exited", 0, ())


def test_locks_that_a_submission_has_taken_are_free_when_its_run_is_over(tmp_path, monkeypatch):
    """Where nothing but its process group keeps it from them; a sandbox hides them."""
    home = tmp_path / "runs"
    home.mkdir()
    monkeypatch.setattr(scratch, "home", lambda: home)
    for number in network.DOMAINS:
        (home / f"domain-{number}.lock").touch()
    recording = recorded(tmp_path, TEXTS["keeps_all_locks"].format(home=str(home)), "real")
    assert recording.output == "b'kept'\n"
    for number in network.DOMAINS:
        lock = scratch.acquire_lock(f"domain-{number}")
        assert lock is not None
        lock.close()


@either_clock
def test_what_could_not_be_confined_is_not_judged(clock, tmp_path, monkeypatch):
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
