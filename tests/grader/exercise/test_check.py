"""How checks become verdicts."""

import os
import re
import signal
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import pytest

from grader.errors import CheckFailed
from grader.exercise import asking, check
from grader.exercise.check import Checks, judge
from grader.exercise.loading import load_exercise
from grader.exercise.verdict import Evidence, Finding
from grader.recording.recording import NominalAlone, NotOver, Recordings
from grader.system import versions as system
from grader.system.limited import WorkLimits
from tests.grader.driving import Spiral, drive


def verdicts(checks, points):
    recording = drive(lambda *_: None, ticks=2)
    return {v.check: v for v in judge(Recordings(recording), checks, points, {"limit": 3})}


def an_exercise(share):
    checks = Checks()

    @checks()
    def first(recordings, tolerances):
        """The first thing.

        More about it.
        """
        return Finding(share, "seen", "look", ())

    @checks(after=("first",))
    def second(recordings, tolerances):
        """The second thing."""
        return Finding(1, f"the limit is {tolerances['limit']}")

    return checks


def test_a_whole_share_passes_and_the_docstrings_first_line_is_the_title():
    found = verdicts(an_exercise(1), {"first": 4, "second": 6})
    first = found["first"]
    assert (first.status, first.score, str(first.title)) == ("passed", 4, "The first thing")
    assert str(found["second"].rationale) == "the limit is 3"
    # one without points is not run
    assert list(verdicts(an_exercise(1), {"second": 6})) == ["second"]


def test_a_part_of_the_share_fails_and_what_depends_on_it_is_not_judged():
    found = verdicts(an_exercise(0.25), {"first": 4, "second": 6})
    first, second = found["first"], found["second"]
    assert (first.status, first.score, str(first.help)) == ("failed", 1, "look")
    assert (second.status, second.score, second.max_score) == ("not_judged", 0, 6)
    assert (second.waited_for(found), first.waited_for(found)) == (("first",), ())
    assert "“The first thing” did not pass" in str(second.rationale)
    with pytest.raises(KeyError, match="no check is named 'third'"):
        verdicts(an_exercise(1), {"third": 1})


def checks_of(*functions):
    checks = Checks()
    for function in functions:
        checks()(function)
    return checks


def passing(name):
    def passes(recordings, tolerances):
        return Finding(1, "seen")

    passes.__name__ = name
    return passes


def raising(error):
    def raises(recordings, tolerances):
        raise error

    return checks_of(raises)


def returning(result):
    def returns(recordings, tolerances):
        return result

    return checks_of(returns)


@pytest.mark.parametrize("raised", [ZeroDivisionError("no"), SystemExit(0), GeneratorExit()])
def test_what_a_check_raises_is_the_exercise_s_with_file_and_line_and_ends_nobody(raised):
    with pytest.raises(CheckFailed) as error:
        verdicts(raising(raised), {"raises": 1})
    assert (error.value.whose, error.value.exit_code) == ("exercise", 3)
    said = str(error.value.message)
    assert re.search(r"'raises' failed itself.*test_check\.py, line \d+: ", said)
    assert f"{type(raised).__name__}" in said


HERE = Evidence(0.016, "here", 5.5, 5.5, tick=1)


@pytest.mark.parametrize(
    ("result", "words"),
    [
        (None, "returns a NoneType; expected a Finding"),
        (True, "returns a bool"),
        (Finding("1", "seen"), "share: expected a number, found '1'"),
        (Finding(True, "seen"), "share: expected"),
        (Finding(2, "seen"), "share: expected"),
        (Finding(-0.1, "seen"), "share: expected a number from 0 to 1, found -0.1"),
        (Finding(float("nan"), "seen"), "Out of range float values"),
        (Finding(1, None), "rationale: expected a message"),
        (Finding(0, "seen", 3), "help: expected a message"),
        (Finding(1, "seen", evidence=HERE), "evidence: expected a list"),
        (Finding(1, "seen", evidence=("x",)), "evidence: expected an object of time_s, note"),
        (Finding(1, "s", evidence=(replace(HERE, tick=1.5),)), "evidence: tick: expected"),
        (Finding(1, "s", evidence=(replace(HERE, time_s="1"),)), "evidence: time_s: expected"),
        (Finding(1, "s", evidence=(replace(HERE, x=float("nan")),)), "Out of range float"),
        (Finding(1, "s", evidence=(replace(HERE, note=None),)), "evidence: note: expected"),
        (Finding(1, "s", evidence=(replace(HERE, run=1),)), "evidence: there is no run 1"),
    ],
)
def test_what_is_no_finding_is_told_with_its_check_and_file(result, words):
    with pytest.raises(CheckFailed) as error:
        verdicts(returning(result), {"returns": 1})
    assert "'returns'" in str(error.value.message)
    assert f"test_check.py: {words}" in str(error.value.message)


def test_a_check_that_is_written_wrongly_is_refused():
    checks = an_exercise(1)
    with pytest.raises(TypeError, match=r"expected \(recordings, tolerances\), found \(rec"):
        checks()(lambda recordings: None)
    with pytest.raises(ValueError, match="two checks are named 'first'"):
        checks(after=())(next(iter(checks)).function)
    with pytest.raises(TypeError, match="after: expected a tuple of names, found 'first'"):
        checks(after="first")
    with pytest.raises(ValueError, match="no check above is named frist"):
        checks(after=("frist",))
    with pytest.raises(TypeError, match=r"write @checks\(\)"):
        checks(an_exercise)


