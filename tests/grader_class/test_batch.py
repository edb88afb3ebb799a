import shutil
import subprocess
from dataclasses import replace
from pathlib import Path

import psutil
import pytest

from grader.cli import main
from grader.run.processes import levels
from grader_class.class_file import ClassFile
from grader_class.entry import Entry, entries
from tests.files import lay
from tests.grader.test_other_systems import SYSTEMS, Elsewhere
from tests.grader_class.classes import CONTROLLER, ENV, batch, command, rows
from tests.grader_class.conftest import QUICK

NOT_RUN = "1 hand-in not run: the same content has been run already."


def made_together(out):
    """Gradebook and pages: all but what tells of one run."""
    return {
        str(path.relative_to(out)): path.read_bytes()
        for path in sorted(out.rglob("*"))
        if path.is_file() and path.relative_to(out).parts[0] not in ("submissions", "store")
    }


def scores(out):
    return {entry.id: (entry.state, entry.score) for entry in entries(out)}


def when(out, *ids):
    return [(out / "submissions" / id / "result.json").stat().st_mtime_ns for id in ids]


@pytest.fixture
def later(small_class, tmp_path):
    return Path(shutil.copytree(small_class.handed_in, tmp_path / "handed_in"))


@pytest.fixture
def call(small_class, out):
    """`grader batch` into the graded class; its submissions, or others'."""

    def called(*words, of=small_class.handed_in):
        return batch(*replace(small_class, handed_in=of).words(out), *words)

    return called


def test_everybody_gets_what_is_earned_and_one_bad_hand_in_touches_nobody(graded):
    found = scores(graded)
    assert found["right"] == found["twin"] == ("judged", 85.0)
    assert found["crashes"] == ("judged", 0.0)
    assert found["broken"] == found["nobody"] == ("unusable", 0.0)
    assert rows(graded / "gradebook.csv").keys() == found.keys()
    said = (graded.parent / "said.txt").read_text()
    assert NOT_RUN in said
    assert "[6/6]" in said


def test_a_student_s_folder_has_what_grader_run_writes(graded):
    folder = graded / "submissions" / "right"
    for name in ("result.json", "report.html", "canvas.png", "output.txt"):
        assert (folder / name).stat().st_size or name == "output.txt"
    assert (folder / "recording" / "metadata.yaml").exists()
    result = Entry.read(folder).result
    assert result.handed_in.id == "right"


def test_progress_names_people_as_they_know_themselves(tmp_path, in_process):
    handed_in = lay(tmp_path / "handed_in", {"王小明/notes.txt": "I could not do it."})
    _, said = batch(handed_in, "--out", tmp_path / "class", "--exercise", "square")
    assert "[1/1] 王小明: cannot be started" in said


def test_a_class_is_graded_by_the_exercise_that_its_hand_ins_name(tmp_path, in_process):
    handed_in = lay(tmp_path / "handed_in", {"carol/notes.txt": ""})
    assert main(["new", str(handed_in / "alice"), "--exercise", "square"]) == 0
    code, said = batch(handed_in, "--out", tmp_path / "class")
    assert (code, "Exercise: square (named in my_node.py)" in said) == (0, True), said
    assert ClassFile.read(tmp_path / "class").exercise == "square"
    code, said = batch("--regrade", tmp_path / "class")  # by the same
    assert code == 0, said


def test_a_class_that_names_several_is_not_graded(tmp_path):
    handed_in = tmp_path / "handed_in"
    for who, exercise in (("alice", "talker_listener"), ("bob", "square")):
        assert main(["new", str(handed_in / who), "--exercise", exercise]) == 0
    code, said = batch(handed_in, "--out", tmp_path / "class")
    assert code == 2
    assert "several exercises (talker_listener: alice; square: bob)" in said
    assert not (tmp_path / "class").exists()


@pytest.mark.parametrize("system", SYSTEMS)
def test_what_runs_submissions_says_that_it_needs_linux(system, tmp_path):
    done = Elsewhere(system, tmp_path).run("-m", "grader", "batch", "drives.py", cwd=tmp_path)
    assert done.returncode == 2
    assert done.stderr.startswith("grader batch: submissions are run on Linux with /proc")
    assert "Traceback" not in done.stderr


def test_a_second_call_runs_nothing_and_changes_nothing(call, out):
    before, at = made_together(out), when(out, "right")
    code, said = call()
    assert (code, "6 hand-ins of 6 graded before." in said) == (0, True), said
    assert (made_together(out), when(out, "right")) == (before, at)


def test_who_hands_in_once_more_is_graded_once_more_and_nobody_else(call, out, later, in_process):
    (later / "crashes.py").unlink()
    lay(later, {"crashes/square.py": CONTROLLER})
    at = when(out, "right")
    code, said = call(of=later)
    assert (code, "5 hand-ins of 6 graded before." in said, NOT_RUN in said) == (0, True, True)
    assert scores(out)["crashes"] == ("judged", 85.0)
    assert when(out, "right") == at


