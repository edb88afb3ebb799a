import json
import re
from contextlib import ExitStack

import pytest
from websockets.sync.client import ClientConnection, connect

from tests.programs import DEADLINE_S, Program


class Page:
    def __init__(self, program):
        self.program = program
        line = program.wait_for_line("to be seen at")
        self.address = re.search(r"http://\S+", line)[0]
        self.port = int(re.search(r":(\d+)/", self.address)[1])

    def viewer(self, path="socket", **options):
        """To be used with `with`."""
        return Viewer(f"ws://127.0.0.1:{self.port}/{path}", options)


class Viewer:
    connection: ClientConnection

    def __init__(self, address, options):
        self._connecting = lambda: connect(address, **options)
        self._open = ExitStack()

    def __enter__(self):
        self.connection = self._open.enter_context(self._connecting())
        return self

    def __exit__(self, *_):
        self._open.close()

    def say(self, **frame):
        self.connection.send(json.dumps(frame))

    def until(self, is_meant):
        """The next frame that is meant; those before it are dropped."""
        while True:
            frame = json.loads(self.connection.recv(timeout=DEADLINE_S))
            if is_meant(frame):
                return frame

    def ask(self, **frame):
        """What is answered to a frame with an id."""
        self.say(**frame)
        return self.until(lambda answer: answer.get("id") == frame["id"])


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    """With ROS names of its own, so that the session's simulator is another one."""
    words = ("view_port:=0", "turtle_image:=jazzy")
    parameters = [word for each in words for word in ("-p", each)]
    with Program(
        "turtlesim_py.ros.node",
        *("--ros-args", "-r", "__ns:=/seen", *parameters),
        cwd=tmp_path_factory.mktemp("page"),
    ) as program:
        yield Page(program)
        assert program.stop() == 0, program.text()
        assert "Traceback" not in program.text()