def test_a_check_neither_prints_to_standard_output_nor_leaves_the_folder(tmp_path, capfd):
    def wanders(recordings, tolerances):
        print("so far")
        os.chdir(tmp_path)
        return Finding(1, "seen")

    before = Path.cwd()
    verdicts(checks_of(wanders), {"wanders": 1})
    assert Path.cwd() == before
    assert capfd.readouterr() == ("", "so far\n")


def endless(recordings=None, tolerances=None):
    while True:
        try:
            while True:
                pass
        except BaseException:
            continue


def calls_itself():
    return calls_itself()


#: ... and whether Python itself has noticed, and goes on.
HITS = {
    "did not come to an end in": (endless, False),
    "ended the process that it ran in (exit code 0)": (lambda: os._exit(0), False),
    "ended the process that it ran in (signal 11)": (lambda: os.kill(os.getpid(), 11), False),
    "needed more memory than it may have": (lambda: bytearray(2**50), True),
    "called itself too deeply": (calls_itself, True),
}


@pytest.mark.parametrize("said", HITS)
def test_a_check_that_hits_a_limit_is_not_judged_and_those_before_it_count(said, monkeypatch):
    monkeypatch.setattr(asking, "LIMITS", WorkLimits(cpu_s=0.2, wall_s=30.0))
    run, goes_on = HITS[said]

    def hits(recordings, tolerances):
        return run()

    checks = checks_of(passing("before"), hits, passing("other"))
    checks(after=("hits",))(passing("depends"))
    found = verdicts(checks, {"before": 1, "hits": 5, "other": 3, "depends": 2})
    broken = found["hits"]
    assert (broken.status, broken.score, broken.max_score) == ("not_judged", 0, 5)
    assert f"the check 'hits' {said}" in str(broken.rationale)
    assert "a fault of the exercise, not of the submission" in str(broken.rationale)
    assert found["before"].status == "passed"
    assert found["depends"].status == "not_judged"
    assert found["other"].status == ("passed" if goes_on else "not_judged")
    assert goes_on or f"the check 'hits' {said}" in str(found["other"].rationale)


def test_a_finding_comes_back_as_it_was_made():
    evidence = Evidence(0.1 + 0.2, "half \udc80 of \U0001f422, and\nmore", 1e-300, 5, tick=7)
    checks = returning(Finding(1 / 3, "wo \x00", "why", (evidence,)))
    found = verdicts(checks, {"returns": 3})["returns"]
    assert (str(found.rationale), str(found.help)) == ("wo \x00", "why")
    assert found.evidence == (evidence,)


def test_checks_are_limited_in_every_thread(monkeypatch):
    monkeypatch.setattr(asking, "LIMITS", WorkLimits(cpu_s=0.2, wall_s=30.0))
    checks = checks_of(endless)
    with ThreadPoolExecutor(2) as pool:
        tasks = [pool.submit(verdicts, checks, {"endless": 1}) for _ in range(2)]
        assert {task.result()["endless"].status for task in tasks} == {"not_judged"}


def test_a_key_on_the_keyboard_is_not_the_check_s_where_there_is_no_copy(monkeypatch):
    monkeypatch.setattr(system, "runs_submissions", lambda: False)
    before = signal.signal(signal.SIGINT, signal.default_int_handler)

    def interrupted(recordings, tolerances):
        signal.raise_signal(signal.SIGINT)

    try:
        with pytest.raises(KeyboardInterrupt):
            verdicts(checks_of(interrupted), {"interrupted": 1})
    finally:
        signal.signal(signal.SIGINT, before)


@pytest.fixture(scope="module")
def nominal():
    return drive(Spiral(), ticks=1500)


def early_names(nominal, checks):
    points = dict.fromkeys((check.name for check in checks), 1.0)
    return [verdict.check for verdict in check.judge_nominal(nominal, checks, points, {})]


def test_a_check_that_looks_at_a_varied_run_waits_and_so_does_what_depends_on_it(nominal):
    def alone(recordings, tolerances):
        return Finding(float(recordings.nominal is nominal), "")

    def counts(recordings, tolerances):
        try:
            return Finding(1.0, f"{len(recordings.varied)}")
        except Exception:  # an author's: it must not take the place of an answer
            return Finding(0.0, "")

    def all_of_them(recordings, tolerances):
        return Finding(float(all(r.run.ticks >= 0 for r in recordings)), "")

    checks = checks_of(alone, counts, all_of_them)
    checks(after=("counts",))(passing("later"))
    checks(after=("alone",))(passing("sooner"))
    assert early_names(nominal, checks) == ["alone", "sooner"]
    one = NominalAlone(nominal)
    assert next(iter(one)) is nominal
    with pytest.raises(NotOver):
        list(one)


def test_one_that_fails_itself_is_left_to_the_judge_of_all(nominal):
    assert early_names(nominal, raising(ZeroDivisionError())) == []


def test_what_is_said_early_is_what_is_said_in_the_end(nominal):
    exercise = load_exercise("turtlesim_challenge")
    asked = (exercise.checks, exercise.points, exercise.tolerances)
    first = check.judge_nominal(nominal, *asked)
    whole = check.judge(Recordings(nominal, (nominal, nominal)), *asked)
    assert 1 < len(first) < len(whole)
    assert [verdict for verdict in whole if verdict in first] == first
