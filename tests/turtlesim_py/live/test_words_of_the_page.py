"""The live page's sentences: each has a translation, and none is left over."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
from geometry_msgs.msg import Twist
from std_msgs.msg import ByteMultiArray, UInt8
from std_srvs.srv import SetBool

import turtlesim_py
from tests.catalogues import script
from turtlesim_py.live import messages
from turtlesim_py.live.rosbridge import FRAMES_AT_ONCE, Session

PAGE = Path(turtlesim_py.__file__).parent / "live" / "page"


@pytest.mark.parametrize("language", script().LANGUAGES)
def test_every_sentence_has_a_translation_and_every_translation_a_sentence(language):
    sentences = script().read(PAGE, language)
    assert set(sentences) == set(script().of_simulator())
    assert all(sentences.values())


@pytest.mark.parametrize("language", script().LANGUAGES)
def test_a_translation_has_the_values_of_its_sentence(language):
    for english, said in script().read(PAGE, language).items():
        assert sorted(re.findall(r"\{\w+\}", english)) == sorted(re.findall(r"\{\w+\}", said))


WRONG = [
    (Twist, 5),
    (Twist, {"linear": 5}),
    (Twist, {"speed": 5}),
    (Twist, {"linear": {"speed": 5}}),
    (Twist, {"linear": {"x": "fast"}}),
    (Twist, {"linear": {"x": 10**400}}),
    (UInt8, {"data": 300}),
    (UInt8, {"data": "a"}),
    (SetBool.Request, {"data": 1}),
    (SetBool.Response, {"message": 1}),
    (ByteMultiArray, {"layout": {"dim": 7}}),
]


@pytest.mark.parametrize(("kind", "said"), WRONG)
def test_what_is_told_of_a_message_that_does_not_fit_is_a_sentence_of_the_page(kind, said):
    with pytest.raises(messages.Rejected) as caught:
        messages.from_json(kind, said)
    assert caught.value.key in set(script().of_simulator())


def test_what_is_told_of_a_refused_frame_is_a_sentence_of_the_page():
    told = []
    session = Session(lambda: None, True, told.append, lambda watches: None, now=lambda: 0.0)
    for _ in range(int(FRAMES_AT_ONCE) + 1):
        session.handle(json.dumps({"op": "publish", "topic": "/a"}))
    answers = {each["msg"]: each["sentence"] for each in told}
    assert len(answers) == 2
    for text, sentence in answers.items():
        assert sentence["key"] in set(script().of_simulator())
        assert sentence["key"].format(**sentence["values"]) == text
