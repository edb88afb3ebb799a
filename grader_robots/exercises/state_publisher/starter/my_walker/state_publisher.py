"""Move a walking robot: its joints, and where it is.

As it stands, the node starts and sends nothing. Fill in the TODOs; two are here, one is in
launch/walker.launch.py, one in setup.py.
"""

import rclpy
from geometry_msgs.msg import TransformStamped  # noqa: F401  you will need it in update()
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from sensor_msgs.msg import JointState  # noqa: F401  you will need it in update()
from tf2_ros import TransformBroadcaster  # noqa: F401  you will need it


class StatePublisher(Node):
    """Publishes joint states, and the transform from odom to axis."""

    def __init__(self):
        super().__init__("state_publisher")
        # TODO 1: create a publisher of JointState on joint_states, and a TransformBroadcaster.
        self.create_timer(1 / 30, self.update)

    def update(self):
        """Called thirty times a second."""
        # TODO 2: one stamp of the clock for both messages. A JointState with the names of the
        #         joints that move (see urdf/walker.urdf) and their positions; a TransformStamped
        #         from odom to axis. Then let everything go on by a small step.


def main(args=None):
    """Run the node until Ctrl-C."""
    rclpy.init(args=args)
    try:
        rclpy.spin(StatePublisher())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
