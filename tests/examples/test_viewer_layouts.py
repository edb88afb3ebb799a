"""Each topic and field that a layout for another viewer names is in a recording."""

import json
import xml.etree.ElementTree as ElementTree

import pytest
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory

from tests import archive
from tests.programs import ROOT

LAYOUTS = ROOT / "examples" / "viewers"
FOXGLOVE = json.loads((LAYOUTS / "foxglove.json").read_text())


@pytest.fixture(scope="module")
def recorded():
    return archive.folder("turtlesim_challenge", "right") / "recording.mcap"


@pytest.fixture(scope="module")
def messages(recorded):
    """Topic -> a decoded message and the name of its schema."""
    with recorded.open("rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        return {
            channel.topic: (message, schema.name)
            for schema, channel, _, message in reader.iter_decoded_messages()
        }


def strings(value):
    """Every text in a layout."""
    if isinstance(value, str):
        yield value
    elif isinstance(value, dict):
        for inner in value.values():
            yield from strings(inner)
    elif isinstance(value, list):
        for inner in value:
            yield from strings(inner)


def paths(layout):
    if layout == "foxglove.json":
        return [text for text in strings(FOXGLOVE["configById"]) if text.startswith("/")]
    root = ElementTree.parse(LAYOUTS / layout).getroot()
    return [
        curve.attrib["name"].replace("/", ".").replace(".", "/", 2) for curve in root.iter("curve")
    ]


@pytest.mark.parametrize("layout", ["foxglove.json", "plotjuggler.xml"])
def test_what_a_layout_shows_is_in_a_recording(layout, messages):
    assert len(paths(layout)) > 5
    for path in paths(layout):
        topic, *fields = path.split(".")
        value, _ = messages[topic]
        for field in fields:
            value = getattr(value, field)


def test_every_panel_has_its_place_and_every_place_its_panel():
    assert set(strings(FOXGLOVE["layout"])) - {"row", "column"} == set(FOXGLOVE["configById"])


def test_types_are_well_known_and_times_are_ticks(recorded, messages):
    assert {schema for _, schema in messages.values()} <= {
        *("turtlesim/msg/Pose", "turtlesim/msg/Color", "geometry_msgs/msg/Twist"),
        *("std_msgs/msg/String", "rcl_interfaces/msg/Log", "sensor_msgs/msg/Image"),
    }
    with recorded.open("rb") as file:
        times = [message.log_time for _, _, message in make_reader(file).iter_messages()]
    assert times == sorted(times)
    assert all(time % 16_000_000 == 0 for time in times)
