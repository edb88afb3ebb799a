import rclpy
from rclpy.node import Node
from sensor_msgs.msg import JointState


class StatePublisher(Node):
    def __init__(self):
        super().__init__('state_publisher')
        self.publisher = self.create_publisher(JointState, 'joint_states', 10)
        self.create_timer(1 / 30, self.update)

    def update(self):
        state = JointState(name=['swivel', 'tilt', 'periscope'], position=[0.0, 0.0, 0.0])
        state.header.stamp = self.get_clock().now().to_msg()
        self.publisher.publish(state)


def main():
    rclpy.init()
    rclpy.spin(StatePublisher())


if __name__ == '__main__':
    main()
