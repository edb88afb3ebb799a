from io import BytesIO

import numpy as np
import PIL.Image
import pytest
from rclpy.parameter import Parameter
from rclpy.qos import QoSProfile, ReliabilityPolicy
from rclpy.time import Time
from sensor_msgs.msg import CompressedImage, Image
from turtlesim.srv import TeleportAbsolute

from tests.programs import Program
from turtlesim_py.ros.node import TurtlesimNode
from turtlesim_py.world import picture
from turtlesim_py.world.arena import TICK_NS

PEN = [179, 184, 255]


@pytest.fixture(scope="module")
def watched(session_graph):
    """The namespace of a simulator that nobody else draws on or sets parameters of."""
    with Program("turtlesim_py.ros.node", "--ros-args", "-r", "__ns:=/watched") as program:
        session_graph.meet("watched.turtlesim")
        yield "/watched"
        assert program.stop() == 0


def raw(image):
    return np.frombuffer(image.data, np.uint8).reshape(image.height, image.width, 3)


def compressed(image):
    with PIL.Image.open(BytesIO(bytes(image.data))) as opened:
        return np.asarray(opened)


@pytest.mark.parametrize(
    ("kind", "topic", "decoded", "reliability"),
    [
        (Image, "image", raw, ReliabilityPolicy.RELIABLE),
        (CompressedImage, "image/compressed", compressed, ReliabilityPolicy.BEST_EFFORT),
    ],
)
def test_a_subscriber_sees_the_window(graph, watched, kind, topic, decoded, reliability):
    qos = QoSProfile(depth=1, reliability=reliability)
    images = graph.listen(kind, f"{watched}/turtlesim/{topic}", qos)
    graph.call(TeleportAbsolute, f"{watched}/turtle1/teleport_absolute", x=2.0, y=10.0)
    # half way between (5.5, 5.5) and (2, 10)
    row, column = 499 - round(7.75 * 45), round(3.75 * 45)
    graph.until(lambda: images, "a picture")
    graph.until(
        lambda: decoded(images[-1])[row, column].tolist() == PEN,
        "the line that the turtle has drawn",
    )
    pixels = decoded(images[-1])
    assert pixels.shape == (500, 500, 3)
    assert pixels[0, 0].tolist() == [69, 86, 255]
    assert images[-1].header.frame_id == "window"


class Rate:
    """A node in this process, told when to tick."""

    def __init__(self, graph):
        self.graph = graph
        arguments = ["-r", "__ns:=/filmed", "-p", "image_rate:=12.5"]
        self.node = TurtlesimNode(["--ros-args", *arguments])
        self.ticks = 0

    def tick(self, count):
        for _ in range(count):
            self.ticks += 1
            self.node.tick(self.ticks * TICK_NS)


@pytest.fixture
def rate(graph):
    rate = Rate(graph)
    yield rate
    rate.node.destroy_node()


@pytest.fixture
def renderings(monkeypatch):
    made = []
    original = picture.render

    def render(*arguments):
        made.append(None)
        return original(*arguments)

    monkeypatch.setattr(picture, "render", render)
    return made


def test_pictures_come_at_the_rate_of_the_parameter(rate, renderings):
    images = rate.graph.listen(Image, "/filmed/turtlesim/image")
    rate.tick(50)  # 0.8 s
    assert len(renderings) == 10
    rate.graph.until(lambda: len(images) == 10, "all pictures")
    assert (images[0].encoding, images[0].step) == ("rgb8", 1500)
    stamps = [Time.from_msg(image.header.stamp) for image in images]
    assert stamps == sorted(stamps)


@pytest.mark.parametrize(("hz", "pictures"), [(0.0, 0), (5e-324, 1), (1e-300, 1)])
def test_a_rate_of_zero_means_no_pictures_and_the_rarest_come_once(rate, renderings, hz, pictures):
    rate.tick(20)
    assert not renderings  # nobody looks
    rate.graph.listen(Image, "/filmed/turtlesim/image")
    rate.node.set_parameters([Parameter("image_rate", value=hz)])
    rate.tick(20)
    assert len(renderings) == pictures
    rate.node.set_parameters([Parameter("image_rate", value=62.5)])
    rate.tick(5)
    assert len(renderings) == pictures + 5
