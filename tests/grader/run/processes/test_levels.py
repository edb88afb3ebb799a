"""Which level there is, what is told where it is too low, and that nothing runs below it."""

import json
import os
import resource
import site
import sys
from pathlib import Path

import pytest
import yaml

from grader import cli
from grader.cli import options
from grader.errors import GraderFailure, NotNow, UsageError
from grader.run import run_context
from grader.run.processes import levels, network, refusal
from grader.run.processes.fork_server_main import ProcessCommand
from grader.run.processes.started_process import SubmissionProcess
from grader.run.sandbox import view
from grader.system import scratch
from tests.children import in_child
from tests.grader.run.processes.conftest import ENV
from tests.programs import ran
from tests.tiers import others_are_more

TEXTS = yaml.safe_load(Path(__file__).with_suffix(".yaml").read_text())

TESTS = Path(__file__).parents[3]
WEAK = levels.Level("landlock", "same", {"namespaces": "mount: Operation not permitted"})


def there_is(level: levels.Level, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(levels, "_found", {})
    monkeypatch.setattr(levels, "_find_level", lambda isolated, wanted: level)


@pytest.fixture
def weak(monkeypatch):
    there_is(WEAK, monkeypatch)
    monkeypatch.setattr(levels, "_least", "")


def test_the_command_line_knows_the_same_levels():
    assert options.LEVELS == levels.LEVELS


def test_a_level_is_as_good_as_those_below():
    for place, level in enumerate(levels.LEVELS):
        found = [each for each in levels.LEVELS if levels.Level(level).is_at_least(each)]
        assert found == list(levels.LEVELS[place:])
        assert not levels.Level("").is_at_least(level)


@pytest.mark.usefixtures("weak")
def test_less_than_is_required_is_refused_with_what_is_missing_and_how_to_get_it(tmp_path, capsys):
    (tmp_path / "node.py").write_text("open('ran', 'w')\n")
    code = cli.main(["run", str(tmp_path / "node.py"), "--isolation", "namespaces"])
    assert code == 2
    said = " ".join(capsys.readouterr().err.split())
    assert "isolation by namespaces is not to be had: mount: Operation not permitted" in said
    assert "the best here is 'landlock (ABI" in said
    assert "kernel.apparmor_restrict_unprivileged_userns" in said
    assert "--cap-add SYS_ADMIN" in said
    assert not (tmp_path / "ran").exists()


@pytest.mark.usefixtures("weak")
def test_what_is_there_is_enough_and_no_run_is_made_below_what_was_required(monkeypatch):
    with pytest.raises(UsageError):
        levels.require("namespaces")
    levels.require("limits")
    levels.require("landlock")
    there_is(levels.Level("limits"), monkeypatch)
    with (
        pytest.raises(GraderFailure, match="isolation by landlock was to be had before"),
        run_context.open_context(),
    ):
        pass


def _without_descriptors(free: int) -> list[str]:
    """What is told where so few are free, and the level when there are enough again."""
    levels._found.clear()
    network._refused.clear()
    refusal.PAUSES_S = (0.0, 0.0)
    with scratch.make_folder() as folder, network.obtain_isolation(folder) as isolated:
        before = resource.getrlimit(resource.RLIMIT_NOFILE)
        next_one = os.dup(0)
        os.close(next_one)
        resource.setrlimit(resource.RLIMIT_NOFILE, (next_one + free, before[1]))
        try:
            told = [levels.best(isolated).level]
        except NotNow as error:
            told = [str(error)]
        finally:
            resource.setrlimit(resource.RLIMIT_NOFILE, before)
        return [*told, levels.best(isolated).level]


@pytest.mark.parametrize("free", [0, 3])
def test_a_lack_of_descriptors_lowers_no_level_and_is_not_remembered(free):
    there = levels.here().level
    told, later = in_child(_without_descriptors, free)
    assert told.startswith(
        f"whether isolation by {there} is to be had could not be told in 3 tries"
    )
    assert told.endswith(": Too many open files")
    assert later == there


def test_a_slow_trial_lowers_no_level_and_is_not_remembered(monkeypatch):
    there = levels.here().level
    monkeypatch.setattr(levels, "_found", {})
    monkeypatch.setattr(refusal, "PAUSES_S", (0.0, 0.0))
    with monkeypatch.context() as impatient:
        impatient.setattr(levels, "PATIENCE_S", 0.0)
        impatient.setattr(levels, "TRIAL", "import signal; signal.pause()")  # never done in time
        with pytest.raises(NotNow, match="in 3 tries: a trial took 0 s"):
            levels.here()
    assert levels.here().level == there


REFUSED = [
    ("mount", "landlock", "mount: Operation not permitted"),
    ("unshare", "landlock", "namespaces of users and networks are refused"),
    (
        *("mount at present", "NotNow"),
        "whether isolation by namespaces is to be had could not be told in 3 tries: "
        "mount: Cannot allocate memory",
    ),
]


@pytest.mark.applies(levels.here().level == "namespaces", reason="namespaces can be refused")
@pytest.mark.parametrize(
    ("refused", "level", "why"), others_are_more("test_refusal tells them apart", REFUSED, "mount")
)
def test_what_is_refused_for_good_lowers_the_level_and_nothing_else_does(refused, level, why):
    words = [sys.executable, TESTS / "refusing.py", refused, sys.executable, "-c", TEXTS["tells"]]
    env = {**os.environ, "PYTHONPATH": str(TESTS.parent)}
    done = ran([*words, "", "limits", "namespaces"], env=env)
    best, lower, same = json.loads(done.stdout)
    assert best == [level, why], done.stderr
    assert lower == ["limits", ""]
    at = "isolation by namespaces, at which this class is graded, is not to be had here: "
    assert same == (best if level == "NotNow" else ["NotOffered", f"{at}{why}"])


@pytest.mark.applies(os.geteuid() == 0, reason="others have no mounts of their own here")
def test_what_cannot_be_confined_does_not_run_and_is_our_failure(warm):
    order = {
        **{"level": "namespaces", "uid": 61184, "user": "separate", "rlimits": []},
        **{"is_apart": True, "steps": [["folder", "/proc"], ["bind", "/there/is/none"]]},
    }
    words = [sys.executable, "-c", "print('it runs')"]
    command = ProcessCommand(words, ENV, Path("/"), confinement=order)
    student = SubmissionProcess(command, warm)
    with pytest.raises(GraderFailure, match="could not be started: mount: No such file"):
        student.wait(20.0)
    student.end()
    assert student.output() == ""


def test_nothing_of_ours_is_shown_but_what_works_there(tmp_path):
    steps = view.steps(tmp_path, 61184)
    shown = {path for kind, path, *_ in steps if kind in ("bind", "copy")}
    assert [path for kind, path, *_ in steps if kind == "copy"] == [str(tmp_path)]
    ours = str(view.ROOT)
    found = {
        path.removeprefix(f"{ours}/")
        for path in shown
        if path.startswith((f"{ours}/grader", f"{ours}/ros_doubles"))
    }
    assert found == {e for e in view.HOST if (view.ROOT / e.partition("/")[0]).is_dir()}
    assert not {"/", ours, str(Path.home()), str(tmp_path.parent)} & shown


def test_who_has_no_packages_of_his_own_is_confined_as_all_are(monkeypatch, tmp_path):
    monkeypatch.setattr(site, "ENABLE_USER_SITE", True)
    monkeypatch.setattr(site, "getusersitepackages", lambda: str(tmp_path / "missing"))
    assert str(tmp_path / "missing") not in view.import_path()
