"""The page of a graded run: who looks sees what is told, and can do nothing else."""

import base64
import http.client
import json
from io import BytesIO

import numpy as np
import PIL.Image
import pytest
from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect

from grader.scenes.live import Grading
from grader.scenes.playback import JudgedCheck
from grader.scenes.scene import load_scene
from grader.scenes.turtlesim.pages import TurtlesimPage
from tests.programs import DEADLINE_S
from turtlesim_py.live.feed import Feed
from turtlesim_py.world.arena import Arena

#: What drives, or leads to a ROS graph.
REFUSED = [
    {"op": "publish", "topic": "/turtle1/cmd_vel", "msg": {"linear": {"x": 1}}},
    {"op": "advertise", "topic": "/turtle1/cmd_vel", "type": "geometry_msgs/msg/Twist"},
    {"op": "call_service", "service": "/clear"},
    {"op": "send_action_goal", "action": "/turtle1/rotate_absolute"},
    {"op": "subscribe", "topic": "/turtle1/pose", "type": "turtlesim/msg/Pose"},
    {"op": "call_service", "service": "/rosapi/topics"},
]


@pytest.fixture
def page():
    served = load_scene("turtlesim").live_page(0)
    yield served
    served.close()


@pytest.fixture
def viewer(page):
    with connect(socket_of(page)) as connection:
        yield connection


def socket_of(page):
    return page.address.replace("http:", "ws:").replace("/?", "/socket?")


def heard(viewer):
    return json.loads(viewer.recv(timeout=DEADLINE_S))


def news(ticks=60):
    """What a simulator tells of a turtle that turns and is given another pen."""
    told = []
    arena = Arena(sprite="jazzy")
    feed = Feed(arena, told.append, together=1)
    feed.is_watched = True
    feed.after_tick({})
    for tick in range(ticks):
        if tick % 20 == 0:
            arena.command("turtle1", (2.0, 0.0, 0.0), (0.0, 0.0, 1.5))
            arena.set_pen("turtle1", tick, 10, 30, 5, 0)
        feed.after_tick(arena.tick())
    return [change.content for change in told], arena


def test_who_comes_in_the_middle_has_the_same_picture_as_who_was_there(page, viewer):
    told, arena = news()
    viewer.send(json.dumps({"op": "subscribe", "topic": "/turtlesim_live"}))
    first = heard(viewer)["msg"]
    assert (first["turtles"], first["about"]["read_only"]) == ([], True)
    page.begin()
    page.hear(told[:30])
    page.hear(told[30:])
    began, early, late = (heard(viewer)["msg"] for _ in range(3))
    assert (began["begins"], began["drawn"]) == (True, [None])
    assert (early["tick"], late["tick"]) == (29, 60)
    assert [call["op"] for call in early["calls"]][:2] == ["cmd_vel", "set_pen"]
    strokes = [stroke for change in (early, late) for stroke in change["drawn"]]
    with connect(socket_of(page)) as other:
        other.send(json.dumps({"op": "subscribe", "topic": "/turtlesim_live"}))
        whole = heard(other)["msg"]
    with PIL.Image.open(BytesIO(base64.b64decode(whole["whole"]))) as png:
        painted = np.asarray(png.convert("RGBA"))
    assert np.array_equal(painted, arena.canvas.rgba())
    drawn = np.full((500, 500, 4), (255, 255, 255, 0), np.uint8)
    for color, numbers in strokes:
        for row, left, right in zip(*[iter(numbers)] * 3, strict=True):
            drawn[row, left : right + 1] = (*color, 255)
    assert np.array_equal(drawn, painted)
    assert whole["turtles"] == late["turtles"]


def test_what_checks_say_is_told_at_once_and_to_those_who_come_later(page, viewer):
    passed = JudgedCheck("It moves", "passed", "passed, 5 / 5 points", "It moved.", "", ())
    grading = Grading("zoe.py", "nominal run", "Score: 5", "Nothing to fix", (passed,))
    viewer.send(json.dumps({"op": "subscribe", "topic": "/turtlesim_live"}))
    heard(viewer)
    page.update(grading)
    told = heard(viewer)["msg"]["grading"]
    words = {"status": "passed", "word": "passed, 5 / 5 points", "title": "It moves"}
    assert told["checks"] == [{**words, "rationale": "It moved.", "help": ""}]
    for op in ("unsubscribe", "subscribe"):
        viewer.send(json.dumps({"op": op, "topic": "/turtlesim_live"}))
    assert heard(viewer)["msg"]["grading"] == told


@pytest.mark.parametrize("frame", REFUSED, ids=lambda frame: frame["op"])
def test_a_viewer_can_neither_drive_nor_see_a_ros_graph(viewer, frame):
    viewer.send(json.dumps({**frame, "id": 1}))
    answer = heard(viewer)
    said = answer.get("msg") or answer["values"]
    assert not answer.get("result")
    assert "for looking only" in said or "no topics and services" in said


def test_nobody_comes_in_without_the_token_not_even_on_this_machine(page):
    bare = page.address.partition("?")[0]
    with pytest.raises(InvalidStatus) as refused, connect(bare.replace("http:", "ws:") + "socket"):
        pass
    assert refused.value.response.status_code == 403
    asking = http.client.HTTPConnection(bare.removeprefix("http://").rstrip("/"))
    asking.request("GET", "/")
    answer = asking.getresponse()
    assert answer.status == 403
    assert "needs the token" in answer.read().decode()
    assert not page.await_viewer(0.0)


def test_a_wipe_takes_away_what_was_drawn_before_it():
    told = []
    mirror = TurtlesimPage(told.append)
    stroke = [[1, 2, 3], [10, 20, 30]]
    states = [{"tick": 1, "drawn": [stroke], "calls": []}]
    states += [{"tick": 2, "drawn": [None, stroke], "calls": []}]
    mirror.hear([*states, {"tick": 3, "drawn": [None], "calls": []}])
    assert told[-1].content == {"tick": 3, "drawn": [None], "calls": []}
    mirror.ask(None)
    assert not told[-1].canvas.rgba()[..., 3].any()
