"""Which cause comes first, and what is said where no run shows one."""

from typing import Literal, get_args, get_origin, get_type_hints

from hypothesis import given
from hypothesis import strategies as st

from grader.exercise.result.diagnosis import CHECK
from grader.exercise.verdict import Evidence, Verdict
from grader.recording.observations import (
    Observations,
    Raised,
    SlowCallback,
    SourceLine,
    Standstill,
    StopKind,
)
from grader.recording.reading import load_all
from grader.recording.recording import Recordings
from grader.recording.saving import save_all
from grader.text.message import Message
from grader.text.strings import one_line
from grader_diagnosis.diagnose import diagnose
from tests.grader.recording.test_printed import CODE
from tests.grader_diagnosis.cases import LINE, run_of, said
from tests.limited import printed_by

CRASH = run_of(said(raised=Raised("KeyError", "4", 6.0, LINE)), "crashed", exit_code=1)
SLOW = run_of(said(slow=(SlowCallback(LINE, 0.2, 50),)))
RIGHT = run_of(said())


def verdict(check, status="failed", score=0.0, most=10.0, **more):
    texts = (Message.of(f"{check} was seen."), Message.of(f"{check} help"))
    return Verdict(check, Message.of(check), status, score, most, *texts, **more)


def test_at_full_marks_there_is_none_but_for_a_crash():
    passed = [verdict("a", "passed", 10.0)]
    assert diagnose(Recordings(SLOW), passed) is None
    assert diagnose(Recordings(RIGHT, (CRASH,)), passed).key == "crashed"


def test_a_crash_in_a_varied_run_comes_before_what_only_disturbs_the_nominal_one(tmp_path):
    found = diagnose(Recordings(SLOW, (RIGHT, CRASH)), [verdict("a")])
    assert (found.key, found.run, found.time_s, found.place) == ("crashed", 2, 6.0, LINE)
    assert str(found.cause).startswith("In varied run 2: Your node crashed at 6.0 s: KeyError: 4")
    assert diagnose(Recordings(CRASH, (CRASH,)), [verdict("a")]).run == 0
    recordings = Recordings(SLOW, (RIGHT, CRASH))
    save_all(recordings, tmp_path)
    verdicts = [verdict("a")]
    assert diagnose(load_all(tmp_path), verdicts) == diagnose(recordings, verdicts)


def test_the_check_that_costs_most_with_all_that_wait_for_it_is_told_or_the_first():
    seen = (Evidence(1.6, "here", 2.0, 3.0, 1, tick=100),)
    verdicts = [
        verdict("dear", "failed", 5.0, 30.0),
        verdict("moves", most=10.0, evidence=seen),
        verdict("waits", "not_judged", most=20.0, depends_on=("moves",)),
    ]
    found = diagnose(Recordings(RIGHT, (RIGHT,)), verdicts)
    assert (found.key, found.check) == (CHECK, "moves")
    assert (str(found.cause), str(found.help)) == ("moves was seen.", "moves help")
    assert (found.run, found.time_s) == (1, 1.6)
    assert diagnose(Recordings(RIGHT), [verdict("a"), verdict("b")]).check == "a"
    found = diagnose(Recordings(RIGHT), [verdict("a", "passed", 10.0), verdict("b", "not_judged")])
    assert found.check == "b"


HARD = ["\x1b[31m", "\u202e", "\n::error::x", "'NoneType'", "The 'x' field must be of type 'int'"]
HARD += ["The '' field", "SyntaxError", "AttributeError", "has no attribute", "/", "//", "a" * 300]
TEXTS = st.text(max_size=20) | st.sampled_from(HARD)
PLACES = st.builds(SourceLine, TEXTS, st.integers(0, 2**53), TEXTS, TEXTS)
FORMS = {
    SourceLine: PLACES,
    str: TEXTS | st.sampled_from(["/turtle1/cmd_vel", "/pose", "a/msg/B", "turtlesim/msg/Pose"]),
    int: st.integers(0, 100),
    bool: st.booleans(),
    float: st.floats(0, 1e9),
    StopKind: st.sampled_from(["callback", "call", "loop"]),
}


def anything(kind):
    return st.builds(kind, **{name: form(hint) for name, hint in get_type_hints(kind).items()})


def form(hint):
    if hint in FORMS:
        return FORMS[hint]
    if get_origin(hint) is Literal:
        return st.sampled_from(get_args(hint))
    if get_origin(hint) is tuple:
        return st.lists(form(get_args(hint)[0]), max_size=3).map(tuple)
    if get_args(hint):
        return st.one_of(map(form, get_args(hint)))
    return st.none() if hint is type(None) else anything(hint)


@given(
    seen=anything(Observations),
    outcome=st.sampled_from(["finished", "exited", "crashed", "stalled", "time_limit", "killed"]),
    code=st.none() | st.integers(-70, 255),
    output=TEXTS,
)
def test_whatever_a_program_tells_the_diagnosis_is_one_plain_line(seen, outcome, code, output):
    recording = run_of(seen, outcome, exit_code=code, output=output)
    found = diagnose(Recordings(recording))
    if found is not None:
        for text in (str(found.cause), str(found.help)):
            assert text
            assert text == one_line(text)
            assert not {"\x1b", "\u202e"} & set(text)
            assert len(text) < 1500


def test_the_stuck_place_of_a_stop_without_a_line_is_left_out():
    found = diagnose(Recordings(run_of(said(stop=Standstill("call", 1.0)), "stalled")))
    assert str(found.cause).startswith(
        "Your program is stuck from 1.0 s on: it waits while nobody spins"
    )


def test_an_output_is_gone_through_once():
    code = CODE.replace("LOOKS", "[crash._FIELD.search]")
    assert printed_by(f"from grader_diagnosis import crash{code}") == "done\n"
