"""The live page's sentences: each has a translation, and none is left over."""

from __future__ import annotations

import asyncio
import json
import re
from pathlib import Path

import pytest
from geometry_msgs.msg import Twist
from std_msgs.msg import ByteMultiArray, UInt8
from std_srvs.srv import SetBool

import turtlesim_py
from tests import page_words
from turtlesim_py.live import messages
from turtlesim_py.live.rosbridge import FRAMES_AT_ONCE, Session

PAGE = Path(turtlesim_py.__file__).parent / "live" / "page"
FILES = sorted(file for file in PAGE.iterdir() if file.suffix in (".html", ".js"))


@pytest.mark.parametrize("language", page_words.LANGUAGES)
def test_every_sentence_has_a_translation_and_every_translation_a_sentence(language):
    sentences = page_words.catalogue(PAGE, language)
    assert set(sentences) == page_words.of_page(FILES)
    assert all(sentences.values())


@pytest.mark.parametrize("language", page_words.LANGUAGES)
def test_a_translation_has_the_values_of_its_sentence(language):
    assert list(page_words.badly_filled(page_words.catalogue(PAGE, language))) == []


def patterns() -> list[re.Pattern[str]]:
    """What the page takes for an answer of the server's, as answers.js makes it."""
    listed = re.findall(r'key\("(.*)"\)', (PAGE / "answers.js").read_text(encoding="utf-8"))
    assert len(listed) > 10
    return [re.compile(re.sub(r"\\\{\w+\\\}", ".+?", re.escape(each))) for each in listed]


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
    with pytest.raises(messages.Unfit) as caught:
        messages.from_json(kind, said)
    assert any(each.fullmatch(str(caught.value)) for each in patterns()), caught.value


def test_what_is_told_of_a_refused_frame_is_a_sentence_of_the_page():
    class Host:
        is_read_only = True

    told = []
    session = Session(Host(), told.append, lambda watches: None, now=lambda: 0.0)
    for _ in range(int(FRAMES_AT_ONCE) + 1):
        asyncio.run(session.hear(json.dumps({"op": "publish", "topic": "/a"})))
    texts = {each["msg"] for each in told}
    assert len(texts) == 2
    for text in texts:
        assert any(each.fullmatch(text) for each in patterns()), text
