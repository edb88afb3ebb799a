"""How checks become verdicts."""

from __future__ import annotations

import os
import signal
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import pytest

from grader import system
from grader.errors import CheckFailed
from grader.exercise import asking, check
from grader.exercise.check import Checks, judge
from grader.exercise.loading import load_exercise
from grader.exercise.verdict import Evidence, Finding
from grader.limited import WorkLimits
from grader.recording.recording import NominalAlone, NotOver, Recordings
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
    first = verdicts(an_exercise(1), {"first": 4})["first"]
    assert (first.status, first.score, str(first.title)) == ("passed", 4, "The first thing")


def test_a_part_of_the_share_fails_with_that_part_of_the_points_and_help():
    first = verdicts(an_exercise(0.25), {"first": 4})["first"]
    assert (first.status, first.score, str(first.help)) == ("failed", 1, "look")


def test_what_depends_on_a_failed_check_is_not_judged_and_says_for_which_it_waited():
    found = verdicts(an_exercise(0.5), {"first": 4, "second": 6})
    second = found["second"]
    assert (second.status, second.score, second.max_score) == ("not_judged", 0, 6)
    assert (second.waited_for(found), found["first"].waited_for(found)) == (("first",), ())
    assert "“The first thing” did not pass" in str(second.rationale)


def test_a_check_reads_the_exercises_tolerances():
    second = verdicts(an_exercise(1), {"first": 1, "second": 6})["second"]
    assert str(second.rationale) == "the limit is 3"


def test_a_check_without_points_is_not_run():
    assert list(verdicts(an_exercise(1), {"second": 6})) == ["second"]


def test_points_for_an_unknown_check_are_an_error():
    with pytest.raises(KeyError, match="no check is named 'third'"):
        verdicts(an_exercise(1), {"third": 1})


def test_a_dependency_that_is_not_defined_above_is_an_error():
    with pytest.raises(ValueError, match="no check above is named frist"):
        Checks()(after=("frist",))


def test_an_exception_in_a_check_is_the_exercise_s_with_its_file_and_line():
    checks = Checks()

    @checks()
    def divides(recordings, tolerances):
        """It divides."""
        return Finding(1 / 0, "never")

    with pytest.raises(CheckFailed) as error:
        verdicts(checks, {"divides": 1})
    assert (error.value.whose, error.value.exit_code) == ("exercise", 3)
    assert "'divides' failed itself" in str(error.value.message)
    assert "test_check.py, line" in str(error.value.message)
    assert str(error.value.message).endswith("ZeroDivisionError: division by zero")


@pytest.mark.parametrize("error", [SystemExit(0), GeneratorExit()])
def test_a_check_cannot_end_the_grader(error):
    checks = Checks()

    @checks()
    def ends(recordings, tolerances):
        """It ends."""
        raise error

    with pytest.raises(CheckFailed, match=r"'ends' failed itself.*test_check\.py, line \d+: "):
        verdicts(checks, {"ends": 1})


def returning(result):
    checks = Checks()

    @checks()
    def returns(recordings, tolerances):
        """It returns."""
        return result

    return checks


HERE = Evidence(0.016, "here", 5.5, 5.5, tick=1)


