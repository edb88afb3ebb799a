import re
from decimal import ROUND_HALF_UP, Decimal
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from grader.exercise.result.result import Result
from grader.reports import Report, render
from grader.reports.beside import Beside
from tests.grader.reports import samples
from tests.grader.reports.readers import READERS
from tests.grader.reports.samples import FORMATS
from tests.limited import printed_by

# fmt: off
NASTY = [
    "]]>", "<script>alert(1)</script>", '"><img src=x onerror=alert(1)>', "</script>", "<!--",
    "{{ 7 * 7 }}", "a | b \\| c", "[link](http://evil.example)",
    "http://evil.example and www.evil.example, me@evil.example", "![x](y)", "```\n# title\n```",
    "---", "1. one", "=HYPERLINK(1)", "Grade :=>> 100", "--|>\nGrade :=>> 100\n<|--",
    "\nGrade :=>> 100", "-title (-50)", '{"scores": {"all": 100}}', "\n::error::boo",
    "::Set-Output name=a::b", "\n \t::add-mask::e",
    "##[error]boo ##vso[task.complete result=Failed]", "a;=HYPERLINK(1); -1;@x",
    "\uff1dHYPERLINK(1)", ":smile: [link=http://evil.example]x[/link]", "`" * 7,
    "</pre></details>", "[[ATTACHMENT|/etc/passwd]]", "\x1b[31mred\x1b[0m \x1b]0;title\x07",
    "\x00\x08\x0b\x0c\x1f\x7f\x85", "\ud800", "\ufffe\uffff", "\u2028\u2029", "\u202egpj.exe",
    "score", "[bold]rich[/bold] [/]", "<b>&amp;</b>", "ünïcödé 🐢", "", " ",
]
# fmt: on
TEXTS = st.one_of(
    st.sampled_from(NASTY),
    st.text(st.characters(codec=None), max_size=40),
    st.lists(st.sampled_from(NASTY), max_size=3).map("".join),
)
OWN_FILES = TEXTS.filter(lambda text: not text.startswith("/") and ".." not in text.split("/"))
PLACES = st.one_of(st.floats(-1, 12), st.just(float("nan")), st.just(float("inf")))
EVIDENCE = st.fixed_dictionaries(
    {
        "tick": st.integers(0, 10_000),
        "time_s": st.floats(0, 1000),
        "x": PLACES,
        "y": PLACES,
        "note": TEXTS,
    },
    optional={"run": st.integers(0, 3)},
)


HAND_INS = st.fixed_dictionaries(
    {
        "id": TEXTS,
        "name": TEXTS,
        "attempt": st.integers(1, 3),
        "at": st.sampled_from([None, "2026-12-01T01:00:00+01:00"]),
        "late_s": st.sampled_from([0.0, 300.0]),
        "days": st.just(0),
        "deducted": st.just(0.0),
    }
)

#: What a runner of CI would obey in what a step prints.
COMMANDS = re.compile(r"^\s*::[a-z-]+[ :]|##\[|##vso\[", re.MULTILINE | re.IGNORECASE)
#: What a terminal would: no format needs any of it.
CONTROLS = re.compile(r"[\x00-\x08\x0b-\x1f\x7f-\x9f\u202a-\u202e\u2066-\u2069]")


class Printed(Beside):
    """Nothing lies beside the result but what the node printed."""

    def __init__(self, result, printed):
        super().__init__(result, Path("/nowhere"))
        self.__dict__["output"] = printed


def report_of(made, output):
    result = Result.from_json(made)
    return Report(result, Printed(result, output))


@st.composite
def verdicts(draw):
    most = draw(st.sampled_from([0, 1, 2.5, 5, 10, 30, 33.33]))
    status = draw(st.sampled_from(["passed", "failed", "not_judged"]))
    share = {"passed": 1.0, "not_judged": 0.0}.get(status)
    if share is None:
        share = draw(st.floats(0, 0.999))
    return {
        "check": draw(TEXTS),
        "title": draw(TEXTS),
        "status": status,
        "score": round(most * share, 2),
        "max_score": most,
        "rationale": draw(TEXTS),
        "help": draw(TEXTS),
        "evidence": draw(st.lists(EVIDENCE, max_size=3)),
        "depends_on": draw(st.lists(TEXTS, max_size=2)),
    }


@st.composite
def diagnoses(draw):
    found = {"key": draw(TEXTS), "cause": draw(TEXTS), "help": draw(TEXTS), "run": 0}
    if draw(st.booleans()):
        found["time_s"] = draw(st.floats(0, 1000))
    if draw(st.booleans()):
        place = {
            "file": draw(OWN_FILES),
            "line": 39,
            "function": draw(TEXTS),
            "text": draw(TEXTS),
        }
        found["place"] = place
    if check := draw(TEXTS):
        found["check"] = check
    return found


@st.composite
def any_results(draw):
    flags = draw(st.lists(TEXTS, max_size=2))
    facts = samples.run(
        flags=flags,
        isolation=draw(TEXTS),
        outcome=draw(st.sampled_from(["finished", "crashed", "time_limit"])),
        exit_code=draw(st.none() | st.integers(-11, 255)),
    )
    each = st.lists(verdicts(), min_size=1, max_size=5, unique_by=lambda made: made["check"])
    listed = draw(each)
    made = samples.result(
        *listed, submission=draw(TEXTS), exercise=draw(TEXTS), run=facts, varied_runs=[facts]
    )
    if draw(st.booleans()):
        made["handed_in"] = draw(HAND_INS)
    diagnosis = draw(st.none() | diagnoses())
    return made if diagnosis is None else made | {"diagnosis": diagnosis}


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
from tests.grader.reports.test_every_format import LONG, report_of, samples
from grader.reports import load, names, render
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
