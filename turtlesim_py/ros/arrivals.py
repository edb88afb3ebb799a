"""Tells without a wait whether anything has arrived for a node.

rclpy has only the wait set for that question; to fill and ask one costs more than everything else
in an idle tick. rcl, below it, calls a C function for each message and request. Here that is libc's
`sem_post`, which raises a number in memory: no Python runs, and no thread wakes.
"""

from __future__ import annotations

import ctypes
from collections.abc import Iterable
from itertools import product
from typing import Any, Final

from rclpy.action import ActionServer
from rclpy.service import Service
from rclpy.subscription import Subscription
from rclpy.waitable import Waitable

#: More than any libc's sem_t [bytes]; the number is its first 32 bits.
SEMAPHORE_BYTES: Final = 64
#: What an action server is asked for.
REQUESTS: Final = ("goal", "cancel", "result")


class Arrivals:
    """Whether anything has arrived for the entities that are watched."""

    def __init__(self) -> None:
        semaphore = ctypes.create_string_buffer(SEMAPHORE_BYTES)  # all zeros: it counts 0
        # never freed: the middleware's threads may still count while Python ends
        ctypes.pythonapi.Py_IncRef(ctypes.py_object(semaphore))
        self._where = ctypes.c_void_p(ctypes.addressof(semaphore))
        self._count = ctypes.c_uint32.from_buffer(semaphore)

    def watch(
        self,
        subscriptions: Iterable[Subscription],
        services: Iterable[Service],
        waitables: Iterable[Waitable],
    ) -> bool:
        """Watch these from now on, and count what they have already; False where that cannot be.

        That is with a middleware that does not tell, a waitable that is no action server, or a ROS
        that is built in another way.
        """
        try:
            count = ctypes.cast(ctypes.CDLL(None).sem_post, ctypes.c_void_p)
            rcl, rcl_action = ctypes.CDLL("librcl.so"), ctypes.CDLL("librcl_action.so")
            calls = [(rcl.rcl_subscription_set_on_new_message_callback, it) for it in subscriptions]
            calls += [(rcl.rcl_service_set_on_new_request_callback, it) for it in services]
            for waitable, kind in product(waitables, REQUESTS):
                if not isinstance(waitable, ActionServer):
                    return False
                tell = getattr(rcl_action, f"rcl_action_server_set_{kind}_service_callback")
                calls.append((tell, waitable))
            return not any(
                tell(ctypes.c_void_p(_handle(it).pointer), count, self._where) for tell, it in calls
            )
        except (OSError, AttributeError):  # no such library, function or handle
            return False

    def take(self) -> bool:
        """Return whether anything has arrived since the last call."""
        if not self._count.value:
            return False
        self._count.value = 0  # before it is read: what arrives meanwhile counts again
        return True


def _handle(entity: Any) -> Any:
    return entity._handle if isinstance(entity, ActionServer) else entity.handle
