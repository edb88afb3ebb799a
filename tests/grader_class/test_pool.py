import sys
from pathlib import Path

import pytest

from grader.system import strict_json
from grader_class import pool
from grader_class.pool import Answer, Task

PATIENT_S = 60.0
ANSWERS = """
import json, os, sys
for line in sys.stdin:
    task = json.loads(line)
    {then}
    print(json.dumps({{"state": "done", "message": task["key"]}}), flush=True)
"""


def tasks(count):
    return [Task(str(n), (), "square", "virtual", None, None, Path("a.py")) for n in range(count)]


def workers_that(monkeypatch, then):
    monkeypatch.setattr(pool, "_COMMAND", ("-c", ANSWERS.format(then=then)))


def test_every_task_is_answered_by_some_worker(monkeypatch):
    workers_that(monkeypatch, "pass")
    done = {task.key: answer for task, answer in pool.work(tasks(7), 3, PATIENT_S)}
    assert {key: (a.state, str(a.message)) for key, a in done.items()} == {
        str(n): ("done", str(n)) for n in range(7)
    }


def test_a_worker_that_dies_loses_its_own_task_alone_and_that_is_told(monkeypatch):
    workers_that(monkeypatch, 'task["key"] == "1" and os.kill(os.getpid(), 9)')
    done = {task.key: answer for task, answer in pool.work(tasks(4), 2, PATIENT_S)}
    assert {key for key, answer in done.items() if answer.state == "done"} == {"0", "2", "3"}
    assert done["1"].state == "failed"
    assert str(done["1"].message) == "the process that graded it ended (SIGKILL), 2 times"


@pytest.mark.parametrize(
    "line",
    [
        *(b"[]", b"1", b'"x"', b"\xff", b"{"),
        b'{"state": "failed", "message": 1}',
        b'{"state": "failed", "message": {"key": "{a}"}}',
        b'{"state": "failed", "message": "x", "more": 1}',
    ],
)
def test_a_line_that_is_no_answer_is_refused(line):
    with pytest.raises(ValueError):
        strict_json.of_line(Answer, line)


def test_who_dies_once_is_asked_again(monkeypatch, tmp_path):
    mark = tmp_path / "died"
    then = f"os.path.exists({str(mark)!r}) or (open({str(mark)!r}, 'w').close(), os._exit(3))"
    workers_that(monkeypatch, then)
    assert [answer.state for _, answer in pool.work(tasks(2), 1, PATIENT_S)] == ["done", "done"]
    assert mark.exists()


@pytest.mark.parametrize("times", [1, 2])
def test_who_cannot_now_is_asked_again_as_a_new_process(monkeypatch, tmp_path, times):
    log = tmp_path / "asked"
    then = (
        f"open({str(log)!r}, 'a').write(f'{{os.getpid()}}\\n'); "
        f"len(open({str(log)!r}).readlines()) <= {times} and ("
        'print(json.dumps({"state": "again", "message": "full"}), flush=True), '
        "sys.stdin.read(), os._exit(0))"
    )
    workers_that(monkeypatch, then)
    ((_, answer),) = pool.work(tasks(1), 1, PATIENT_S)
    assert (answer.state, str(answer.message)) == (
        ("done", "0") if times == 1 else ("again", "full")
    )
    assert len(set(log.read_text().split())) == 2


def test_who_answers_nothing_sensible_has_failed_and_who_never_answers_is_ended(monkeypatch):
    workers_that(monkeypatch, 'print("hello", flush=True)')
    ((_, answer),) = pool.work(tasks(1), 1, PATIENT_S)
    assert answer.state == "failed"
    workers_that(monkeypatch, "__import__('time').sleep(600)")
    ((_, answer),) = pool.work(tasks(1), 1, patience_s=0.5)
    assert (answer.state, "SIGKILL" in str(answer.message)) == ("failed", sys.platform == "linux")


def test_what_makes_tasks_may_fail_and_that_is_raised(monkeypatch):
    workers_that(monkeypatch, "pass")

    def broken():
        yield from tasks(1)
        raise OSError("no space left")

    with pytest.raises(OSError, match="no space left"):
        list(pool.work(broken(), 2, PATIENT_S))


def test_no_worker_outlives_who_asks(monkeypatch):
    started = []
    start = pool.start
    monkeypatch.setattr(pool, "start", lambda: started.append(start()) or started[-1])
    workers_that(monkeypatch, 'task["key"] != "0" and __import__("time").sleep(600)')
    for _ in pool.work(tasks(3), 1, PATIENT_S):
        break
    assert all(process.poll() is not None for process in started)
