import http.client
import json
import math
import socket

import pytest
from geometry_msgs.msg import Twist
from hypothesis import given
from hypothesis import strategies as st
from websockets.exceptions import ConnectionClosed, InvalidStatus

from tests.programs import Program
from tests.turtlesim_py.live.conftest import Page
from turtlesim_py.live.rosbridge import MOST_OPEN

TWIST = "geometry_msgs/msg/Twist"
ANYTHING = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=20),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=8), inner),
    max_leaves=20,
)
POSE = '"op": "subscribe", "topic": "/seen/turtle1/pose"'
DRIVE = '"op": "publish", "topic": "/seen/turtle1/cmd_vel"'
OPS = ("advertise", "unadvertise", "publish", "subscribe", "unsubscribe", "call_service")


def rests(viewer):
    answer = viewer.ask(op="call_service", service="/rosapi/topics", id="still there")
    assert answer["result"], answer


def test_a_command_drives_the_turtle_and_everybody_in_the_graph_hears_it(page, graph):
    with page.viewer() as viewer:
        for _ in range(5):
            viewer.say(op="subscribe", topic="/turtlesim_live")
        whole = viewer.until(lambda frame: "whole" in frame.get("msg", {}))["msg"]
        assert whole["about"]["node"] == "/seen/turtlesim"
        frames = []  # who watches already is not sent all of it again
        viewer.say(op="call_service", service="/rosapi/topics", id="then")
        viewer.until(lambda frame: frames.append(frame) or frame.get("id") == "then")
        assert not [frame for frame in frames if "whole" in frame.get("msg", {})]
        topic = {"topic": "/seen/turtle1/cmd_vel", "type": TWIST}
        viewer.say(op="advertise", **topic)
        heard = graph.listen(Twist, topic["topic"])

        def drives():
            viewer.say(op="publish", **topic, msg={"linear": {"x": 1.0}})
            return any(twist.linear.x == 1.0 for twist in heard)

        graph.until(drives, "the command")
        news = viewer.until(lambda frame: frame.get("msg", {}).get("drawn"))["msg"]
        color, runs = news["drawn"][0]
        assert color == [179, 184, 255] and len(runs) % 3 == 0


def test_a_subscriber_hears_a_topic_whatever_its_type_and_how_often_it_asked(page):
    with page.viewer() as viewer:
        viewer.say(op="subscribe", topic="/seen/turtle1/pose", throttle_rate=50)
        pose = viewer.until(lambda frame: frame.get("topic") == "/seen/turtle1/pose")["msg"]
        assert set(pose) == {"x", "y", "theta", "linear_velocity", "angular_velocity"}
        viewer.say(op="unsubscribe", topic="/seen/turtle1/pose")
        rests(viewer)


def test_services_answer(page):
    with page.viewer() as viewer:
        spawn = {"op": "call_service", "service": "/seen/spawn"}
        args = {"x": 1.0, "y": 2, "theta": 0.5, "name": "called"}
        made = viewer.ask(**spawn, args=args, id="a")
        assert (made["values"], made["result"]) == ({"name": "called"}, True)
        assert viewer.ask(**spawn, args=args, id="b")["values"] == {"name": ""}
        kill = viewer.ask(op="call_service", service="/seen/kill", args={"name": "called"}, id="c")
        assert kill["result"] is True


def test_an_action_is_followed_and_cancelled(page):
    turn = {
        "op": "send_action_goal",
        "action": "/seen/turtle1/rotate_absolute",
        "action_type": "turtlesim/action/RotateAbsolute",
    }
    with page.viewer() as viewer:
        viewer.say(**turn, args={"theta": 1.0}, id="turn")
        feedback = viewer.until(lambda frame: frame["op"] == "action_feedback")
        assert 0.0 < feedback["values"]["remaining"] <= 2.0 * math.pi
        ended = viewer.until(lambda frame: frame["op"] == "action_result")
        assert (ended["id"], ended["status"], ended["result"]) == ("turn", 4, True)
        viewer.say(**turn, args={"theta": -2.0}, id="long")
        viewer.until(lambda frame: frame["op"] == "action_feedback")
        viewer.say(op="cancel_action_goal", action=turn["action"], id="long")
        assert viewer.until(lambda frame: frame["op"] == "action_result")["status"] == 5
        # before its server has answered
        viewer.say(**turn, args={"theta": 1.0}, id="hasty")
        viewer.say(op="cancel_action_goal", action=turn["action"], id="hasty")
        ended = viewer.until(lambda frame: frame["op"] == "action_result")
        assert (ended["id"], ended["status"]) == ("hasty", 5)


