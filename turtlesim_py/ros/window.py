"""The window that the original opens, as data: on a topic, in a file on request, on a page."""

from __future__ import annotations

import sys
from array import array
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rclpy.parameter import Parameter
from rclpy.publisher import Publisher
from rclpy.qos import QoSProfile
from std_srvs.srv import Trigger

from turtlesim_py.ros.rclcpp_node import RclcppNode, UnusableParameter
from turtlesim_py.world.arena import Arena
from turtlesim_py.world.turtle import TICK_S

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray
    from sensor_msgs.msg import CompressedImage, Image

    from turtlesim_py.live.feed import Feed
    from turtlesim_py.live.server import LiveServer

#: Pictures a second, unless the parameter is set.
DEFAULT_RATE_HZ = 10.0
#: The least rate means: one picture, and then none as long as the node lives.
LONGEST_PERIOD_NS = 1e18
#: Serve the page to this machine alone.
DEFAULT_HOST = "127.0.0.1"
#: The page's thread may keep a tick waiting for so long [s]; Python's 5 ms are a third of a tick.
SWITCH_S = 0.0005


def declare_parameters(node: RclcppNode) -> None:
    """Declare the parameters of a `Window` on this node."""
    node.declare(
        "image_rate",
        DEFAULT_RATE_HZ,
        "Pictures a second on ~/image while somebody subscribes [Hz]; 0: none",
        limits=(0.0, 1.0 / TICK_S),
    )
    node.declare("canvas_folder", ".", "Where save_canvas writes its pictures")


def declare_page_parameters(node: RclcppNode) -> None:
    """Declare the parameters of `serve_page`."""
    node.declare(
        "view_port",
        -1,
        "Where a page shows the turtles: a port of this machine; 0: any free one; -1: no page",
        limits=(-1, 65535),
        read_only=True,
    )
    node.declare("view_host", DEFAULT_HOST, "The address to serve the page at", read_only=True)
    node.declare("view_token", "", "What opens the page elsewhere; empty: made", read_only=True)
    node.declare("view_read_only", False, "Whether the page is for looking only", read_only=True)


class Window:
    """The topics `~/image` and `~/image/compressed` and the service `~/save_canvas`.

    Subscribe to the raw picture reliably where possible: it is larger than what the middleware
    carries in one piece (0.75 MB), and without repetition most pictures are lost. The compressed
    one (PNG, the same pixels, about 10 kB) also suits best-effort subscribers and slow networks;
    its place and name are the custom of image_transport.
    """

    def __init__(self, node: RclcppNode, arena: Arena) -> None:
        self._node = node
        self._arena = arena
        self._rate_hz: float = node.get_parameter("image_rate").value
        self._due_ns = 0
        self._raw: Publisher | None = None
        node.add_post_set_parameters_callback(self._on_parameters)

    def open(self) -> None:
        """Create the topics and the service, if they are not there yet."""
        if self._raw is not None:
            return
        from sensor_msgs.msg import CompressedImage, Image  # here: the first pose needs none

        only_the_newest = QoSProfile(depth=1)
        self._raw = self._node.create_publisher(Image, "~/image", only_the_newest)
        self._compressed = self._node.create_publisher(
            CompressedImage, "~/image/compressed", only_the_newest
        )
        self._node.create_service(Trigger, "~/save_canvas", self._on_save)

    def publish_if_due(self) -> None:
        """Send the picture if somebody subscribes and the last is old enough; after each tick."""
        late_ns = self._arena.now_ns - self._due_ns
        if late_ns < 0 or self._rate_hz == 0.0 or self._raw is None:
            return
        period_ns = round(min(1e9 / self._rate_hz, LONGEST_PERIOD_NS))
        # counted from when it was due: waiting for a tick does not make pictures rarer
        self._due_ns += period_ns if late_ns < period_ns else late_ns + period_ns
        raw = self._raw.get_subscription_count()
        compressed = self._compressed.get_subscription_count()
        if not (raw or compressed):
            return
        pixels = self._picture()
        if raw:
            self._publish(self._raw, _fill(self._raw.msg_type(), pixels))
        if compressed:
            self._publish(self._compressed, _compress(self._compressed.msg_type(), pixels))

    def _publish(self, publisher: Publisher, message: Image | CompressedImage) -> None:
        message.header.stamp = self._node.get_clock().now().to_msg()
        message.header.frame_id = "window"
        publisher.publish(message)

    def _on_parameters(self, parameters: list[Parameter]) -> None:
        for parameter in parameters:
            if parameter.name == "image_rate":
                self._rate_hz = parameter.value
                self._due_ns = 0

    def _on_save(self, _: Any, response: Any) -> Any:
        folder = Path(self._node.get_parameter("canvas_folder").value)
        try:
            folder = folder.expanduser().resolve()
            folder.mkdir(parents=True, exist_ok=True)
            path = _reserve_next(folder)
            path.write_bytes(_png(self._picture()))
        # an unknown home, a circle of links, a name that no file can have
        except (OSError, RuntimeError, ValueError) as error:
            why = error.strerror if isinstance(error, OSError) else str(error)
            response.success = False
            response.message = f"cannot write the canvas to {folder}: {why}"
        else:
            response.success = True
            response.message = str(path)
        return response

    def _picture(self) -> NDArray[np.uint8]:
        from turtlesim_py.world import picture  # here: often nobody looks

        arena = self._arena
        return picture.render(arena.canvas, arena.background, arena.sprites())


