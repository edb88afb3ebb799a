"""Results of any content, as hypothesis draws them."""

from hypothesis import strategies as st

from tests.grader.reports import samples

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
