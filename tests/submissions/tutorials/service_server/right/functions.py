import rclpy
from example_interfaces.srv import AddTwoInts


def add(request, response):
    return AddTwoInts.Response(sum=request.a + request.b)


rclpy.init()
node = rclpy.create_node("adder")
node.create_service(AddTwoInts, "/add_two_ints", add)
try:
    rclpy.spin(node)
except KeyboardInterrupt:
    pass
