import rclpy
from geometry_msgs.msg import Twist
from turtlesim.msg import Pose
from turtlesim.srv import SetPen

speed = 0.0
quadrant = 0
stopped = False
node = None
pub = None
cli = None


def set_pen(r, g, b):
    req = SetPen.Request(r=r, g=g, b=b, width=3, off=0)
    cli.call_async(req)


def get_quadrant(x, y):
    if y > 5.5:
        if x > 5.5:
            return 1
        return 2
    if x < 5.5:
        return 3
    return 4


def pose_callback(data):
    global quadrant, stopped
    if stopped:
        return
    if data.x > 9.8 or data.x < 1.2 or data.y > 9.8 or data.y < 1.2:
        stopped = True
        pub.publish(Twist())
        print("wall!")
        return
    new = get_quadrant(data.x, data.y)
    if new != quadrant:
        quadrant = new
        if quadrant == 1:
            set_pen(255, 0, 0)
        elif quadrant == 2:
            set_pen(0, 255, 0)
        elif quadrant == 3:
            set_pen(0, 0, 0)
        elif quadrant == 4:
            set_pen(255, 255, 255)


def timer_callback():
    global speed
    if stopped:
        return
    speed += 0.08
    t = Twist()
    t.linear.x = speed
    t.angular.z = 2.0
    pub.publish(t)


def main():
    global node, pub, cli
    rclpy.init()
    node = rclpy.create_node("my_spiral")
    pub = node.create_publisher(Twist, "/turtle1/cmd_vel", 10)
    cli = node.create_client(SetPen, "/turtle1/set_pen")
    cli.wait_for_service()
    node.create_subscription(Pose, "/turtle1/pose", pose_callback, 10)
    node.create_timer(0.2, timer_callback)
    rclpy.spin(node)


if __name__ == "__main__":
    main()