def test_what_there_is_can_be_asked_for(page):
    with page.viewer() as viewer:

        def ask(service, /, **args):
            call = {"op": "call_service", "service": f"/rosapi/{service}", "args": args}
            return viewer.ask(**call, id=service)["values"]

        topics = ask("topics")
        types = dict(zip(topics["topics"], topics["types"], strict=True))
        assert types["/seen/turtle1/cmd_vel"] == TWIST
        assert not [name for name in types if "/_" in name]
        assert "/seen/turtle1/set_pen" in ask("services")["services"]
        assert viewer.ask(op="call_service", service="rosapi/topics", id=0)["values"] == topics
        assert ask("service_type", service="/seen/spawn") == {"type": "turtlesim/srv/Spawn"}
        first, second = ask("message_details", type="geometry_msgs/Twist")["typedefs"]
        assert first["fieldnames"] == ["linear", "angular"]
        assert second["fieldtypes"] == ["double"] * 3
        assert ask("publishers", topic="/seen/turtle1/pose") == {"publishers": ["/seen/turtlesim"]}


@pytest.mark.parametrize(
    ("frame", "words"),
    [
        ("not json", "expected JSON"),
        ("[" * 10_000, "expected JSON"),
        ("[1]", "expected a JSON object"),
        ('{"op": "fly"}', "unknown op 'fly'; there are advertise"),
        ('{"op": ["publish"]}', "unknown op"),
        ('{"op": "publish"}', "topic: expected a text"),
        ('{"op": "publish", "topic": "/nowhere"}', "there is no topic '/nowhere'"),
        ('{"op": "publish", "topic": "not a name", "type": "std_msgs/String"}', "not a name"),
        ('{"op": "subscribe", "topic": "/a", "type": "os/path"}', "is not installed here"),
        ('{"op": "subscribe", "topic": "/a", "type": "../x"}', "is no type"),
        ('{"op": "subscribe", "topic": "/\\ud800", "type": "std_msgs/String"}', "expected JSON"),
        (f'{{{POSE}, "throttle_rate": 1{"0" * 400}}}', "milliseconds"),
        (f'{{{POSE}, "throttle_rate": -1}}', "milliseconds"),
        (f'{{{POSE}, "type": "std_msgs/String"}}', "RCLError"),
        ('{"op": "subscribe", "topic": "~/x{y}", "type": "std_msgs/String"}', ""),
        ('{"op": "call_service", "service": "/x", "id": NaN}', "expected JSON"),
        (f'{{{DRIVE}, "msg": {{"linear": {{"x": "a"}}}}}}', "linear.x: expected a number, found"),
        (f'{{{DRIVE}, "msg": {{"speed": 1}}}}', "no field speed; there are linear, angular"),
    ],
)
def test_what_cannot_be_followed_is_answered_and_ends_nothing(page, frame, words):
    with page.viewer() as viewer:
        viewer.connection.send(frame)
        said = viewer.until(lambda answer: answer["op"] == "status")
        assert (said["level"], words in said["msg"]) == ("error", True), said["msg"]
        rests(viewer)


@pytest.mark.parametrize(
    ("service", "args", "words"),
    [
        ("/seen/fly", {}, "there is no service '/seen/fly'"),
        ("/seen/spawn", {"x": "here"}, "x: expected a number, found 'here'"),
        ("/seen/turtle1/set_pen", {"r": 256}, "r: expected a whole number from 0 to 255"),
        ("/rosapi/nodes", {}, "there is no service"),
        ("/rosapi/topic_type", {"topic": 3}, "topic: expected a text"),
        ("/rosapi/message_details", {"type": "this/msg/X"}, "not installed"),
    ],
)
def test_a_call_that_cannot_be_made_says_why(page, service, args, words):
    with page.viewer() as viewer:
        answer = viewer.ask(op="call_service", service=service, args=args, id=1)
        assert (answer["result"], words in answer["values"]) == (False, True), answer
    assert "Zen of Python" not in page.program.text()  # nothing is imported to look for its types


