import json

import pytest
from geometry_msgs.msg import Twist
from std_msgs.msg import ByteMultiArray, UInt8
from std_srvs.srv import SetBool

from turtlesim_py.live import messages
from turtlesim_py.live.rosbridge import FRAMES_AT_ONCE, Session

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
def test_a_message_that_does_not_fit_is_refused_in_a_sentence(kind, said):
    with pytest.raises(messages.Rejected, match=r"expected|no field|is not what"):
        messages.from_json(kind, said)


def test_a_refused_frame_is_answered_by_a_sentence():
    told = []
    session = Session(lambda: None, True, told.append, lambda watches: None, now=lambda: 0.0)
    for _ in range(int(FRAMES_AT_ONCE) + 1):
        session.handle(json.dumps({"op": "publish", "topic": "/a"}))
    answers = {each["msg"]: each["sentence"] for each in told}
    assert len(answers) == 2
    for text, sentence in answers.items():
        assert sentence["key"].format(**sentence["values"]) == text
