"""Causes, refusals and remarks are sentences that each language knows."""

from __future__ import annotations

from dataclasses import replace

import pytest

from grader import extensions
from grader.diagnosis.diagnose import diagnose
from grader.errors import SubmissionError
from grader.message import NOTHING, msg, plain_text
from grader.recording import reading, saving
from grader.recording.recording import Recordings
from grader.recording.subject import load_subject
from grader.run import finish, inspecting, virtual_time
from grader.run.clock.unsupported_calls import _OTHER_PROCESS
from grader.run.lockstep.faults import failed
from grader.run.opening import open_submission
from grader.run.simulator import link, real_time
from grader.run.simulator.hub import VAIN
from grader.scenes.turtlesim import allowance
from grader.translations import translate
from tests.grader.diagnosis.cases import run_of
from tests.grader.diagnosis.test_rules import CAUSES
from tests.grader.languages.holes import holes

LANGUAGES = ("fr", "zh")
REFUSED = [each.given(program="bash") for said in _OTHER_PROCESS.values() for each in said if each]
REMARKS = (
    *(virtual_time.WAITS_FOR_EVER, virtual_time.STUCK, virtual_time.STOPPED),
    *(virtual_time.FLOODING.given(seconds="9"), link.NONSENSE, link.TOO_MANY, VAIN),
    *(real_time.OVERTIME, inspecting.STOPPED, inspecting._LOST.given(why_not="nothing")),
    *(flag for code in finish.SIGNALS for flag in finish.limits_struck(code, "", NOTHING)),
    *(flag for line in finish.LAST_LINES for flag in finish.limits_struck(1, line, NOTHING)),
    *(
        msg("graded in real time, because {why}", why=msg("the submission {does}", does=does))
        for does in REFUSED
    ),
    msg("graded in real time, because {why}", why=failed("KeyError in graph.py, line 3")),
    *(allowance._NOT_ALL, allowance._MANY_AT_A_TIME, allowance._MANY_IN_A_RUN),
    *allowance.FIXED.values(),
)


@pytest.mark.parametrize("language", LANGUAGES)
@pytest.mark.parametrize("name", CAUSES)
def test_what_a_rule_has_found_is_said_in_each_language(name, language):
    found = diagnose(Recordings(CAUSES[name][0]))
    assert holes(found.cause, language) == holes(found.help, language) == []


@pytest.mark.parametrize("language", LANGUAGES)
@pytest.mark.parametrize("remark", REMARKS, ids=str)
def test_what_another_process_remarks_is_said_in_each_language(remark, language):
    assert holes(remark, language) == []
    assert "{" not in translate(remark, language)
    assert translate(remark, language) != str(remark)


@pytest.mark.parametrize("language", LANGUAGES)
@pytest.mark.parametrize("name", extensions.points(extensions.SCENES))
def test_each_scene_says_what_is_driven(name, language):
    subject = load_subject(name)
    said = (subject.thing, subject.the_thing, *subject.outcomes.values())
    assert [hole for each in said for hole in holes(each, language)] == []


def test_a_name_is_the_same_in_each_language(monkeypatch):
    cause = CAUSES["an exception"][0]
    place = replace(cause.observations.raised.place, file="nothing", function="outside")
    raised = replace(cause.observations.raised, place=place)
    cause = replace(cause, observations=replace(cause.observations, raised=raised))
    assert "(nothing, ligne 39)" in translate(diagnose(Recordings(cause)).cause, "fr")


def test_a_refusal_comes_out_of_the_readers_process_as_a_message(tmp_path):
    with pytest.raises(SubmissionError) as refused, open_submission(tmp_path):
        pass
    assert [holes(refused.value.message, language) for language in LANGUAGES] == [[], []]


def test_remarks_are_messages_in_a_recording_that_was_saved(tmp_path):
    flags = (
        msg("other programs were not started: {names}", names="a.py, b.py"),
        msg("graded in real time, because {why}", why=msg("the submission {does}", does="waits")),
        plain_text("somebody else's"),
    )
    saving.save_all(Recordings(run_of(flags=flags)), tmp_path)
    assert reading.load_all(tmp_path).nominal.run.flags == flags