def _fill(image: Image, pixels: NDArray[np.uint8]) -> Image:
    image.height, image.width, channels = pixels.shape
    image.encoding, image.step = "rgb8", image.width * channels
    # rclpy copies an array of bytes as a whole, anything else byte by byte
    image.data = array("B", pixels.tobytes())
    return image


def _compress(image: CompressedImage, pixels: NDArray[np.uint8]) -> CompressedImage:
    image.format, image.data = "png", array("B", _png(pixels))
    return image


def _png(pixels: NDArray[np.uint8]) -> bytes:
    import PIL.Image  # here: often nobody looks

    file = BytesIO()
    PIL.Image.fromarray(pixels).save(file, format="PNG")
    return file.getvalue()


def _reserve_next(folder: Path) -> Path:
    """Create canvas_001.png, or that of the first number not in use, not even by a link."""
    number = 1
    while True:
        path = folder / f"canvas_{number:03}.png"
        try:
            path.touch(exist_ok=False)
        except FileExistsError:
            number += 1
        else:
            return path


def serve_page(node: RclcppNode, arena: Arena, interfaces: str) -> tuple[LiveServer, Feed] | None:
    """Begin to serve the page; None where none is wanted.

    Args:
        interfaces: the package of turtlesim's messages.

    Raises:
        UnusableParameter: the page cannot be served with these parameters.
    """
    port, host, token, is_read_only = (
        node.get_parameter(f"view_{name}").value for name in ("port", "host", "token", "read_only")
    )
    if port < 0:
        return None
    try:
        from turtlesim_py.live.feed import Feed  # here: few want a page
        from turtlesim_py.live.server import LiveServer, Settings
    except ImportError as error:
        needed = f"-1: a page needs the package websockets, 14 or newer ({error})"
        raise UnusableParameter("view_port", port, needed) from None
    about = {
        "node": node.get_fully_qualified_name(),
        "namespace": node.get_namespace(),
        "interfaces": interfaces,
    }
    server = LiveServer(Settings(port, host, is_read_only, token), about)
    feed = Feed(arena, server.deliver)
    sys.setswitchinterval(SWITCH_S)
    try:
        server.start(feed)
    except (OSError, UnicodeError) as error:
        why = getattr(error, "strerror", None) or str(error)
        found = f"{port}, at {host}"
        raise UnusableParameter("view_port", found, f"a port that is free ({why})") from None
    node.log("INFO", f"The turtles are to be seen at {server.address}")
    return server, feed