@pytest.mark.parametrize(
    ("result", "words"),
    [
        (None, "returns a NoneType; expected a Finding"),
        (True, "returns a bool"),
        (Finding("1", "seen"), "share: expected a number from 0 to 1, found '1'"),
        (Finding(True, "seen"), "share: expected"),
        (Finding(2, "seen"), "share: expected"),
        (Finding(-0.1, "seen"), "share: expected"),
        (Finding(float("nan"), "seen"), "share: expected"),
        (Finding(1, None), "rationale: expected a text, found None"),
        (Finding(0, "seen", 3), "help: expected a text, found 3"),
        (Finding(1, "seen", evidence=[HERE]), "evidence: expected a tuple, found a list"),
        (Finding(1, "seen", evidence=("x",)), "evidence: expected Evidence, found a str"),
        (Finding(1, "s", evidence=(replace(HERE, tick=1.5),)), "evidence: tick: expected"),
        (Finding(1, "s", evidence=(replace(HERE, time_s="1"),)), "evidence: time_s: expected"),
        (Finding(1, "s", evidence=(replace(HERE, x=float("nan")),)), "evidence: x: expected a fin"),
        (Finding(1, "s", evidence=(replace(HERE, note=None),)), "evidence: note: expected"),
        (Finding(1, "s", evidence=(replace(HERE, run=1),)), "evidence: there is no run 1"),
    ],
)
def test_what_is_no_finding_is_told_with_its_check_and_file(result, words):
    with pytest.raises(CheckFailed) as error:
        verdicts(returning(result), {"returns": 1})
    assert "'returns'" in str(error.value.message)
    assert f"test_check.py: {words}" in str(error.value.message)


def test_a_check_must_take_recordings_and_tolerances():
    with pytest.raises(TypeError, match=r"one: expected \(recordings, tolerances\), found \(rec"):

        @Checks()()
        def one(recordings):
            """It takes too little."""


def test_a_name_is_that_of_one_check_only():
    checks = an_exercise(1)
    with pytest.raises(ValueError, match="two checks are named 'first'"):

        @checks()
        def first(recordings, tolerances):
            """Another first one."""


def test_after_is_a_tuple_and_the_decorator_has_brackets():
    with pytest.raises(TypeError, match="after: expected a tuple of names, found 'first'"):
        an_exercise(1)(after="first")
    with pytest.raises(TypeError, match=r"write @checks\(\)"):
        Checks()(an_exercise)


def test_a_check_neither_prints_to_standard_output_nor_leaves_the_folder(tmp_path, capfd):
    checks = Checks()

    @checks()
    def wanders(recordings, tolerances):
        """It wanders."""
        print("so far")
        os.chdir(tmp_path)
        return Finding(1, "seen")

    before = Path.cwd()
    verdicts(checks, {"wanders": 1})
    assert Path.cwd() == before
    assert capfd.readouterr() == ("", "so far\n")


def endless(recordings, tolerances):
    """It never ends."""
    while True:
        try:
            while True:
                pass
        except BaseException:
            continue


def ends_the_process(recordings, tolerances):
    """It leaves."""
    os._exit(0)


def takes_all_memory(recordings, tolerances):
    """It takes what there is."""
    return Finding(len(bytearray(2**50)), "never")


def calls_itself(recordings, tolerances):
    """It calls itself."""
    return calls_itself(recordings, tolerances)


def kills_itself(recordings, tolerances):
    """It crashes in C."""
    os.kill(os.getpid(), signal.SIGSEGV)


ENDING = {
    endless: "did not come to an end in",
    ends_the_process: "ended the process that it ran in (exit code 0)",
    kills_itself: "ended the process that it ran in (signal 11)",
}
LASTING = {
    takes_all_memory: "needed more memory than it may have",
    calls_itself: "called itself too deeply",
}


@pytest.mark.parametrize(("function", "said"), [*ENDING.items(), *LASTING.items()])
def test_a_check_that_hits_a_limit_is_not_judged_and_those_before_it_count(
    function, said, monkeypatch
):
    monkeypatch.setattr(asking, "LIMITS", WorkLimits(cpu_s=0.3, wall_s=30.0))
    checks = Checks()

    @checks()
    def before(recordings, tolerances):
        """It comes before that."""
        return Finding(1, "seen")

    checks()(function)

    @checks(after=(function.__name__,))
    def depends(recordings, tolerances):
        """It depends on that."""
        return Finding(1, "seen")

    @checks()
    def other(recordings, tolerances):
        """It has nothing to do with that."""
        return Finding(1, "seen")

    found = verdicts(checks, {"before": 1, function.__name__: 5, "depends": 2, "other": 3})
    broken = found[function.__name__]
    assert (broken.status, broken.score, broken.max_score) == ("not_judged", 0, 5)
    assert f"the check {function.__name__!r} {said}" in str(broken.rationale)
    assert "a fault of the exercise, not of the submission" in str(broken.rationale)
    assert found["before"].status == "passed"
    assert "because “It depends" not in str(found["depends"].rationale)
    assert found["depends"].status == "not_judged"
    if function in LASTING:  # Python itself has noticed, and goes on
        assert found["other"].status == "passed"
    else:
        assert found["other"].status == "not_judged"
        assert f"the check {function.__name__!r} {said}" in str(found["other"].rationale)


