import rclpy
import tutorial_interfaces.msg
import tutorial_interfaces.srv

num = tutorial_interfaces.msg.Num()


def add(request, response):
    return tutorial_interfaces.srv.AddThreeInts.Response(sum=request.a + request.b + request.c)


def main():
    rclpy.init()
    node = rclpy.create_node("numbers")
    publisher = node.create_publisher(tutorial_interfaces.msg.Num, "/topic", 10)

    def tick():
        publisher.publish(num)
        num.num += 1

    node.create_timer(0.5, tick)
    node.create_service(tutorial_interfaces.srv.AddThreeInts, "/add_three_ints", add)
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
