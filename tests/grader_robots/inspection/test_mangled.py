"""Whatever is handed in as a package is looked at and judged: it is nobody's fault but its own."""

import re
import tempfile
from pathlib import Path

import pytest
from hypothesis import given, settings

import grader
from grader.errors import SubmissionError
from grader.exercise.check import judge
from grader.exercise.loading import load_exercise
from grader.submission.examining.steps import Ended, attempt
from grader.submission.package_trace import decode, encode
from tests.conftest import CASES
from tests.grader_robots.mangled import OUTSIDE, SAYS, Change, Mangled, packages
from tests.grader_robots.packages import looked_at, recorded

#: What is said where something of ours has failed, and the system has refused nothing.
OURS = re.compile(r"cannot be read \(\w+: .*, \w+\.py, line \d+\)")
EXERCISES = [load_exercise(name) for name in ("description_package", "thymio_package")]


@pytest.mark.parametrize("kind", ["_written", "_resized", "_encoded", "_added", "_swapped"])
def test_a_link_out_of_a_mangled_package_is_not_written_through(kind, tmp_path):
    changes = [Change("_linked", number, 0, 2, "", "") for number in range(40)]
    changes += [Change(kind, number, 0, 3, "a", "") for number in range(40)]
    Mangled(0, tuple(changes)).lay_out(tmp_path)
    assert (tmp_path / OUTSIDE).read_text(encoding="ascii") == SAYS


@pytest.mark.more("a search; what it has found is in test_hostile")
@pytest.mark.timeout(4 * CASES)
@settings(max_examples=CASES)
@given(package=packages())
def test_a_mangled_package_is_looked_at_and_judged(package):
    with tempfile.TemporaryDirectory() as folder:
        trace = looked_at(package.lay_out(Path(folder)), cpu_s=3.0, wall_s=3.0)
        assert (Path(folder) / OUTSIDE).read_text(encoding="ascii") == SAYS
    assert decode(encode(trace)) == trace
    looks = [each for each in (trace.setup, *trace.launches, *trace.descriptions) if each]
    assert [each for each in looks if each.problem and OURS.search(str(each.problem.text))] == []
    for exercise in EXERCISES:
        found = judge(recorded(trace), exercise.checks, exercise.points, exercise.tolerances)
        assert not any("fault of the exercise" in str(verdict.rationale) for verdict in found)


@pytest.mark.timeout(4 * CASES)
@settings(max_examples=CASES // 10)
@given(package=packages())
def test_a_mangled_package_that_is_handed_in_is_no_failure_of_the_grader(package):
    with tempfile.TemporaryDirectory() as folder:
        try:
            result = grader.grade(package.lay_out(Path(folder)), EXERCISES[0])
        except SubmissionError as unusable:
            assert str(unusable)
        else:
            assert result.run.outcome == "finished"
            assert 0 <= result.score <= result.max_score


def test_a_failure_of_ours_at_a_file_is_a_finding_of_that_file():
    with pytest.raises(Ended) as ended:
        attempt(lambda: {}["a"], "CMakeLists.txt")
    problem = ended.value.problem
    assert (problem.kind, problem.file) == ("unknown", "CMakeLists.txt")
    assert OURS.search(str(problem.text))
