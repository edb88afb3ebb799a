"""Causes, refusals and remarks are sentences that each language knows."""

from __future__ import annotations

from dataclasses import replace

import pytest

from grader.diagnosis.diagnose import diagnose
from grader.errors import SubmissionError
from grader.language.phrase import Phrase, say
from grader.language.telling import told
from grader.recording import reading, remarks, saving
from grader.recording.recording import Recordings
from grader.run import finish, static, virtual_time
from grader.run.lockstep.faults import failed
from grader.run.opening import open_submission
from grader.run.simulator import link, real_time
from grader.run.simulator.virtual_time import VAIN
from grader.run.student.refusal import _OTHER_PROCESS
from grader.scenes import NAMES, load_scene, load_words
from tests.grader.diagnosis.cases import run_of
from tests.grader.diagnosis.test_rules import CAUSES
from tests.grader.language.holes import holes

LANGUAGES = ("fr", "zh")
REFUSED = (*_OTHER_PROCESS.values(), "becomes another program (bash)")
REMARKS = (
    *(virtual_time.WAITS_FOR_EVER, virtual_time.STUCK, virtual_time.STOPPED),
    *(virtual_time.FLOODING.format(9), link.NONSENSE, link.TOO_MANY, VAIN, real_time.OVERTIME),
    *(static.STOPPED, static.NOTHING.format("nothing")),
    *(flag for code in finish.SIGNALS for flag in finish.limits_struck(code, "", "")),
    *(flag for line in finish.LAST_LINES for flag in finish.limits_struck(1, line, "")),
    *(f"graded in real time, because the submission {does}" for does in REFUSED),
    f"graded in real time, because {failed('KeyError in graph.py, line 3')}",
)


@pytest.mark.parametrize("language", LANGUAGES)
@pytest.mark.parametrize("name", CAUSES)
def test_what_a_rule_has_found_is_said_in_each_language(name, language):
    found = diagnose(Recordings(CAUSES[name][0]))
    assert holes(found.cause, language) == holes(found.help, language) == []


@pytest.mark.parametrize("language", LANGUAGES)
@pytest.mark.parametrize("remark", REMARKS)
def test_what_another_process_remarks_is_known_again(remark, language):
    found = remarks.phrase(remark)
    assert found == remark
    assert holes(found, language) == []


@pytest.mark.parametrize("language", LANGUAGES)
@pytest.mark.parametrize("scene", NAMES)
def test_each_scene_says_what_is_driven_and_what_it_refuses(scene, language):
    assert holes(load_scene(scene).the_thing, language) == []
    assert [
        hole for key in load_words(scene).REMARKS for hole in holes(Phrase(key, key), language)
    ] == []


def test_a_remark_that_is_no_sentence_of_ours_stays_a_text():
    assert type(remarks.phrase("of somebody else's")) is str


def test_a_name_is_the_same_in_each_language(monkeypatch):
    cause = CAUSES["an exception"][0]
    place = replace(cause.conduct.raised.place, file="nothing", function="outside")
    raised = replace(cause.conduct.raised, place=place)
    cause = replace(cause, conduct=replace(cause.conduct, raised=raised))
    assert "(nothing, ligne 39)" in told(diagnose(Recordings(cause)).cause, "fr")


def test_a_refusal_comes_out_of_the_readers_process_as_a_phrase(tmp_path):
    with pytest.raises(SubmissionError) as refused, open_submission(tmp_path):
        pass
    assert [holes(refused.value.message, language) for language in LANGUAGES] == [[], []]


def test_notes_on_a_submission_are_phrases_in_a_recording_that_was_saved(tmp_path):
    note = say("other programs were not started: {names}", names="a.py, b.py")
    saving.save_all(Recordings(run_of(flags=(note, "somebody else's"))), tmp_path)
    (first, second) = reading.load_all(tmp_path).nominal.run.flags
    assert isinstance(first, Phrase)
    assert (first.key, second) == (note.key, "somebody else's")