@pytest.mark.parametrize(
    ("exercise", "said"),
    [("square", "was graded by something else (the exercise"), (None, "grader batch --regrade")],
)
def test_another_exercise_does_not_come_into_the_same_folder(small_class, out, exercise, said):
    changed = out.parent / "own_square" / "changed.yaml"
    shutil.copytree(small_class.exercise.parent, changed.parent)
    changed.write_text(f"{QUICK}title: Other\n".replace("drives: 5", "drives: 6"))
    before = made_together(out)
    words = (small_class.handed_in, "--out", out, "--exercise", exercise or changed)
    code, messages = batch(*words)
    assert (code, said in messages) == (2, True), messages
    assert made_together(out) == before


def test_what_is_started_of_each_may_be_said_for_the_whole_class(small_class, tmp_path, in_process):
    files = {"alice/square.py": CONTROLLER, "alice/other.py": CONTROLLER}
    lay(tmp_path / "handed_in", files)
    words = replace(small_class, handed_in=tmp_path / "handed_in").words(tmp_path / "class")
    assert batch(*words, "--executable", "square")[0] == 0
    assert scores(tmp_path / "class")["alice"] == ("judged", 85.0)
    code, messages = batch(*words)
    assert code == 2
    assert "something else (what is started: there --executable square, here none)" in messages


def test_who_is_named_by_again_is_run_again(call, out, in_process):
    at = when(out, "right", "crashes")
    code, said = call("--again", "crashes")
    assert (code, "5 hand-ins of 6 graded before." in said) == (0, True), said
    now = when(out, "right", "crashes")
    assert (now[0], now[1] > at[1]) == (at[0], True)
    code, said = call("--again", "nobody at all")
    assert (code, "there is no hand-in of this name" in said) == (2, True)


def test_who_is_no_longer_among_the_submissions_is_set_aside_and_comes_back_without_a_run(
    call, out, tmp_path, in_process
):
    whole = scores(out)
    code, said = call(of=lay(tmp_path / "fewer", {"right/square.py": CONTROLLER}))
    assert (code, "5 hand-ins in" in said) == (0, True), said
    assert "broken, crashes, leaves, nobody, twin" in " ".join(said.split())
    assert scores(out).keys() == {"right"}
    assert (out / "aside" / "crashes" / "result.json").exists()
    code, said = call()
    assert (code, scores(out)) == (0, whole), said
    assert "not run: the same content has been run already." in said


def test_a_refused_call_leaves_the_class_as_it_is_and_none_behind(out, tmp_path):
    before = made_together(out)
    for words in ((out, "--out", out), (out, "--out", out.parent / "other")):
        code, said = batch(*words)
        assert (code, "is the folder of a class" in said) == (2, True), said
    assert batch(tmp_path / "nowhere", "--out", out.parent / "other")[0] == 2
    assert made_together(out) == before
    assert not (out.parent / "other").exists()


@pytest.mark.more("a call that was cut off leaves what the store and a second call find there")
def test_what_kill_9_interrupts_goes_on_and_comes_out_the_same(small_class, graded, tmp_path):
    words = small_class.words(tmp_path / "class")
    with subprocess.Popen(
        command(*words, "--jobs", "2"), stderr=subprocess.PIPE, text=True, env=ENV
    ) as process:
        next(line for line in process.stderr if "[3/6]" in line)
        family = [process, *psutil.Process(process.pid).children(recursive=True)]
        process.kill()
    gone, left = psutil.wait_procs(family[1:], timeout=60)
    assert (len(gone), left) == (len(family) - 1, [])
    code, said = batch(*words)
    assert (code, "graded before." in said) == (0, True), said
    assert made_together(tmp_path / "class") == made_together(graded)
    assert scores(tmp_path / "class") == scores(graded)


@pytest.mark.applies(levels.here().level == "namespaces", reason="there is no better")
def test_a_class_goes_on_at_the_level_at_which_it_was_begun_or_not_at_all(
    call, out, later, in_process, monkeypatch
):
    begun = ClassFile.read(out)
    assert begun.isolation == "namespaces"
    lay(later, {"nobody/node.py": "import rclpy\n1 / 0\n"})
    with monkeypatch.context() as less:
        less.setattr(levels, "_found", {})
        less.setattr(
            levels, "_find_level", lambda *_: levels.Level("", refused={"namespaces": "no"})
        )
        code, said = call(of=later)
        assert code == 2
        assert "at which this class is graded, is not to be had here: no. To get it:" in said
        assert "--again all" in said
        code, said = call()  # there is nothing to run
        assert code == 0, said
    replace(begun, isolation="limits").put(out)
    with monkeypatch.context() as asked:
        asked.setattr(levels, "_least", "")  # which is for all of a process
        code, said = call("--isolation", "landlock", of=later)
    assert code == 2
    assert "(the isolation: there limits, here landlock)" in said
    code, said = call(of=later)
    assert (code, scores(out)["nobody"][0]) == (0, "judged"), said
    result = Entry.read(out / "submissions" / "nobody").result
    assert result.run.isolation.startswith("limits")
