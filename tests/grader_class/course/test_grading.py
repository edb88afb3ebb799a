"""grade.sh and install.sh: whose turn it is, and what a submission can reach.

Most tests use a stub in place of `grader run`.
"""

import json
import subprocess

import pytest

from tests.grader_class.course.machine import RESULT, SOURCE, UID, an_error, program, scripts
from tests.needs import needs


@pytest.mark.parametrize("code", [0, 1])
def test_a_judgement_leaves_its_results(machine, code):
    assert machine.grade(f"exit {code}", "--fail-under", "60") == code
    assert json.loads((machine.work / "graded" / "result.json").read_text()) == RESULT
    assert not (machine.work / "error.json").exists()


def test_an_unusable_submission_is_told_what_to_mend(machine):
    assert machine.grade(an_error("submission", "no .py in it.\nHand in one.")) == 2
    assert machine.error == ("submission", "no .py in it.\nHand in one.")
    assert not (machine.work / "graded").exists()


def test_a_submission_that_is_not_there_is_unusable(machine):
    grade = machine.bash(scripts() / "grade.sh", "package", machine.work, GRADER_USER="")
    assert grade.returncode == 2
    whose, message = machine.error
    assert whose == "submission"
    assert message.startswith("package does not exist.")
    assert message in grade.stderr


@pytest.mark.parametrize(
    "does",
    ["exit 3", "kill -KILL $PPID", "echo 'no .py in it.' >&2; exit 2", an_error("call", "Broke.")],
)
def test_the_graders_failures_are_never_the_students(machine, does):
    """And no old result outlives them."""
    (machine.work / "graded").mkdir(parents=True)
    (machine.work / "graded" / "result.json").write_text("{}")
    assert machine.grade(does) == 3
    whose, message = machine.error
    assert whose != "submission"
    assert message
    assert not (machine.work / "graded").exists()


@pytest.mark.parametrize(
    "does",
    [
        "rm $out/result.json; mkfifo $out/result.json $out/canvas.png",
        "rm -r $out",
        "rm -r $out; echo forged >$out",
        "sed -i 's/17.5/100/' $out/result.json; echo forged >&3; echo forged >/dev/fd/3; "
        f"{an_error('submission', 'Forged.').partition(';')[0]}",
    ],
)
def test_what_a_submission_does_to_the_results_changes_no_judgement(machine, does):
    assert machine.grade(f"({does}) 2>/dev/null; exit 0") == 0
    assert json.loads((machine.work / "graded" / "result.json").read_text()) == RESULT
    assert not [path for path in machine.work.rglob("*") if path.is_fifo()]


@needs("root")
def test_a_submission_cannot_open_what_its_grader_writes_into(machine):
    does = "for file in /proc/*/fd/[34]; do (echo forged >>$file); done 2>/dev/null; exit 0"
    assert machine.grade(does) == 0
    assert json.loads((machine.work / "graded" / "result.json").read_text()) == RESULT


def test_a_failure_of_the_grader_is_tried_again(machine):
    assert machine.grade('[ "$(wc -l <"$tries")" = 2 ] || exit 3') == 0
    assert (machine.work / "graded" / "result.json").exists()


@pytest.mark.more("waits for seconds; a grader that is killed is told the same way")
def test_what_never_ends_is_ended(machine):
    assert machine.grade("sleep 1000", GRADER_LIMIT_S="1") == 3
    assert machine.error == ("grader", "killed, or not ready after 1 s")


def test_without_an_exercise_nothing_is_graded(machine):
    assert machine.grade("exit 0", EXERCISE="") == 3
    assert machine.error == ("grader", "EXERCISE is not set")


def test_a_submission_sees_nothing_of_the_callers_environment_and_gains_no_privileges(machine):
    does = "env >$out/env; pwd >$out/pwd; grep NoNewPrivs /proc/self/status >$out/status"
    assert machine.grade(f"{does}; ls -A . >/dev/null") == 0
    seen, pwd, status = (
        (machine.work / "graded" / name).read_text() for name in ("env", "pwd", "status")
    )
    assert "do-not-tell" not in seen
    assert str(machine.folder) not in seen
    assert pwd == "/\n"
    assert status.split() == ["NoNewPrivs:", "1"]


def test_git_data_is_no_part_of_the_copy(machine):
    (machine.folder / "student" / ".git").mkdir(parents=True)
    (machine.folder / "student" / "does.sh").write_text('[ ! -e "${0%/*}/.git" ]')
    words = (scripts() / "grade.sh", machine.folder / "student", machine.work)
    assert machine.bash(*words).returncode == 0


@needs("root")
@pytest.mark.parametrize("place", ["venv/bin/grader", "work/graded/x", "results.json", "student/x"])
def test_a_submission_writes_nowhere_else(machine, place):
    target = machine.folder / place
    assert machine.grade(f"! echo forged 2>/dev/null >{target}") == 0
    assert not target.exists() or "forged" not in target.read_text()


@needs("root")
def test_links_in_the_results_show_nothing_that_the_submission_could_not_read(machine):
    secret = machine.folder / "secret"
    secret.write_text("do-not-tell")
    secret.chmod(0o600)
    machine.grade(f"ln -s {secret} $out/secret.txt")
    assert "do-not-tell" not in "".join(
        file.read_text(errors="replace") for file in machine.work.rglob("*") if file.is_file()
    )


@needs("pgrep", "root")
def test_nothing_of_a_submission_is_left_running(machine):
    assert machine.grade("setsid env -i sleep 1000 </dev/null >/dev/null 2>&1 &") == 0
    running = ["pgrep", "--runstates", "RSD", "-U", str(UID)]  # not what is dead, but not buried
    assert subprocess.run(running).returncode == 1


def test_what_is_installed_is_not_installed_again(machine):
    install = machine.bash(scripts() / "install.sh", GRADER_SOURCE=SOURCE)
    assert (install.returncode, install.stderr) == (0, "")
    assert "already" in install.stdout


def test_a_folder_with_something_else_in_it_is_left_alone(machine):
    program(machine.folder / "bin" / "python3.12", "exit 0")  # fits
    install = machine.bash(scripts() / "install.sh", GRADER_SOURCE="/another/release")
    assert install.returncode == 1
    assert "holds something else" in install.stderr
    assert (machine.venv / "bin" / "grader").exists()


@pytest.mark.parametrize(
    ("source", "wanted"),
    [
        ("turtlesim_py[jazzy]==1.2.3", []),
        ("/a/release[kilted]", ["/a/release/interfaces/kilted"]),
        (
            "turtlesim_py[jazzy] @ git+https://x/y.git@v1",
            ["git+https://x/y.git@v1#subdirectory=interfaces/jazzy"],
        ),
    ],
)
def test_what_is_needed_of_ros_comes_from_where_the_grader_does(machine, source, wanted):
    asked = machine.folder / "asked"
    made = rf'mkdir "$3/bin"; printf "#!/bin/sh\nprintf %%s\\\\\\\\n \"\$@\" >{asked}; exit 1" '
    made += '>"$3/bin/python"; chmod +x "$3/bin/python"'
    program(machine.folder / "bin" / "python3.12", f'[ "$2" != venv ] || {{ {made}; }}')
    venv = str(machine.folder / "new")
    install = machine.bash(scripts() / "install.sh", GRADER_SOURCE=source, GRADER_VENV=venv)
    assert install.returncode == 1  # this Python installs nothing
    assert asked.read_text().partition("--no-input\n")[2].splitlines() == [*wanted, source]
