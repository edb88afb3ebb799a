import pytest
from geometry_msgs.msg import Twist

from tests.programs import Program
from tests.tiers import others_are_more
from turtlesim_py.ros.interfaces import Interfaces, installed, usual


@pytest.mark.parametrize(
    "package", others_are_more("the classes are told apart by units", installed(), usual())
)
def test_the_speeds_of_a_pose_become_a_command(graph, package):
    pose = Interfaces.of(package).msg.Pose
    arguments = ["-r", f"input/pose:=/leader/{package}", "-r", "output/cmd_vel:=/follower/cmd_vel"]
    arguments += ["-p", f"interfaces:={package}"]
    with Program("turtlesim_py.programs.mimic", "--ros-args", *arguments) as program:
        twists = graph.listen(Twist, "/follower/cmd_vel")
        nodes = graph.node.get_node_names_and_namespaces
        graph.until(lambda: ("turtle_mimic", "/") in nodes(), "the node")
        poses = graph.publisher(pose, f"/leader/{package}")

        def answered():
            poses.publish(pose(linear_velocity=1.5, angular_velocity=-0.5))
            return bool(twists)

        graph.until(answered, "a command")
        assert twists[0].linear.x == 1.5
        assert twists[0].angular.z == -0.5
        assert program.stop() == 0
