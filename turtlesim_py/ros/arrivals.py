"""Tells whether anything has arrived, so that nobody has to look in vain.

A look at all the entities of a node is the dearest part of a tick in which nothing arrives, and
mostly nothing does.
"""

from __future__ import annotations

import ctypes
from typing import ClassVar

from rclpy.action import ActionServer
from rclpy.service import Service
from rclpy.subscription import Subscription


class Arrivals:
    """Counted by the middleware's own threads.

    rcl takes a C function that it calls in these threads, with a pointer that we choose. libc's
    `sem_post(semaphore)` fits, and where nobody waits for the semaphore it only counts. A Python
    function would not do: it needs the interpreter's lock, while the middleware holds its own.

    Raises:
        OSError: the libraries of rcl cannot be found by their names.
    """

    #: Never freed: the middleware may count as long as the process lives.
    _semaphores: ClassVar[list[ctypes.Array[ctypes.c_uint64]]] = []

    def __init__(self) -> None:
        self._rcl = ctypes.CDLL("librcl.so")
        self._rcl_action = ctypes.CDLL("librcl_action.so")
        self._count = ctypes.cast(ctypes.CDLL(None).sem_post, ctypes.c_void_p)
        # Zeros are a new semaphore; its first word is not 0 any more when it has counted.
        self._semaphore = (ctypes.c_uint64 * 4)()
        self._semaphores.append(self._semaphore)

    def watch(self, entity: Subscription | Service | ActionServer) -> None:
        """Count for this entity too; at once if something has already arrived."""
        if isinstance(entity, Subscription):
            setters = [self._rcl.rcl_subscription_set_on_new_message_callback]
        elif isinstance(entity, Service):
            setters = [self._rcl.rcl_service_set_on_new_request_callback]
        else:
            setters = [
                self._rcl_action.rcl_action_server_set_goal_service_callback,
                self._rcl_action.rcl_action_server_set_cancel_service_callback,
                self._rcl_action.rcl_action_server_set_result_service_callback,
            ]
        handle = entity._handle if isinstance(entity, ActionServer) else entity.handle
        for setter in setters:
            setter.argtypes = [ctypes.c_void_p] * 3
            if setter(handle.pointer, self._count, self._semaphore):
                raise RuntimeError(f"{setter.__name__} failed")

    def any_new(self) -> bool:
        """Whether anything has arrived since it was last asked."""
        if not self._semaphore[0]:
            return False
        self._semaphore[0] = 0
        return True
