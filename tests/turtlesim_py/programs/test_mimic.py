"""mimic, between two topics of the test's own."""

from __future__ import annotations

from geometry_msgs.msg import Twist
from turtlesim.msg import Pose

from tests.graph import Graph
from tests.programs import Program


def test_the_speeds_of_a_pose_become_a_command(graph: Graph) -> None:
    arguments = ["-r", "input/pose:=/leader/pose", "-r", "output/cmd_vel:=/follower/cmd_vel"]
    with Program("turtlesim_py.programs.mimic", "--ros-args", *arguments) as program:
        twists = graph.listen(Twist, "/follower/cmd_vel")
        nodes = graph.node.get_node_names_and_namespaces
        graph.until(lambda: ("turtle_mimic", "/") in nodes(), "the node")
        poses = graph.publisher(Pose, "/leader/pose")

        def answered() -> bool:
            poses.publish(Pose(linear_velocity=1.5, angular_velocity=-0.5))
            return bool(twists)

        graph.until(answered, "a command")
        assert twists[0].linear.x == 1.5
        assert twists[0].angular.z == -0.5
        assert program.stop() == 0
