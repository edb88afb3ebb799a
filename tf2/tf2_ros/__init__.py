"""A tf2_ros for a Python without ROS: sends, receives and looks up transforms.

It has all but `BufferClient`, which asks a buffer in another process. ROS's module also has names
that are not tf2's, which programs import from it: `from tf2_ros import TransformBroadcaster,
TransformStamped`. Installed only where no ROS is sourced.
"""

# ruff: noqa: F401
import rclpy
import tf2_py as tf2
from geometry_msgs.msg import (
    PointStamped,
    PoseStamped,
    PoseWithCovarianceStamped,
    TransformStamped,
    Vector3Stamped,
)
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.clock import Clock, JumpThreshold, TimeJump
from rclpy.duration import Duration
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile
from rclpy.task import Future
from rclpy.time import Time
from sensor_msgs.msg import PointCloud2
from std_msgs.msg import Header
from tf2_msgs.msg import TFMessage
from tf2_msgs.srv import FrameGraph
from tf2_py import (
    BufferCore,
    ConnectivityException,
    ExtrapolationException,
    InvalidArgumentException,
    LookupException,
    TimeoutException,
    TransformException,
)

from .buffer import Buffer
from .buffer_interface import (
    BufferInterface,
    ConvertRegistration,
    NotImplementedException,
    Stamped,
    TransformRegistration,
    TypeException,
    convert,
)
from .static_transform_broadcaster import StaticTransformBroadcaster
from .transform_broadcaster import TransformBroadcaster
from .transform_listener import DEFAULT_STATIC_TF_TOPIC, DEFAULT_TF_TOPIC, TransformListener
