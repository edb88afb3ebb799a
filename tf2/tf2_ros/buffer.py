"""`Buffer`: a BufferCore that can wait, and that forgets when the clock jumps back."""

from __future__ import annotations

import threading
import time as wall
from collections.abc import Callable
from typing import Any

import rclpy.clock
import rclpy.logging
from geometry_msgs.msg import TransformStamped
from rclpy.clock import Clock, JumpThreshold, TimeJump
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.task import Future
from rclpy.time import Time
from tf2_msgs.srv import FrameGraph
from tf2_py import BufferCore

from .buffer_interface import NO_WAIT, BufferInterface

#: How often a waiting lookup tries again [s].
POLL_S = 0.02
#: A clock that has gone back by more than this ends the waiting.
BACK_AGAIN = Duration(seconds=3.0)

Lookup = Callable[[], TransformStamped]


class Buffer(BufferCore, BufferInterface):
    """The transforms that a TransformListener receives.

    Args:
        cache_time: for how long transforms are kept; 10 s.
        node: gets the service `tf2_frames`, which lists all frames; its clock is watched.
    """

    def __init__(self, cache_time: Duration | None = None, node: Node | None = None) -> None:
        BufferCore.__init__(self, cache_time)
        BufferInterface.__init__(self)
        self._new_data_callbacks: list[Callable[[], None]] = []
        self._callbacks_to_remove: list[Callable[[], None]] = []
        self._callbacks_lock = threading.RLock()
        if node is not None:
            self.srv = node.create_service(FrameGraph, "tf2_frames", self._answer_frames)
            self.clock = node.get_clock()
        else:
            self.clock = Clock()
        self.jump_handle = self.clock.create_jump_callback(
            JumpThreshold(
                min_forward=None, min_backward=Duration(seconds=-1), on_clock_change=True
            ),
            post_callback=self.time_jump_callback,
        )

    def _answer_frames(self, _: Any, response: Any) -> Any:
        response.frame_yaml = self.all_frames_as_yaml()
        return response

    def time_jump_callback(self, time_jump: TimeJump) -> None:
        """Forget everything: stamps of before mean nothing any more."""
        logger = rclpy.logging.get_logger("tf2_buffer")
        logger.warning("Detected jump back in time. Clearing tf buffer.")
        self.clear()

    def _set(self, transform: TransformStamped, authority: str, is_static: bool) -> None:
        """Keep a transform, and call the waiting callbacks."""
        super()._set(transform, authority, is_static)
        with self._callbacks_lock:
            for callback in self._new_data_callbacks:
                callback()
            # only now: a callback may ask for its removal
            for callback in self._callbacks_to_remove:
                self._new_data_callbacks.remove(callback)
            self._callbacks_to_remove.clear()

    def _remove_callback(self, callback: Callable[[], None]) -> None:
        with self._callbacks_lock:
            self._callbacks_to_remove.append(callback)

    def lookup_transform(
        self, target_frame: str, source_frame: str, time: Time, timeout: Duration = NO_WAIT
    ) -> TransformStamped:
        """Return where `source_frame` is in `target_frame`.

        Args:
            time: 0 for the latest time at which that is known.
            timeout: how long to wait for it. Waiting spins nothing: in a callback of an executor
                with one thread nothing can come meanwhile.

        Raises:
            TransformException: a class below it, for what is not known.
        """
        self.can_transform(target_frame, source_frame, time, timeout)
        return self.lookup_transform_core(target_frame, source_frame, time)

    async def lookup_transform_async(
        self, target_frame: str, source_frame: str, time: Time
    ) -> TransformStamped:
        """Return it as soon as it is known."""
        await self.wait_for_transform_async(target_frame, source_frame, time)
        return self.lookup_transform_core(target_frame, source_frame, time)

    def lookup_transform_full(
        self, target_frame: str, target_time: Time, source_frame: str, source_time: Time,
        fixed_frame: str, timeout: Duration = NO_WAIT,
    ) -> TransformStamped:  # fmt: skip
        """Return where `source_frame` was at one time in what `target_frame` is at another.

        Args:
            fixed_frame: what has not moved in between.
        """
        way = (target_frame, target_time, source_frame, source_time, fixed_frame)
        self.can_transform_full(*way, timeout)
        return self.lookup_transform_full_core(*way)

    async def lookup_transform_full_async(
        self, target_frame: str, target_time: Time, source_frame: str, source_time: Time,
        fixed_frame: str,
    ) -> TransformStamped:  # fmt: skip
        """Return it as soon as it is known."""
        way = (target_frame, target_time, source_frame, source_time, fixed_frame)
        await self.wait_for_transform_full_async(*way)
        return self.lookup_transform_full_core(*way)

    def can_transform(
        self, target_frame: str, source_frame: str, time: Time, timeout: Duration = NO_WAIT,
        return_debug_tuple: bool = False,
    ) -> Any:  # fmt: skip
        """Return 1 if the lookup would succeed, else 0; or both with the reason, as a tuple."""
        found = _wait(lambda: self.can_transform_core(target_frame, source_frame, time), timeout)
        return found if return_debug_tuple else found[0]

    def can_transform_full(
        self, target_frame: str, target_time: Time, source_frame: str, source_time: Time,
        fixed_frame: str, timeout: Duration = NO_WAIT, return_debug_tuple: bool = False,
    ) -> Any:  # fmt: skip
        """Return 1 if the lookup with two times would succeed, else 0; or with the reason."""
        way = (target_frame, target_time, source_frame, source_time, fixed_frame)
        found = _wait(lambda: self.can_transform_full_core(*way), timeout)
        return found if return_debug_tuple else found[0]

    def wait_for_transform_async(self, target_frame: str, source_frame: str, time: Time) -> Future:
        """Return a future that has the transform as soon as it is known."""
        return self._when(
            lambda: self.can_transform_core(target_frame, source_frame, time),
            lambda: self.lookup_transform_core(target_frame, source_frame, time),
        )

    def wait_for_transform_full_async(
        self, target_frame: str, target_time: Time, source_frame: str, source_time: Time,
        fixed_frame: str,
    ) -> Future:  # fmt: skip
        """Return a future that has the transform between two times as soon as it is known."""
        way = (target_frame, target_time, source_frame, source_time, fixed_frame)
        return self._when(
            lambda: self.can_transform_full_core(*way),
            lambda: self.lookup_transform_full_core(*way),
        )

    def _when(self, possible: Callable[[], tuple[int, str]], lookup: Lookup) -> Future:
        future = Future()
        if possible()[0]:
            future.set_result(lookup())
            return future

        def try_again() -> None:
            try:
                if possible()[0]:
                    future.set_result(lookup())
            except BaseException as error:
                future.set_exception(error)

        self._new_data_callbacks.append(try_again)
        future.add_done_callback(lambda _: self._remove_callback(try_again))
        return future


def _wait(possible: Callable[[], tuple[int, str]], timeout: Duration) -> tuple[int, str]:
    """Ask until the answer is 1, or the time is over by the system's clock."""
    if timeout != Duration():
        clock = rclpy.clock.Clock()
        start = clock.now()
        while (
            clock.now() < start + timeout
            and not possible()[0]
            and clock.now() + BACK_AGAIN >= start
        ):
            wall.sleep(POLL_S)
    return possible()
