"""Messages, a service and an action whose classes no compiler made."""

import threading

import rclpy
from rclpy.action import ActionClient, ActionServer
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.serialization import deserialize_message, serialize_message

# as an exercise's interfaces become importable
ours = _rclpy.Node.__init__.__wrapped__.__globals__
ours["make_importable"](
    {
        "mine/msg/Num": "int64 num 3\nwstring<=9 text\ngeometry_msgs/Point[<=2] points\n",
        "mine/srv/Add": "Num[] nums\n---\nNum sum\n",
        "mine/action/Count": "int8 to\n---\nint32[] numbers\n---\nint8 at\n",
    }
)
from geometry_msgs.msg import Point  # noqa: E402
from mine.action import Count  # noqa: E402
from mine.msg import Num  # noqa: E402
from mine.srv import Add  # noqa: E402

rclpy.init()
node = rclpy.create_node("counter")
group = ReentrantCallbackGroup()
heard = []
hearing = node.create_subscription(Num, "nums", heard.append, 10, callback_group=group)
nums = node.create_publisher(Num, "nums", 10)


def add(request, response):
    response.sum.num = sum(each.num for each in request.nums)
    return response


def count(handle):
    for number in range(handle.request.to):
        handle.publish_feedback(Count.Feedback(at=number))
    handle.succeed()
    return Count.Result(numbers=range(handle.request.to))


node.create_service(Add, "add", add, callback_group=group)
adder = node.create_client(Add, "add", callback_group=group)
server = ActionServer(node, Count, "count", count, callback_group=group)
counter = ActionClient(node, Count, "count", callback_group=group)
executor = MultiThreadedExecutor(4)
executor.add_node(node)
threading.Thread(target=executor.spin, daemon=True).start()

nums.publish(Num(num=1, text="é🐢", points=[Point(x=2.0)]))
print(adder.call(Add.Request(nums=[Num(), Num(num=4)])))
print(heard)
print(counter.wait_for_server(1.0))
feedback = []
result = counter.send_goal(Count.Goal(to=3), feedback_callback=feedback.append)
print(result.result, [each.feedback for each in feedback])
print(deserialize_message(serialize_message(Num(num=7)), Num))
print(dict(node.get_topic_names_and_types())["/nums"], nums.get_subscription_count())
print(dict(node.get_service_names_and_types())["/add"])
(info,) = node.get_publishers_info_by_topic("/nums")
print(info.node_name, info.topic_type)
for wrong in ("x", Point()):
    try:
        nums.publish(wrong)
    except Exception as error:
        print(f"{type(error).__name__}: {error}")
try:
    Num(num=2**63)
except AssertionError as error:
    print(error)

# DDS itself is never given a message
kept = _rclpy.Publisher.__mro__[2]
for refused in (
    lambda: kept.publish(nums.handle, Num()),
    lambda: _rclpy.Client.__mro__[2].send_request(adder.handle, Add.Request()),
    lambda: _rclpy.Subscription.__mro__[2].take_message(hearing.handle, Num, False),
    lambda: ours["_serialize"](Num(), Num),
    lambda: ours["_deserialize"](b"\0\1\0\0" + bytes(20), Num),
):
    try:
        refused()
    except Exception as error:
        print(f"{type(error).__name__}: {error}")
