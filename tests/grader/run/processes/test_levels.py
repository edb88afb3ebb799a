"""Which level there is, what is told where it is too low, and that nothing runs below it."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from grader import cli
from grader.cli import run
from grader.errors import GraderFailure, UsageError
from grader.run import stage
from grader.run.processes import isolation, levels
from grader.run.processes.family import Student
from grader.run.processes.sandbox import view
from grader.run.processes.zygote import Warm, Zygote
from tests.grader.run.processes.test_zygote import COMMAND, ENV

WEAK = levels.Level("landlock", "same", {"namespaces": "mount: Operation not permitted"})


@pytest.fixture
def weak(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(levels, "_found", {True: WEAK, False: WEAK})
    monkeypatch.setattr(levels, "_least", "")


def test_the_command_line_knows_the_same_levels() -> None:
    assert run.LEVELS == levels.LEVELS


@pytest.mark.parametrize("level", levels.LEVELS)
def test_a_level_is_as_good_as_those_below(level: str) -> None:
    found = [each for each in levels.LEVELS if levels.Level(level).is_at_least(each)]
    assert found == list(levels.LEVELS[levels.LEVELS.index(level) :])
    assert not levels.Level("").is_at_least(level)


@pytest.mark.usefixtures("weak")
def test_less_than_is_required_is_refused_with_what_is_missing_and_how_to_get_it(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
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
def test_what_is_there_is_enough() -> None:
    levels.require("landlock")
    levels.require("limits")
    with pytest.raises(UsageError):
        levels.require("namespaces")


@pytest.mark.usefixtures("weak")
def test_no_run_is_made_below_what_was_required(monkeypatch: pytest.MonkeyPatch) -> None:
    levels.require("landlock")
    weaker = levels.Level("limits")
    monkeypatch.setattr(levels, "_found", {True: weaker, False: weaker})
    with (
        pytest.raises(GraderFailure, match="isolation by landlock was to be had before"),
        stage.open_stage(),
    ):
        pass


def test_where_nothing_can_be_confined_nothing_is_said_of_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(levels.system, "has_supervision", lambda: False)
    monkeypatch.setattr(levels, "_found", {})
    found = levels.best(isolation.Isolation("", {}))
    assert (found.level, found.name()) == ("", "")
    assert levels.prepare(found, *[Path("/")] * 3, is_apart=False) == levels.Place(None, {})


@pytest.fixture(params=["started", "forked"])
def warm(request: pytest.FixtureRequest) -> Iterator[Warm | None]:
    if request.param == "started":
        yield None
        return
    zygote = Zygote(COMMAND, ENV)
    yield Warm(zygote, {})
    zygote.close()


@pytest.mark.skipif(os.geteuid() != 0, reason="others have no mounts of their own here")
def test_what_cannot_be_confined_does_not_run_and_is_our_failure(warm: Warm | None) -> None:
    order = {
        "level": "namespaces",
        "uid": 61184,
        "user": "own",
        "is_apart": True,
        "steps": [["folder", "/proc"], ["bind", "/there/is/none"]],
        "folder": "/",
    }
    words = [sys.executable, "-c", "print('it runs')"]
    student = Student(words, ENV, Path("/"), warm=warm, confinement=order)
    with pytest.raises(GraderFailure, match="could not be started: mount: No such file"):
        student.wait(20.0)
    student.end()
    assert student.output() == ""


def test_nothing_of_ours_is_shown_but_what_works_there(tmp_path: Path) -> None:
    steps = view.steps(tmp_path, 61184)
    shown = {path for kind, path, *_ in steps if kind in ("bind", "copy")}
    assert [path for kind, path, *_ in steps if kind == "copy"] == [str(tmp_path)]
    ours = str(view.ROOT)
    found = {path.removeprefix(f"{ours}/") for path in shown if path.startswith(f"{ours}/grader")}
    assert found == set(view.HOST)
    assert not {"/", ours, str(Path.home()), str(tmp_path.parent)} & shown