def test_whatever_a_viewer_sends_the_simulator_goes_on(page):
    with page.viewer() as viewer:

        @given(
            st.dictionaries(
                st.sampled_from(("topic", "type", "msg", "service", "args", "id")),
                ANYTHING | st.just("/seen/turtle1/cmd_vel") | st.just(TWIST),
            ),
            st.sampled_from(OPS),
        )
        def send(frame, op):
            viewer.connection.send(json.dumps({"op": op, **frame}))

        send()
        rests(viewer)


def test_calls_with_one_id_count_as_many(page):
    with page.viewer() as viewer:
        for _ in range(MOST_OPEN + 1):
            viewer.say(op="call_service", service="/nobody/serves", type="std_srvs/Empty", id="one")
        said = viewer.until(lambda frame: frame["op"] == "status")
        assert said["msg"] == f"a viewer may have {MOST_OPEN} at once"


@pytest.mark.parametrize("path", ["//[x]/index.html", "http://[/x"])
def test_an_address_that_is_none_is_not_found(page, path):
    with socket.create_connection(("127.0.0.1", page.port)) as asking:
        asking.sendall(f"GET {path} HTTP/1.1\r\nHost: localhost\r\n\r\n".encode())
        assert asking.makefile("rb").readline().startswith(b"HTTP/1.1 404")


def test_a_flood_and_a_frame_that_is_huge_are_refused_and_others_notice_nothing(page):
    with page.viewer() as other, page.viewer() as viewer:
        for _ in range(1000):
            viewer.connection.send('{"op": "unsubscribe", "topic": "/a"}')
        viewer.until(lambda frame: "frames a second" in frame.get("msg", ""))
        with pytest.raises(ConnectionClosed):
            viewer.connection.send('"' + "x" * 300_000 + '"')
            viewer.until(lambda frame: False)
        rests(other)


def test_pages_of_others_and_names_of_others_are_refused(page):
    with pytest.raises(InvalidStatus) as refused, page.viewer(origin="https://evil.example"):
        pass
    assert refused.value.response.status_code == 403
    asking = http.client.HTTPConnection("127.0.0.1", page.port)
    asking.request("GET", "/", headers={"Host": "evil.example"})
    answer = asking.getresponse()
    assert answer.status == 403
    assert "open the whole address that was printed" in answer.read().decode()


@pytest.mark.parametrize(
    ("path", "status"),
    [
        *((path, 200) for path in ("/", "/proxy/8080/", "/index.html")),
        *((path, 404) for path in ("/../server.py", "/nothing.js", "/%2e%2e/feed.py")),
    ],
)
def test_the_page_is_there_below_whatever_prefix_and_nothing_else(page, path, status):
    asking = http.client.HTTPConnection("127.0.0.1", page.port)
    asking.request("GET", path)
    answer = asking.getresponse()
    assert answer.status == status
    assert status != 200 or answer.getheader("Content-Type") == "text/html; charset=utf-8"
    assert (b"<canvas" in answer.read()) == (status == 200)


def test_for_looking_only_nothing_moves_and_elsewhere_the_token_is_needed(tmp_path):
    words = ("view_port:=0", "view_read_only:=true", "view_host:=0.0.0.0", "view_token:=seen")
    arguments = [word for each in words for word in ("-p", each)]
    with Program("turtlesim_py.ros.node", "--ros-args", *arguments, cwd=tmp_path) as program:
        page = Page(program)
        assert page.address.endswith("/?token=seen")
        with pytest.raises(InvalidStatus), page.viewer():
            pass
        with page.viewer("socket?token=seen") as viewer:
            for op in ("publish", "call_service", "advertise", "send_action_goal"):
                viewer.say(op=op, topic="/turtle1/cmd_vel", type=TWIST, service="/clear")
                said = viewer.until(lambda frame: frame["op"] == "status")
                assert said["msg"] == f"{op} is refused: this page is for looking only"
            rests(viewer)
        assert program.stop() == 0


def test_a_port_that_is_taken_is_told_in_a_line(page, tmp_path):
    arguments = ("--ros-args", "-p", f"view_port:={page.port}")
    with Program("turtlesim_py.ros.node", *arguments, cwd=tmp_path) as program:
        assert program.wait() == 2
        line = program.text().splitlines()[-1]
        assert line.startswith("turtlesim_node: parameter view_port is ")
        assert "expected a port that is free" in line