def test_a_finding_comes_back_as_it_was_made():
    evidence = Evidence(0.1 + 0.2, "half \udc80 of \U0001f422, and\nmore", 1e-300, 5, tick=7)
    checks = returning(Finding(1 / 3, "wo \x00", "why", (evidence,)))
    found = verdicts(checks, {"returns": 3})["returns"]
    assert (str(found.rationale), str(found.help)) == ("wo \x00", "why")
    assert found.evidence == (evidence,)


def test_checks_are_limited_in_every_thread(monkeypatch):
    monkeypatch.setattr(asking, "LIMITS", WorkLimits(cpu_s=0.3, wall_s=30.0))
    checks = Checks()
    checks()(endless)
    with ThreadPoolExecutor(3) as pool:
        tasks = [pool.submit(verdicts, checks, {"endless": 1}) for _ in range(3)]
        assert {task.result()["endless"].status for task in tasks} == {"not_judged"}


def test_a_key_on_the_keyboard_is_not_the_check_s_where_there_is_no_copy(monkeypatch):
    monkeypatch.setattr(system, "runs_submissions", lambda: False)
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    checks = Checks()

    @checks()
    def interrupted(recordings, tolerances):
        """A key is pressed while it runs."""
        signal.raise_signal(signal.SIGINT)

    try:
        with pytest.raises(KeyboardInterrupt):
            verdicts(checks, {"interrupted": 1})
    finally:
        signal.signal(signal.SIGINT, before)


@pytest.fixture(scope="module")
def nominal():
    return drive(Spiral(), ticks=1500)


def early_names(nominal, checks):
    points = dict.fromkeys((check.name for check in checks), 1.0)
    return [verdict.check for verdict in check.judge_nominal(nominal, checks, points, {})]


def test_a_check_that_looks_at_a_varied_run_waits_and_so_does_what_depends_on_it(nominal):
    checks = Checks()

    @checks()
    def alone(recordings, tolerances):
        return Finding(float(recordings.nominal is nominal), "")

    @checks()
    def counts(recordings, tolerances):
        try:
            return Finding(1.0, f"{len(recordings.varied)}")
        except Exception:  # an author's: it must not take the place of an answer
            return Finding(0.0, "")

    @checks()
    def all_of_them(recordings, tolerances):
        return Finding(float(all(r.run.ticks >= 0 for r in recordings)), "")

    @checks(after=("counts",))
    def later(recordings, tolerances):
        return Finding(1.0, "")

    @checks(after=("alone",))
    def sooner(recordings, tolerances):
        return Finding(1.0, "")

    assert early_names(nominal, checks) == ["alone", "sooner"]


def test_one_that_fails_itself_is_left_to_the_judge_of_all(nominal):
    checks = Checks()

    @checks()
    def raises(recordings, tolerances):
        raise ZeroDivisionError

    assert early_names(nominal, checks) == []


def test_what_is_said_early_is_what_is_said_in_the_end(nominal):
    exercise = load_exercise("turtlesim_challenge")
    asked = (exercise.checks, exercise.points, exercise.tolerances)
    first = check.judge_nominal(nominal, *asked)
    whole = check.judge(Recordings(nominal, (nominal, nominal)), *asked)
    assert 1 < len(first) < len(whole)
    assert [verdict for verdict in whole if verdict in first] == first


def test_asking_for_the_others_raises(nominal):
    alone = NominalAlone(nominal)
    assert next(iter(alone)) is nominal
    with pytest.raises(NotOver):
        list(alone)
