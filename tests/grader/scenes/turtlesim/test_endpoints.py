"""What the scene says that it has is what its node really has."""

from grader.scenes.turtlesim.interfaces import endpoints_of
from grader.scenes.turtlesim.trace import TurtleTrace
from tests.grader.driving import Spiral, drive
from turtlesim_py.ros.interfaces import usual
from turtlesim_py.ros.node import TurtlesimNode


def test_every_topic_service_and_action_of_the_scene_is_the_nodes_own(ros):
    node = TurtlesimNode(["--ros-args", "-r", "__ns:=/own"])
    trace = TurtleTrace.of(drive(Spiral(), ticks=2).trace)
    found = {(e.kind, e.name, e.type) for e in endpoints_of(trace, usual())}

    def named(kind, name, of):
        package, where = of.__module__.split(".")[:2]
        return kind, name.removeprefix("/own"), f"{package}/{where}/{of.__name__}"

    there = {named("publisher", each.topic_name, each.msg_type) for each in node.publishers}
    there |= {named("subscription", each.topic_name, each.msg_type) for each in node.subscriptions}
    there |= {named("service", each.service_name, each.srv_type) for each in node.services}
    node.destroy_node()
    action = {each for each in found if each[0] == "action"}
    assert found - action <= there
    assert [name for _, name, _ in action] == ["/turtle1/rotate_absolute"]
    turtles_own = {name for _, name, _ in there if name.startswith("/turtle1/")}
    assert turtles_own <= {name for _, name, _ in found}
