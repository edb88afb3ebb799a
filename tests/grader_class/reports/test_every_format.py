import re
from decimal import ROUND_HALF_UP, Decimal
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from grader.exercise.result.result import Result
from grader.reports import Report, render
from grader.reports.report import Artifacts
from tests.grader.reports import samples
from tests.grader.reports.drawn import (
    TEXTS,
    any_results,
)
from tests.grader.reports.readers import READERS
from tests.grader.reports.samples import FORMATS
from tests.limited import printed_by

#: What a runner of CI would obey in what a step prints.
COMMANDS = re.compile(r"^\s*::[a-z-]+[ :]|##\[|##vso\[", re.MULTILINE | re.IGNORECASE)
#: What a terminal would: no format needs any of it.
CONTROLS = re.compile(r"[\x00-\x08\x0b-\x1f\x7f-\x9f\u202a-\u202e\u2066-\u2069]")


class Printed(Artifacts):
    """Nothing lies beside the result but what the node printed."""

    def __init__(self, result, printed):
        super().__init__(result, Path("/nowhere"))
        self.__dict__["output"] = printed


def report_of(made, output):
    result = Result.from_json(made)
    return Report(result, Printed(result, output))


def safe_to_print(content):
    """Nothing in it that a runner of CI or a terminal would obey."""
    content.encode("utf-8")
    return not COMMANDS.search(content) and not CONTROLS.search(content)


@given(made=any_results(), output=st.lists(TEXTS, max_size=3).map("\n".join))
def test_every_format_of_every_result_is_well_formed_and_has_the_same_score(made, output):
    report = report_of(made, output)
    for name in FORMATS:
        content = render(name, [report])
        assert safe_to_print(content), name
        exact, found = Decimal(str(made["score"])), READERS[name](content)
        if name == "classroom50":
            whole = exact * classroom50_factor(made)
            assert found == int(whole.to_integral_value(ROUND_HALF_UP))
        else:
            assert found == pytest.approx(float(exact), abs=1e-9), name


def classroom50_factor(made):
    most = [Decimal(str(v["max_score"])) for v in made["verdicts"]]
    return next(f for f in (1, 10, 100) if all(m * f % 1 == 0 for m in most))


def test_there_is_a_reader_for_every_format():
    assert READERS.keys() == set(FORMATS)


@pytest.mark.parametrize("name", FORMATS)
def test_what_is_not_judged_never_looks_passed(name):
    content = render(name, [samples.report(samples.verdict("waits", "not_judged", 0))])
    assert READERS[name](content) == 0
    passed = {"✅", "✓", '"passed": true', '"status": "pass', "1 passed"}
    assert not [sign for sign in passed if sign in content.split("<script")[0]]


@pytest.mark.parametrize("name", sorted(set(FORMATS) - {"csv"}))
def test_every_format_says_the_cause_then_what_was_seen_and_what_to_look_at(name):
    content = samples.read_by_people(name, samples.report(diagnosis=samples.diagnosis()))
    if name == "html":
        content = content.partition("<body>")[2]
    for words in ("Help for draws.", "20.00 s", "(5.50, 7.25)", "a gap"):
        assert words in samples.read_by_people(name, samples.report()), words
    cause = content.index("You crashed at 6.0 s (drive.py, line 39).")
    assert cause < content.index("Mend that line.") < content.index("Rationale of draws.")
    assert "drive.py, line 39, in on_pose: 1 / 0" in content
    words = re.sub(r"</?\w[^<>]*>|[*\n]", " ", content)
    assert name == "junit" or re.search(r"Fix this first[: ]\s*You crashed at 6.0 s", words)


#: The longest that anything of a run may be, all of it of the hardest kind.
LONG = ["\n" * 65_000, "`" * 65_000, "\x1b[" * 30_000, "::a" * 20_000, " " * 65_000, "<" * 65_000]


@pytest.mark.more("every text is cut short by message and recording, which have units")
def test_reports_of_the_longest_texts_are_made_at_once_and_stay_short():
    code = """
import os
from tests.grader_class.reports.test_every_format import LONG, report_of, samples
from grader.reports.formats import load, names, render
os.environ.update(samples.CLASSROOM50)
long_ones = []
for long in LONG:
    found = [samples.evidence(long)] * 100
    verdicts = [samples.verdict(f"c{n}", "failed", 0, rationale=long, help=long, evidence=found)
                for n in range(5)]
    run = samples.run(flags=[long, *map(str, range(10_000))])
    long_ones.append(samples.result(*verdicts, submission=long, run=run))
for name in names():
    load(name)
limit(30, 4_000_000_000)
for made, long in zip(long_ones, LONG):
    report = report_of(made, long)
    for name in names():
        print(len(render(name, [report])))
"""
    sizes = [int(line) for line in printed_by(code).split()]
    assert len(sizes) == len(LONG) * len(FORMATS)
    assert max(sizes) < 5_000_000
